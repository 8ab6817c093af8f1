"""Linear and angular momentum: pair forces are central and opposite, a massless base bears no force and no torque."""

from __future__ import annotations

import numpy as np
import pytest
from suspensions import Kind, cube, engine, square, suspension


def test_momentum_over_a_hundred_thousand_steps():
    """A small 2D suspension at rest: less than 1e-12 a particle."""
    made = suspension([4.0, 4.0], kinds=(Kind(square, 2),), seed=3)
    start = made.velocity.sum(axis=0)
    made.run(100_000)
    assert made.fault is None
    assert np.abs(made.velocity.sum(axis=0) - start).max() < 1e-12 * len(made.position)


def angular_momentum(made, center):
    """Of each body about one fixed point; (bodies, 1 or 3). Nothing crosses a boundary here."""
    arm = (made.position - center).reshape(2, -1, len(center))
    velocity = made.velocity.reshape(arm.shape)
    return (
        np.cross(arm, velocity).reshape(*arm.shape[:2], -1).sum(axis=1)
        if len(center) == 3
        else np.sum(arm[..., 0] * velocity[..., 1] - arm[..., 1] * velocity[..., 0], axis=1, keepdims=True)
    )


def pair_of_bodies(sites, base, seed=4):
    """Two bodies within reach of each other, alone in a large box, spinning and jostled by friction and noise."""
    dimension = sites.shape[1]
    generator = np.random.default_rng(5)
    made = engine([40.0] * dimension, [1] * 2 * len(sites), kinds=[Kind(sites, 2, base)], timestep=0.005, seed=seed)
    apart = np.zeros(dimension)
    apart[:2] = 0.2, 0.1
    made.position = np.concatenate([20.0 + sites + apart, 20.0 + sites - apart])
    made.velocity = generator.standard_normal((2 * len(sites), dimension))
    made.place()
    return made


@pytest.mark.parametrize("sites", [square, cube], ids=["2D", "3D"])
def test_angular_momentum_of_two_bodies(sites):
    """Conserved to 1e-10 with friction and noise on, while each body's own changes. They fly apart in the end, so there
    are six encounters; which of them passes over most depends on the noise.
    """
    center = np.full(sites.shape[1], 20.0)
    moved = []
    for seed in range(6):
        made = pair_of_bodies(sites, "massless", seed)
        own = angular_momentum(made, center)
        for _ in range(20):
            made.run(20)
            now = angular_momentum(made, center)
            moved.append(np.abs(now - own).max())
            assert np.abs(now.sum(axis=0) - own.sum(axis=0)).max() < 1e-10
        assert (np.abs(made.position - 20.0) < 19.0).all()
    assert max(moved) > 0.5


@pytest.mark.parametrize("sites", [square, cube], ids=["2D", "3D"])
def test_newton_euler_base_does_not_conserve_it(sites):
    """The control: nothing pulls that base back, so the springs' torque is missing in the balance."""
    made = pair_of_bodies(sites, "newton-euler")
    center = np.full(sites.shape[1], 20.0)
    start = angular_momentum(made, center).sum(axis=0)
    made.run(200)
    assert np.abs(angular_momentum(made, center).sum(axis=0) - start).max() > 1e-3
