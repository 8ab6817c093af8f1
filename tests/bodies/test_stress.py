"""The stress that a rigid base carries: exact for a stretched body, positive in tension."""

from __future__ import annotations

import numpy as np
import pytest
from suspensions import Kind, crooked, crooked_flat, cube, engine, measured, rod, square, turn


def stress_of(made):
    """The body stress of one very short step, in which nothing moves."""
    return measured(made, made.run(1, 1))


@pytest.mark.parametrize("base", ["massless", "newton-euler", "newton-euler-lagged"])
@pytest.mark.parametrize(
    "sites", [square, crooked_flat, cube, crooked, rod], ids=lambda s: f"{len(s)} in {s.shape[1]}D"
)
@pytest.mark.parametrize("strain", [0.1, -0.1])
def test_stretched_body_is_in_tension(base, sites, strain):
    """Constituents pulled outward by hand to (1 + strain) r, no DPD force, no motion: the springs pull them back with
    -H strain r, and -(1/V) sum r F = (H/V) strain (1 + strain) sum r r, positive for a stretch.
    """
    dimension = sites.shape[1]
    generator = np.random.default_rng(1)
    size = [5.0, 4.0, 6.0][:dimension]
    arms = sites @ turn(generator, dimension).T
    made = engine(
        size,
        [1] * len(sites),
        kinds=[Kind(sites, 1, base, stiffness=200.0)],
        timestep=1e-9,
        repulsion=0.0,
        friction=0.0,
    )
    made.position = np.mod(np.array(size) * 0.99 + (1.0 + strain) * arms, size)  # across all boundaries
    made.velocity = np.zeros_like(arms)
    made.place()
    named = stress_of(made)
    exact = 200.0 * strain * (1.0 + strain) * arms.T @ arms / np.prod(size)
    assert named["stress_body"][0] == pytest.approx(exact, abs=1e-10)
    assert np.sign(np.trace(named["stress_body"][0])) == np.sign(strain)
    for term in ("kinetic", "conservative", "dissipative", "random"):
        assert named[f"stress_{term}"][0] == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_body_pulled_apart_along_one_axis(axis):
    """A cube stretched along one axis bears tension along that axis alone."""
    made = engine(
        [4.0, 4.0, 4.0], [1] * 8, kinds=[Kind(cube, 1, stiffness=100.0)], timestep=1e-9, repulsion=0.0, friction=0.0
    )
    stretch = np.ones(3)
    stretch[axis] = 1.2
    made.position = 2.0 + cube * stretch
    made.velocity = np.zeros((8, 3))
    made.place()
    exact = np.zeros((3, 3))
    exact[axis, axis] = 100.0 * 0.2 * 1.2 * 8 * 0.125**2 / 64.0
    assert stress_of(made)["stress_body"][0] == pytest.approx(exact, abs=1e-12)
