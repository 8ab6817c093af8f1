"""Fits of the viscosity against the volume fraction: exact laws come back, errors hold, poor data is refused in words.

Each statistical test has a false-alarm rate of 1e-4 and a control that fails by far.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import curve_fit
from scipy.stats import chi2, kstest

from tether.analysis.packing import LAWS, Fit, NoFit, fit, fit_all
from tether.theory.suspension import krieger_dougherty, quemada

FALSE_ALARM = 1e-4
EXPERIMENTS = 200
PHI = np.array([0.0, 0.05, 0.1, 0.2, 0.3, 0.4])
TRUE = {2: 0.91, 3: 0.65}


def value(found, name):
    return found.parameters[name].value


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("scale", [3.09, 1e-3, 1e5])
def test_exact_viscosities_give_their_parameters(dimension, scale):
    viscosity = scale * krieger_dougherty(PHI, dimension, 0.7)
    for law in ("krieger_dougherty", "krieger_dougherty_free"):
        found = fit(law, PHI, viscosity, 0.01 * viscosity, dimension)
        assert isinstance(found, Fit)
        assert value(found, "viscosity_at_zero") == pytest.approx(scale, rel=1e-6)
        assert value(found, "maximum_packing") == pytest.approx(0.7, rel=1e-6)
        assert found.chi_square < 1e-6
        assert found.degrees_of_freedom == len(PHI) - len(found.parameters)
        assert found.p_value == pytest.approx(1.0)
        assert found.relative_viscosity(PHI) == pytest.approx(viscosity / scale, rel=1e-6)
    assert value(found, "intrinsic_viscosity") == pytest.approx((dimension + 2) / 2, rel=1e-6)
    found = fit("quemada", PHI, scale * quemada(PHI, 0.8), 0.01 * viscosity, dimension)
    assert value(found, "maximum_packing") == pytest.approx(0.8, rel=1e-6)


def test_another_intrinsic_viscosity_comes_back():
    """(1 - phi/phi_m)^(-[eta] phi_m) with [eta] = 4, which is no disc's."""
    viscosity = (1.0 - PHI / 0.6) ** (-4.0 * 0.6)
    found = fit("krieger_dougherty_free", PHI, viscosity, 0.01 * viscosity, 2)
    assert value(found, "maximum_packing") == pytest.approx(0.6, rel=1e-6)
    assert value(found, "intrinsic_viscosity") == pytest.approx(4.0, rel=1e-6)


def test_the_dilute_laws_see_dilute_points_only():
    phi = np.array([0.0, 0.03, 0.06, 0.08, 0.101, 0.3, 0.5])  # bodies come in whole numbers: 0.101 was to be 0.1
    viscosity = np.where(phi < 0.2, 2.0 * (1.0 + 2.5 * phi + 6.2 * phi**2), 999.0)
    second = fit("second_order", phi, viscosity, np.full(7, 0.01), 3)
    assert second.points == 5
    assert value(second, "intrinsic_viscosity") == pytest.approx(2.5, rel=1e-6)
    assert value(second, "second_order") == pytest.approx(6.2, rel=1e-6)
    first = fit("einstein", phi, viscosity, np.full(7, 0.01), 3)
    assert value(first, "intrinsic_viscosity") == pytest.approx(2.5 + 6.2 * 0.1, abs=0.1), "a chord is steeper"


def test_the_error_of_a_slope_is_that_of_least_squares():
    """Two points: [eta] = (b/a - 1)/phi, its error by hand."""
    found = fit("einstein", [0.0, 0.1], [4.0, 5.2], [0.04, 0.03], 3)
    assert value(found, "intrinsic_viscosity") == pytest.approx(3.0)
    expected = math.hypot(0.03 / 4.0, 5.2 * 0.04 / 4.0**2) / 0.1
    assert found.parameters["intrinsic_viscosity"].error == pytest.approx(expected, rel=1e-5)
    assert found.degrees_of_freedom == 0
    assert math.isnan(found.p_value)
    assert not found.is_contradicted


def experiments(seed, errors):
    generator = np.random.default_rng(seed)
    exact = 3.0 * krieger_dougherty(PHI, 3, TRUE[3])
    error = errors * exact
    return [(exact + error * generator.normal(size=len(PHI)), error) for _ in range(EXPERIMENTS)]


def is_unit(pulls):
    """Whether the sum of squares is a chi-square's, two-sided."""
    total = float(np.sum(np.square(pulls)))
    return chi2.ppf(FALSE_ALARM / 2, len(pulls)) < total < chi2.isf(FALSE_ALARM / 2, len(pulls))


