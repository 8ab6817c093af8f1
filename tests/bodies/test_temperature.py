"""Equipartition at rest: what every degree of freedom holds, with a stated chance of a false alarm.

Errors are those of 20 block means; the bars are Student's t at the family-wise rate that each test states.
"""

from __future__ import annotations

import pytest
from suspensions import Kind, cube, limit, mean_and_error, measured, rod, square, suspension


def temperatures(made, named, sites, count):
    """Series of kT from each group's energy and degrees of freedom; the total momentum is fixed, which takes from each
    group its share of the mass of all.
    """
    dimension = made.position.shape[1]
    particles = len(made.position)
    constituents = count * len(sites)
    solvent = particles - constituents
    free = 1.0 - 1.0 / particles
    return {
        "solvent": named["thermal_solvent"] / (dimension * solvent * free),
        "constituents": named["thermal_constituents"] / (dimension * constituents * free),
        "translation": named["thermal_translation"] / (dimension * count * (1.0 - len(sites) / particles)),
        "rotation": named["spin_energy"] / (count * made.rotational_freedom[0]),
    }


CASES = {
    "2D squares": ([10.0, 10.0], square, 25, 1, 0.01, 12_000),
    "3D cubes": ([4.0, 4.0, 4.0], cube, 8, 3, 0.005, 8000),
    "3D rods": ([4.0, 4.0, 4.0], rod, 12, 2, 0.01, 8000),
}


@pytest.mark.parametrize("case", CASES)
def test_every_temperature_is_that_of_the_fluid(case):
    """Massless bases at kT = 0.8: solvent, constituents, translation and rotation of bodies (three axes, two of a rod,
    one in 2D). False-alarm rate 1e-4 over the four of each case; half a percent is left to the time step.
    """
    size, sites, count, freedom, timestep, steps = CASES[case]
    made = suspension(size, kinds=(Kind(sites, count),), temperature=0.8, timestep=timestep, seed=12)
    assert made.rotational_freedom == [freedom]
    made.run(1000)
    found = temperatures(made, measured(made, made.run(steps, 5)), sites, count)
    for name, series in found.items():
        value, error = mean_and_error(series)
        assert error < 0.04 * 0.8, name
        assert abs(value - 0.8) < limit(1e-4, comparisons=4) * error + 0.005 * 0.8, f"{name}: {value} +- {error}"


def test_newton_euler_base_heats_its_constituents():
    """2D at volume fraction 0.2, kT = 1: about 2.5 in steady state (a finding about that base), while the bodies'
    translation stays near 1. Under the same conditions the massless base stays at 1. False-alarm rate 1e-4 for each
    bar; five percent are left to the translation of bodies between hot constituents.
    """
    found = {}
    for base in ("massless", "newton-euler"):
        kinds = (Kind(square, 25, base),)
        made = suspension([10.0, 10.0], kinds=kinds, seed=13)
        made.run(3000)
        found[base] = temperatures(made, measured(made, made.run(4000, 5)), square, 25)
    bar = limit(1e-4)
    value, error = mean_and_error(found["newton-euler"]["constituents"])
    assert value - bar * error > 1.5
    value, error = mean_and_error(found["newton-euler"]["translation"])
    assert abs(value - 1.0) < bar * error + 0.05
    value, error = mean_and_error(found["massless"]["constituents"])
    assert abs(value - 1.0) < bar * error + 0.005
