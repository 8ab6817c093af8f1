"""Without friction and noise the energy is conserved to second order in the time step; springs have a potential."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from suspensions import (
    Kind,
    crooked,
    crooked_flat,
    cube,
    engine,
    potential_energy,
    rod,
    spring_energy,
    square,
    suspension,
)


@pytest.mark.parametrize(("size", "sites"), [([4.0, 4.0], square), ([3.2, 3.2, 3.2], cube)], ids=["2D", "3D"])
def test_energy_fluctuation_is_of_second_order(size, sites):
    """Half a unit of time from four starts at kT = 0.25, sampled at the same moments with time steps 0.008, 0.004,
    0.002 and 0.001: the RMS deviation of the energy from its start falls as dt^2 (fitted order 1.9 to 2.1). The energy
    is counted here: kinetic, pairs, springs of best-placed bases. Colder than usual: the repulsion turns around at once
    where two particles pass through each other, and such encounters would spoil the order.
    """
    kinds = (Kind(sites, 2, stiffness=300.0),)
    steps = np.array([0.008, 0.004, 0.002, 0.001])
    square_deviation = np.zeros(4)
    for seed in range(4):
        start = suspension(size, kinds=kinds, timestep=0.008, temperature=0.25, seed=seed)
        start.run(200)
        for k, timestep in enumerate(steps):
            made = engine(size, start.species, kinds=kinds, timestep=timestep, friction=0.0, noise=0.0)
            made.position, made.velocity = start.position, start.velocity
            made.place()
            energies = []
            for _ in range(32):
                kinetic = 0.5 * np.sum(made.velocity**2)
                energies.append(kinetic + potential_energy(made, kinds, size, 18.75))
                made.run(round(0.016 / timestep))
            square_deviation[k] += np.mean((np.array(energies) - energies[0]) ** 2)
    order = 0.5 * np.polyfit(np.log(steps), np.log(square_deviation), 1)[0]
    assert 1.9 < order < 2.1


@pytest.mark.parametrize(
    "sites", [square, crooked_flat, cube, crooked, rod], ids=lambda s: f"{len(s)} in {s.shape[1]}D"
)
@pytest.mark.parametrize("strain", [1e-3, 0.05])
def test_spring_forces_are_minus_the_gradient_of_the_minimized_energy(sites, strain):
    """Central differences of H/2 min_R sum |r - X - R s|^2, with the rotation from a singular value decomposition."""
    dimension = sites.shape[1]
    generator = np.random.default_rng(7)
    position = 3.0 + sites + strain * generator.standard_normal(sites.shape)
    made = engine([6.0] * dimension, [1] * len(sites), kinds=[Kind(sites, 1)], repulsion=0.0, friction=0.0)
    made.position = position
    made.velocity = np.zeros_like(position)
    made.place()
    gradient = np.zeros_like(position)
    nudge = 1e-5
    for index in np.ndindex(position.shape):
        sides = []
        for sign in (1.0, -1.0):
            nudged = position.copy()
            nudged[index] += sign * nudge
            sides.append(spring_energy(sites, nudged, 3000.0))
        gradient[index] = (sides[0] - sides[1]) / (2.0 * nudge)
    assert made.force == pytest.approx(-gradient, abs=3e-6 * max(1.0, np.abs(gradient).max()))
    assert np.abs(made.force).max() > 1.0 * strain / 1e-3


def test_the_independent_rotation_is_scipys():
    """The decomposition used above against scipy's own routine."""
    generator = np.random.default_rng(8)
    for _ in range(20):
        actual = crooked @ Rotation.random(rng=generator).as_matrix().T + 0.1 * generator.standard_normal(crooked.shape)
        actual -= actual.mean(axis=0)
        rotation, rssd = Rotation.align_vectors(actual, crooked)
        assert 0.5 * rssd**2 == pytest.approx(spring_energy(crooked, actual, 1.0), rel=1e-6)
        assert np.isfinite(rotation.as_matrix()).all()