def pull(found):
    packing = found.parameters["maximum_packing"]
    return (packing.value - TRUE[3]) / packing.error


@pytest.mark.parametrize("law", ["krieger_dougherty", "krieger_dougherty_free"])
def test_errors_and_p_values_hold(law):
    fits = [fit(law, PHI, viscosity, error, 3) for viscosity, error in experiments(1, 0.01)]
    pulls = [pull(each) for each in fits]
    assert is_unit(pulls)
    assert not is_unit(1.5 * np.array(pulls)), "control: the test would see errors that are too small"
    assert kstest([each.p_value for each in fits], "uniform").pvalue > FALSE_ALARM
    wrong = [fit("quemada", PHI, viscosity, 0.3 * error, 3) for viscosity, error in experiments(1, 0.01)]
    assert kstest([each.p_value for each in wrong], "uniform").pvalue < FALSE_ALARM


def test_the_plain_fluids_error_is_shared_rightly():
    """Of a plain fluid known five times worse than the suspensions; the control fits relative viscosities."""
    errors = np.where(PHI == 0.0, 0.02, 0.004)
    runs = experiments(2, errors)
    assert is_unit([pull(fit("krieger_dougherty", PHI, viscosity, error, 3)) for viscosity, error in runs])
    pulls = []
    for viscosity, error in runs:
        relative = viscosity[1:] / viscosity[0]
        its_error = relative * np.hypot(error[1:] / viscosity[1:], error[0] / viscosity[0])
        (packing,), covariance = curve_fit(
            lambda phi, packing: krieger_dougherty(phi, 3, packing), PHI[1:], relative, [0.65], its_error,
            absolute_sigma=True, bounds=(0.41, 2.0),
        )  # fmt: skip
        pulls.append((packing - TRUE[3]) / math.sqrt(covariance[0, 0]))
    assert not is_unit(pulls)


def test_a_law_that_does_not_describe_the_points_is_said_not_to():
    viscosity = 3.0 * krieger_dougherty(PHI, 3, 0.65)
    assert fit("quemada", PHI, viscosity, 0.001 * viscosity, 3).is_contradicted
    assert not fit("krieger_dougherty", PHI, viscosity, 0.001 * viscosity, 3).is_contradicted


@pytest.mark.parametrize(
    ("phi", "viscosity", "error", "reason"),
    [
        ([], [], [], "0 volume fractions with known errors, and it needs 2"),
        ([0.0, 0.0], [3.0, 3.1], [0.1, 0.1], "1 volume fraction with known errors, and it needs 2"),
        ([0.0, 0.2], [3.0, 5.0], [0.1, math.nan], "1 volume fraction with known errors, and it needs 2"),
        ([0.0, 0.02], [3.0, 3.1], [0.1, 0.1], "do not determine the maximum packing"),
        ([0.0, 0.2, 0.4], [3.0, 2.0, 1.0], [0.1, 0.1, 0.1], "do not determine the maximum packing"),
        ([0.0, 0.2], [-3.0, -5.0], [0.1, 0.1], "no curve of this law"),
    ],
)
def test_poor_data_is_refused_in_words(phi, viscosity, error, reason):
    found = fit("krieger_dougherty", phi, viscosity, error, 2)
    assert isinstance(found, NoFit)
    assert reason in found.reason


NUMBER = st.floats(-10.0, 1e6) | st.sampled_from([0.0, 1.0, 3.0, math.nan, math.inf])


@settings(max_examples=60)
@given(st.lists(st.tuples(st.floats(-0.1, 1.2) | st.just(0.0), NUMBER, NUMBER), max_size=6), st.sampled_from([2, 3]))
def test_nothing_makes_it_fail(rows, dimension):
    """No error and no warning, which the test run makes one; what is found is finite."""
    found = fit_all(*np.array(rows, dtype=np.float64).reshape(-1, 3).T, dimension)
    assert [each.law for each in found] == list(LAWS)
    for each in found:
        if isinstance(each, Fit):
            assert all(math.isfinite(e.value) and math.isfinite(e.error) for e in each.parameters.values())
            assert np.isfinite(each.relative_viscosity(0.0))


def test_arrays_of_different_shapes_are_refused():
    with pytest.raises(ValueError, match="give one of each for every point"):
        fit("quemada", [0.0, 0.1], [3.0], [0.1], 2)
