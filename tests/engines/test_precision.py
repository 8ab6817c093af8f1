"""Mixed precision, double precision and the plain reference: the same forces to rounding, the same physics."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy import stats
from suspensions import engine, limit, mean_and_error, measured, potential_energy, suspension, total_stress

from tether import _core

ENGINES = {
    "mixed": {"pairs": "packed", "precision": "mixed"},
    "double": {"pairs": "packed", "precision": "double"},
    "reference": {"pairs": "reference"},
}
PACKED = ["mixed", "double"]
FLOWS = [(0.0, 0.0), (0.8, 0.0), (0.8, 3.21), (-0.8, 7.7), (0.0, 2.5)]

# Forces


def forces(which, size, shear_rate, offset, exponent, random):
    """Of a thousand particles or more at thermal density, anywhere; with the positions and the largest noise."""
    generator = np.random.default_rng(5)
    count = round(4.0 * math.prod(size))
    made = engine(
        size,
        [0] * count,
        timestep=0.005,
        seed=5,
        shear_rate=shear_rate,
        exponent=exponent,
        random=random,
        **ENGINES[which],
    )
    position = generator.random((count, len(size))) * size
    velocity = generator.standard_normal(position.shape)
    velocity[:, 0] += shear_rate * (position[:, 1] - 0.5 * size[1])
    made.position, made.velocity, made.offset, made.step = position, velocity, offset, 17
    made.place()
    loudest = math.sqrt(2.0 * 4.5 / 0.005) * (math.sqrt(3.0) if random == "uniform" else 6.7)
    return made.force, position, loudest


def bound(which, largest, loudest, distance, exponent):
    """What rounding makes of a force, at most.

    A pair's force is a product of a few factors, each rounded: some ten roundings of 6e-8 (float) or 1e-16, of a force
    that may be as large as the largest of a particle, and some ten pairs whose errors add up by their squares. Two
    pairs have more. The direction of the closest pair is as wrong as positions are (a side of 20 times 2^-32 or 2e-16)
    over its distance. And the weight w^(s/2) of the noise amplifies the rounding of w = 1 - r/r_c, some 2e-7 or 4e-15,
    by its slope s/2 w^(s/2 - 1), steepest for the pair that is nearest to the cutoff.
    """
    rounding, of_position, of_weight = (6e-8, 5e-9, 2e-7) if which == "mixed" else (1e-16, 4e-15, 4e-15)
    steepest = 0.5 * exponent * max(1.0, np.abs(1.0 - distance).min() ** (0.5 * exponent - 1.0))
    return 40.0 * rounding * largest + loudest * (of_position / distance.min() + steepest * of_weight)


@pytest.mark.parametrize("random", ["uniform", "gaussian"])
@pytest.mark.parametrize("exponent", [0.5, 2.0, 1.3])
@pytest.mark.parametrize(("shear_rate", "offset"), FLOWS)
@pytest.mark.parametrize("size", [(20.3, 21.0), (9.3, 10.0, 11.1)], ids=["2D", "3D"])
def test_forces_agree_to_rounding(size, shear_rate, offset, exponent, random):
    """In mixed precision to 3e-5 of the largest force (s = 1/2; 5e-6 for the others), in double to 2e-13, and in both
    below what the roundings add up to. The control: the two precisions are not one.
    """
    case = (list(size), shear_rate, offset, exponent, random)
    wanted, position, loudest = forces("reference", *case)
    _, separation, _ = _core.neighbor_pairs(position, list(size), shear_rate, offset, 1.001)
    distance = np.linalg.norm(separation, axis=1)
    largest = np.abs(wanted).max()
    wrong = {which: np.abs(forces(which, *case)[0] - wanted).max() for which in PACKED}
    for which in PACKED:
        assert wrong[which] < bound(which, largest, loudest, distance, exponent)
    assert wrong["mixed"] < (3e-5 if exponent == 0.5 else 5e-6) * largest
    assert wrong["double"] < 2e-13 * largest
    assert wrong["mixed"] > 1e-8 * largest


@pytest.mark.parametrize("which", PACKED)
@pytest.mark.parametrize("random", ["uniform", "gaussian"])
@pytest.mark.parametrize(("shear_rate", "offset"), FLOWS)
@pytest.mark.parametrize("size", [(20.3, 21.0), (9.3, 10.0, 11.1)], ids=["2D", "3D"])
def test_forces_of_all_pairs_sum_up_to_nothing(which, random, size, shear_rate, offset):
    """Exactly: forces are multiples of one quantum, and the two sides of a pair are one integer. The control: they are
    not, in the reference.
    """
    case = (list(size), shear_rate, offset, 0.5, random)
    force, *_ = forces(which, *case)
    assert [math.fsum(column) for column in force.T] == [0.0] * len(size)
    force, *_ = forces("reference", *case)
    assert any(math.fsum(column) != 0.0 for column in force.T)


# Conservation


@pytest.mark.parametrize("size", [(4.0, 4.0), (3.5, 3.0, 3.2)], ids=["2D", "3D"])
def test_momentum_in_mixed_precision(size):
    """Over twenty thousand steps at rest: less than 1e-12 a particle, all of it from rounding velocities."""
    made = suspension(list(size), seed=3, timestep=0.005, precision="mixed")
    start = made.velocity.sum(axis=0)
    made.run(20_000)
    assert made.fault is None
    assert np.abs(made.velocity.sum(axis=0) - start).max() < 1e-12 * len(made.position)


def energies(start, which, friction=0.0):
    """Energy a particle, at every tenth of 2000 steps without noise."""
    size = [3.2, 3.2, 3.2]
    made = engine(size, start.species, timestep=0.004, friction=friction, noise=0.0, **ENGINES[which])
    made.position, made.velocity = start.position, start.velocity
    made.place()
    found = []
    for _ in range(200):
        found.append(0.5 * np.sum(made.velocity**2) + potential_energy(made, (), size, 18.75))
        made.run(10)
    return np.array(found) / len(start.position)


def test_energy_in_mixed_precision():
    """Drift over 2000 steps and fluctuation about it, at kT = 1/4, from ten starts. Paths part soon: both are random.
    Student's t test of the ten differences from double precision has a false-alarm rate of 1e-4 for each. The drifts
    are below 1e-5 kT a particle and a unit of time, the fluctuations the same to 20 %. The control: a friction of a
    thousandth of the usual is noticed.
    """
    drift, fluctuation = {}, {}
    starts = []
    for seed in range(10):
        start = suspension([3.2, 3.2, 3.2], timestep=0.004, temperature=0.25, seed=seed)
        start.run(200)
        starts.append(start)
    time = 0.04 * np.arange(200)
    for name, which, friction in [("mixed", "mixed", 0.0), ("double", "double", 0.0), ("braked", "mixed", 4.5e-3)]:
        series = np.array([energies(start, which, friction) for start in starts])
        slope, level = np.polyfit(time, series.T, 1)
        drift[name] = slope
        fluctuation[name] = np.log((series - slope[:, None] * time - level[:, None]).std(axis=1))
    assert stats.ttest_rel(drift["mixed"], drift["double"]).pvalue > 1e-4
    assert stats.ttest_rel(fluctuation["mixed"], fluctuation["double"]).pvalue > 1e-4
    for name in PACKED:
        assert abs(drift[name].mean()) < 1e-5 * 0.25
    assert abs(fluctuation["mixed"].mean() - fluctuation["double"].mean()) < math.log(1.2)
    assert stats.ttest_rel(drift["braked"], drift["double"]).pvalue < 1e-4


# Equilibrium


def test_temperature_and_pressure_are_those_of_the_reference():
    """A small fluid at rest, each engine with its own seed, so that the three are independent; any of six differences
    fails with a probability of 1e-4 in all. The control: a fluid that is 4 % warmer is not the same.
    """
    found = {}
    for seed, (name, options) in enumerate([*ENGINES.items(), ("warmer", ENGINES["mixed"] | {"temperature": 1.04})]):
        made = suspension([4.0, 4.0, 4.0], timestep=0.01, seed=seed, **options)
        made.run(200)
        named = measured(made, made.run(6000, 10))
        pressure = -np.trace(total_stress(named), axis1=1, axis2=2) / 3.0
        found[name] = [mean_and_error(series) for series in (named["thermal_solvent"], pressure)]

    def worst(a, b):
        return max(abs(m - n) / math.hypot(s, t) for (m, s), (n, t) in zip(found[a], found[b], strict=True))

    most = limit(1e-4, 6)
    for a, b in itertools.combinations(ENGINES, 2):
        assert worst(a, b) < most
    assert worst("warmer", "reference") > most
