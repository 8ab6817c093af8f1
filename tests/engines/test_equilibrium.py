"""Short statistics of plain fluids against values measured with an independent program, with stated false-alarm rates.

Errors are those of 20 block means; the bars are Student's t at the family-wise rate that each test states.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from suspensions import Kind, limit, mean_and_error, measured, square, suspension, total_stress


def pressure(named):
    stress = total_stress(named)
    return -np.trace(stress, axis1=1, axis2=2) / stress.shape[1]


@pytest.mark.parametrize(
    ("size", "timestep", "expected"),
    [([10.0, 10.0], 0.01, 40.52), ([6.0, 6.0, 6.0], 0.005, 32.68)],
    ids=["2D", "3D"],
)
def test_pressure_and_temperature(size, timestep, expected):
    """Pressure 40.52 in 2D and 32.68 in 3D (0.1 % left to their own error and to the small box), kinetic part 4.00, kT
    within 0.2 %. False-alarm rate 1e-4 over the three of each dimension.
    """
    made = suspension(size, timestep=timestep, seed=31)
    made.run(1000)
    named = measured(made, made.run(3000, 1))
    bar = limit(1e-4, comparisons=3)
    value, error = mean_and_error(pressure(named))
    assert error < 0.002 * expected
    assert abs(value - expected) < bar * error + 0.001 * expected
    kinetic = -np.trace(named["stress_kinetic"], axis1=1, axis2=2) / len(size)
    free = 1.0 - 1.0 / len(made.position)  # the momentum of all is fixed
    value, error = mean_and_error(kinetic / free)
    assert abs(value - 4.0) < bar * error + 0.002 * 4.0
    value, error = mean_and_error(named["thermal_solvent"] / (len(size) * len(made.position) * free))
    assert abs(value - 1.0) < bar * error + 0.002


@pytest.mark.parametrize(("temperature", "friction", "exponent"), [(0.35, 4.5, 0.5), (1.0, 9.0, 2.0), (2.0, 3.0, 1.0)])
@pytest.mark.parametrize("random", ["uniform", "gaussian"])
def test_fluid_takes_the_temperature_of_sigma_and_gamma(temperature, friction, exponent, random):
    """kT = sigma^2 / (2 gamma) for every exponent and both kinds of noise, from a start at twice that. False-alarm rate
    1e-4 each; half a percent is left to the time step.
    """
    made = suspension(
        [6.0, 6.0],
        temperature=temperature,
        friction=friction,
        exponent=exponent,
        random=random,
        timestep=0.005,
        seed=32,
    )
    made.velocity = np.sqrt(2.0) * made.velocity
    made.place()
    made.run(1500)
    named = measured(made, made.run(4000, 5))
    value, error = mean_and_error(named["thermal_solvent"] / (2 * (len(made.position) - 1)))
    assert error < 0.02 * temperature
    assert abs(value - temperature) < limit(1e-4) * error + 0.005 * temperature


def test_masses_of_species_share_one_temperature():
    """Constituents four times as heavy as the solvent. False-alarm rate 1e-4 over both species."""
    made = suspension([6.0, 6.0], kinds=(Kind(square, 9),), species_mass=(1.0, 4.0), timestep=0.005, seed=33)
    made.run(1500)
    named = measured(made, made.run(6000, 5))
    total = 144 + 36 * 4.0
    for name, count, mass in (("solvent", 144, 1.0), ("constituents", 36, 4.0)):
        value, error = mean_and_error(named[f"thermal_{name}"] / (2 * count * (1.0 - mass / total)))
        assert abs(value - 1.0) < limit(1e-4, comparisons=2) * error + 0.005


@pytest.mark.parametrize("verlet_lambda", [0.4, 0.65])
def test_other_predictions_of_velocity_hold_the_temperature(verlet_lambda):
    """Groot & Warren's lambda other than 1/2: another path, the same fluid. Its temperature is off to first order in
    (lambda - 1/2) dt; at dt = 0.0025 less than 1 % is left to that. False-alarm rate 1e-4 each.
    """
    shared = {"size": [6.0, 6.0], "timestep": 0.0025, "seed": 34}
    made, usual = suspension(**shared, verlet_lambda=verlet_lambda), suspension(**shared)
    for one in (made, usual):
        one.run(2)
    assert np.abs(made.velocity - usual.velocity).max() > 1e-6
    made.run(1000)
    named = measured(made, made.run(8000, 5))
    value, error = mean_and_error(named["thermal_solvent"] / (2 * (len(made.position) - 1)))
    assert error < 0.01
    assert abs(value - 1.0) < limit(1e-4) * error + 0.01


@pytest.mark.parametrize(("dimension", "shear_rate"), [(2, 0.0), (2, 0.5), (3, 0.5)])
def test_random_stress_is_zero_on_average(dimension, shear_rate):
    """The noise of a step is independent of its positions and of every other step, so each entry's samples have mean
    zero and no correlation in time: z against their own scatter, false-alarm rate 1e-4 each over the entries of a case.
    """
    made = suspension([6.0, 6.0] if dimension == 2 else [3.5] * 3, shear_rate=shear_rate, timestep=0.005, seed=35)
    made.run(100)
    random = measured(made, made.run(4000, 1))["stress_random"]
    entries = random[:, *np.triu_indices(dimension)]
    z = entries.mean(axis=0) / (entries.std(axis=0) / np.sqrt(len(entries)))
    assert np.abs(z).max() < stats.norm.isf(0.5e-4 / entries.shape[1])
    assert entries.std(axis=0).min() > 1.0
    lag = (entries[1:] * entries[:-1]).mean(axis=0) / entries.var(axis=0) * np.sqrt(len(entries) - 1)
    assert np.abs(lag).max() < stats.norm.isf(0.5e-4 / entries.shape[1])
