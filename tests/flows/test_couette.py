"""Steady shear: no place in the box is special, the profile is the imposed one, both directions are mirror images."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from suspensions import Kind, cube, limit, mean_and_error, measured, square, suspension, total_stress

from tether import _core


def moved(made, twin, size, shear_rate, shift):
    """Give `twin` the particles of `made`, shifted against the sheared lattice and put back into the box."""
    box = (_core.Box2 if len(size) == 2 else _core.Box3)(list(size), shear_rate, made.offset)
    velocity = made.velocity
    velocity[:, 0] += shear_rate * shift[1]
    twin.position, twin.velocity = box.wrap(made.position + shift, velocity)
    twin.offset, twin.step = made.offset, made.step
    twin.place()


CASES = {
    "2D fluid": ([5.0, 4.0], ()),
    "3D fluid": ([3.5, 3.0, 4.0], ()),
    "2D squares": ([5.0, 4.0], (Kind(square, 4),)),
    "3D cubes": ([4.0, 4.0, 4.0], (Kind(cube, 3),)),
    "3D cubes, Newton-Euler": ([4.0, 4.0, 4.0], (Kind(cube, 3, base="newton-euler"),)),
}


@pytest.mark.parametrize("shear_rate", [0.8, -0.8])
@pytest.mark.parametrize("case", CASES)
def test_every_place_in_the_box_is_alike(case, shear_rate):
    """Shift all particles (and with them their velocities) through every boundary, the sheared one too: the forces
    are the same to rounding, springs of bodies cut by the boundary included, and so are the next 20 steps.
    """
    size, kinds = CASES[case]
    made = suspension(size, kinds=kinds, shear_rate=shear_rate, seed=11, timestep=0.005)
    twin = suspension(size, kinds=kinds, shear_rate=shear_rate, seed=11, timestep=0.005)
    made.run(150)
    made.place()  # a Newton-Euler base at rest on its constituents in both
    assert made.offset > 0.01
    crossed = 0
    for share in (np.array([0.31, 0.57, 0.77]), np.array([-0.2, -1.4, 0.5]), np.array([0.0, 3.3, 0.0])):
        shift = (share[: len(size)]) * size
        moved(made, twin, size, shear_rate, shift)
        assert twin.force == pytest.approx(made.force, abs=1e-8)
        crossed += np.count_nonzero(np.abs(twin.position - made.position - shift)[:, 1] > 1.0)
    assert crossed > len(made.position)
    for one in (made, twin):
        one.run(20)
    faster = np.zeros(len(size))
    faster[0] = shear_rate * shift[1]
    box = (_core.Box2 if len(size) == 2 else _core.Box3)(size, shear_rate, made.offset)
    apart = twin.position - made.position - shift - 20 * 0.005 * faster
    separation, relative = box.nearest_image(apart, twin.velocity - made.velocity - faster)
    assert np.abs(separation).max() < 1e-8
    assert np.abs(relative).max() < 1e-6


@pytest.mark.parametrize(("dimension", "kinds"), [(2, ()), (2, (Kind(square, 3),)), (3, ()), (3, (Kind(cube, 2),))])
@pytest.mark.parametrize("shear_rate", [1.1, -1.1])
def test_peculiar_momentum_is_conserved(dimension, kinds, shear_rate):
    """Over many crossings of the sheared boundary the momentum against the imposed flow stays zero to rounding."""
    made = suspension([4.0] * dimension, kinds=kinds, shear_rate=shear_rate, timestep=0.005)
    momentum = measured(made, made.run(1000, 1))["momentum"]
    assert np.abs(momentum).max() < 1e-12 * len(made.position)


def mirrored(made, twin, length):
    """x -> -x turns a flow into its opposite; `twin` was built for that."""
    position, velocity = made.position, made.velocity
    position[:, 0] = np.mod(-position[:, 0], length)
    velocity[:, 0] *= -1.0
    twin.position, twin.velocity = position, velocity
    twin.offset, twin.step = -made.offset, made.step
    for one in (made, twin):  # forces of the same velocities in both
        one.place()


@pytest.mark.parametrize(("dimension", "kinds"), [(2, (Kind(square, 4),)), (3, (Kind(cube, 2),))])
def test_opposite_rates_are_mirror_images(dimension, kinds):
    """Noise is a scalar of ids and step, so a mirrored suspension (of mirrored bodies) moves as the mirror image: 150
    steps, to rounding times its growth. Entries of the stress with one x change sign, the others do not.
    """
    size = [4.0] * dimension
    made = suspension(size, kinds=kinds, shear_rate=0.9, seed=2, timestep=0.005)
    flip = np.array([-1.0, 1.0, 1.0])[:dimension]
    opposite = [replace(kind, sites=kind.sites * flip) for kind in kinds]
    twin = suspension(size, kinds=opposite, shear_rate=-0.9, seed=2, timestep=0.005)
    made.run(20)
    mirrored(made, twin, size[0])
    stresses = [total_stress(measured(one, one.run(150, 1))) for one in (made, twin)]
    sign = np.ones((dimension, dimension))
    sign[0, 1:] = sign[1:, 0] = -1.0
    assert stresses[1] == pytest.approx(stresses[0] * sign, abs=1e-5)
    assert np.abs(stresses[0][:, 0, 1]).max() > 0.1


def test_viscosity_of_both_directions():
    """2D fluid, rates +0.3 and -0.3 from different starts: each viscosity, with its sign, is 3.105 +- 0.012 (measured
    with an independent program), and they agree. False-alarm rate 1e-4 over the three comparisons.
    """
    found = []
    for shear_rate, seed in ((0.3, 5), (-0.3, 6)):
        made = suspension([10.0, 10.0], shear_rate=shear_rate, seed=seed)
        made.run(1000)
        stress = total_stress(measured(made, made.run(12_000, 10)))
        found.append(mean_and_error(stress[:, 0, 1] / shear_rate))
    bar = limit(1e-4, comparisons=3)
    for value, error in found:
        assert error < 0.06
        assert abs(value - 3.105) < bar * np.hypot(error, 0.012)
    assert abs(found[0][0] - found[1][0]) < bar * np.hypot(found[0][1], found[1][1])


def test_profile_is_linear():
    """The mean velocity about the imposed profile is zero: its two longest waves across the gradient (four amplitudes,
    400 samples three relaxation times apart) by Hotelling's test, false-alarm rate 1e-4. Judged against a profile 5 %
    too steep the same samples must fail.
    """
    size, shear_rate = [5.0, 5.0], 1.0
    made = suspension(size, shear_rate=shear_rate, seed=8)
    made.run(500)
    waves = {1.0: [], 1.05: []}
    for _ in range(400):
        made.run(250)
        position, velocity = made.position, made.velocity
        for steepness, samples in waves.items():
            peculiar = velocity[:, 0] - steepness * shear_rate * (position[:, 1] - 0.5 * size[1])
            phase = 2.0 * np.pi * np.outer((1, 2), position[:, 1]) / size[1]
            samples.append(np.concatenate([np.cos(phase) @ peculiar, np.sin(phase) @ peculiar]) / len(position))

    def chance(samples):
        samples = np.array(samples)
        count, width = samples.shape
        mean = samples.mean(axis=0)
        square = count * mean @ np.linalg.solve(np.cov(samples.T), mean)
        return stats.f.sf(square * (count - width) / (width * (count - 1)), width, count - width)

    assert chance(waves[1.0]) > 1e-4
    assert chance(waves[1.05]) < 1e-4
