"""Pressure and sound speed: against measured fluids, as far off as stated, and the mean-field integral."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from tether.theory import equation_of_state as eos


@pytest.mark.parametrize(
    ("density", "repulsion", "dimension", "measured", "excess"),
    [
        (4.0, 18.75, 3, 32.68, 0.05),  # the paper's fluid
        (3.0, 25.0, 3, 23.66, 0.09),  # Bindgen et al., Phys. Fluids 33 (2021), doi 10.1063/5.0055396
        (4.0, 18.75, 2, 40.52, 0.07),  # the paper's fluid in 2D
    ],
)
def test_as_much_too_high_as_stated(density, repulsion, dimension, measured, excess):
    value = eos.pressure(density=density, temperature=1.0, repulsion=repulsion, dimension=dimension)
    assert value / measured - 1.0 == pytest.approx(excess, abs=0.006)


@pytest.mark.parametrize(("dimension", "surface"), [(2, 2.0 * math.pi), (3, 4.0 * math.pi)])
def test_coefficient_against_the_mean_field_virial(dimension, surface):
    """p - n kT = n^2/(2 d) integral of r a (1 - r/r_c) over the ball; Groot and Warren's fit is 4 % lower."""
    cutoff = 1.3
    virial, _ = quad(lambda r: surface * r**dimension * (1.0 - r / cutoff) / (2.0 * dimension), 0.0, cutoff)
    value = eos.pressure(density=1.0, temperature=0.0, repulsion=1.0, dimension=dimension, cutoff=cutoff)
    assert value / virial == pytest.approx({2: 1.0, 3: 0.9645}[dimension], rel=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_sound_speed_is_the_slope_of_the_pressure(dimension):
    fluid = {"temperature": 0.7, "repulsion": 20.0, "dimension": dimension, "cutoff": 1.1}
    step = 1e-5
    slope = (eos.pressure(density=4.0 + step, **fluid) - eos.pressure(density=4.0 - step, **fluid)) / (2 * step)
    assert eos.sound_speed(density=4.0, mass=1.8, **fluid) == pytest.approx(math.sqrt(slope / 1.8), rel=1e-8)


def test_sound_speed_from_pressure():
    """An ideal gas has c^2 = kT/m; the paper's fluid by its measured pressure c^2 = 1 + 2 (32.68 - 4)/4."""
    assert eos.sound_speed_from_pressure(pressure=8.0, density=4.0, temperature=2.0, mass=0.5) == pytest.approx(2.0)
    assert eos.sound_speed_from_pressure(pressure=32.68, density=4.0, temperature=1.0) == pytest.approx(
        math.sqrt(15.34)
    )
    assert math.isnan(eos.sound_speed_from_pressure(pressure=-50.0, density=4.0, temperature=1.0))


def test_arrays_go_through():
    fluid = {"temperature": np.array([[1.0], [0.5]]), "repulsion": 18.75, "dimension": 3}
    for formula in (eos.pressure, eos.sound_speed):
        assert isinstance(formula(density=4.0, temperature=1.0, repulsion=18.75, dimension=3), float)
        many = formula(density=np.array([3.0, 4.0, 5.0]), **fluid)
        assert many[1, 1] == formula(density=4.0, temperature=0.5, repulsion=18.75, dimension=3)
    speeds = eos.sound_speed_from_pressure(pressure=np.array([32.0, -100.0]), density=4.0, temperature=1.0)
    np.testing.assert_array_equal(np.isnan(speeds), [False, True])
