"""Means over repeats: exact where they can be, and errors that cover what they promise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tether.study.means import FEWEST_REPEATS, SIGNIFICANCE, chance_of_disagreement, mean_of

NAN = math.nan
ONE_SIGMA = math.erf(1 / math.sqrt(2))
TRIALS = 4000

# A coverage is counted in TRIALS independent trials and compared with its value within 4 standard deviations of such
# a count: a test here fails by chance once in 16000 seeds. The seeds are fixed.
TOLERANCE = 4 * math.sqrt(ONE_SIGMA * (1 - ONE_SIGMA) / TRIALS)


def test_simple_means_are_exact() -> None:
    mean = mean_of([3.0], [0.5], [100])
    assert (mean.value, mean.error, mean.repeats, mean.agree) == (3.0, 0.5, 1, True)
    mean = mean_of([3.0, 5.0], [3.0, 4.0], [100, 100])
    assert (mean.value, mean.error, mean.repeats, mean.agree) == (4.0, 2.5, 2, True)
    mean = mean_of([3.0, 5.0], [2.0, 2.0], [300, 100])
    assert mean.value == 3.5
    assert mean.error == pytest.approx(2.0 * math.hypot(0.75, 0.25))


def test_what_is_missing_is_left_out() -> None:
    nothing = mean_of([], [], [])
    assert math.isnan(nothing.value)
    assert math.isnan(nothing.error)
    assert nothing.repeats == 0
    mean = mean_of([NAN, 3.0, 7.0], [NAN, 1.0, 1.0], [100, 100, 0])
    assert (mean.value, mean.error, mean.repeats) == (3.0, 1.0, 1)


def test_without_errors_of_their_own_it_takes_three_repeats() -> None:
    assert FEWEST_REPEATS == 3
    for values in ([1.0], [1.0, 2.0]):
        mean = mean_of(values, [NAN] * len(values), [10] * len(values))
        assert mean.value == np.mean(values)
        assert math.isnan(mean.error)
    mean = mean_of([1.0, 2.0, 3.0], [NAN, 0.1, NAN], [10, 10, 10])
    # Student's t for 2 degrees of freedom has 84.13 % below 1.3213.
    assert mean.error == pytest.approx(1.32133 * 1.0 / math.sqrt(3), rel=1e-4)
    assert mean.agree


def test_repeats_that_contradict_their_errors_widen_them() -> None:
    """chi^2 = 2 * 5^2 for one degree of freedom: the error is within * sqrt(50)."""
    mean = mean_of([-5.0, 5.0], [1.0, 1.0], [100, 100])
    assert not mean.agree
    assert mean.error == pytest.approx(math.sqrt(0.5) * math.sqrt(50.0))


def test_the_scale_factor_begins_at_the_99_percent_point() -> None:
    """For one degree of freedom, x = +-d with errors of 1 has chi^2 = 2 d^2, and 6.6349 is its 99 % point."""
    edge = math.sqrt(6.6349 / 2)
    assert mean_of([-0.999 * edge, 0.999 * edge], [1.0, 1.0], [1, 1]).agree
    assert not mean_of([-1.001 * edge, 1.001 * edge], [1.0, 1.0], [1, 1]).agree


def test_a_mean_does_not_depend_on_the_order_of_its_repeats() -> None:
    generator = np.random.default_rng(3)
    values, errors, steps = generator.normal(size=6), generator.uniform(0.5, 2, 6), generator.integers(50, 500, 6)
    mean = mean_of(values, errors, steps)
    order = generator.permutation(6)
    again = mean_of(values[order], errors[order], steps[order])
    assert again.value == pytest.approx(mean.value, rel=1e-14)
    assert again.error == pytest.approx(mean.error, rel=1e-14)


def covered(draw, repeats: int, seed: int) -> tuple[float, float]:
    """How often the mean is within an error of 0, which is true; and how often repeats are found to disagree."""
    generator = np.random.default_rng(seed)
    hits = apart = 0
    for _ in range(TRIALS):
        mean = mean_of(*draw(generator, repeats))
        hits += abs(mean.value) <= mean.error
        apart += not mean.agree
    return hits / TRIALS, apart / TRIALS


def alike(generator, repeats):
    """Runs of different lengths, whose errors are what they say."""
    steps = generator.integers(100, 1000, repeats)
    errors = 1.0 / np.sqrt(steps)
    return errors * generator.normal(size=repeats), errors, steps


def unknown(generator, repeats):
    """The same without errors."""
    values, _, steps = alike(generator, repeats)
    return values, np.full(repeats, NAN), steps


def apart(generator, repeats):
    """Runs that differ by five times more than their errors say."""
    values, errors, steps = alike(generator, repeats)
    return values + 5.0 * errors * generator.normal(size=repeats), errors, steps


@pytest.mark.parametrize("repeats", [2, 4, 8])
def test_the_error_of_honest_repeats_covers_two_thirds(repeats: int) -> None:
    coverage, found_apart = covered(alike, repeats, 1)
    # Where repeats disagree by chance the error is widened, so that up to 1 % more are covered.
    assert ONE_SIGMA - TOLERANCE < coverage < ONE_SIGMA + SIGNIFICANCE + TOLERANCE
    assert abs(found_apart - SIGNIFICANCE) < 4 * math.sqrt(SIGNIFICANCE / TRIALS)


@pytest.mark.parametrize("repeats", [3, 4, 8])
def test_the_error_by_scatter_covers_two_thirds(repeats: int) -> None:
    coverage, _ = covered(unknown, repeats, 2)
    assert abs(coverage - ONE_SIGMA) < TOLERANCE


def test_without_students_factor_the_scatter_of_three_would_cover_too_little() -> None:
    """The control: the same trials, with the plain standard error of the mean."""

    def plain(generator, repeats):
        values, _, steps = unknown(generator, repeats)
        weights = steps / steps.sum()
        value = weights @ values
        error = math.sqrt(weights @ (values - value) ** 2 / (repeats - 1))
        return [value], [error], [1]

    coverage, _ = covered(plain, 3, 2)
    assert coverage < ONE_SIGMA - 3 * TOLERANCE


def test_repeats_that_differ_by_more_than_they_say_are_found_out_and_covered() -> None:
    """Errors too small by sqrt(1 + 25): unscaled they would cover 16 %. With 8 repeats nearly all are found out."""
    coverage, found_apart = covered(apart, 8, 4)
    assert found_apart > 0.99
    assert coverage > ONE_SIGMA - 0.06

    def believed(generator, repeats):  # the control: what the runs say of themselves, taken as it is
        values, errors, steps = apart(generator, repeats)
        weights = steps / steps.sum()
        return [weights @ values], [math.sqrt(weights**2 @ errors**2)], [1]

    coverage, _ = covered(believed, 8, 4)
    assert coverage < 0.2


def test_steps_as_weights_are_not_biased_where_errors_follow_the_values() -> None:
    """Each run's error goes with its value, as for a variance: weights 1/s^2 pull the mean down, steps do not.

    The mean over all trials is compared with the true value, 1, within 4 of its own standard errors (false alarm once
    in 16000 seeds).
    """
    generator = np.random.default_rng(5)
    values = generator.gamma(25.0, 1 / 25.0, size=(TRIALS, 4))  # mean 1, standard deviation 0.2
    errors = 0.2 * values
    by_steps = np.array([mean_of(v, e, [100] * 4).value for v, e in zip(values, errors, strict=True)])
    by_errors = np.average(values, axis=1, weights=errors**-2)
    standard_error = 0.2 / math.sqrt(4 * TRIALS)
    assert abs(by_steps.mean() - 1.0) < 4 * standard_error
    assert by_errors.mean() - 1.0 < -20 * standard_error  # the control


def test_the_chance_of_disagreements_is_binomial() -> None:
    assert chance_of_disagreement(0, 50) == 1.0
    assert chance_of_disagreement(1, 50) == pytest.approx(1 - 0.99**50)
    assert chance_of_disagreement(2, 50) == pytest.approx(1 - 0.99**50 - 50 * 0.01 * 0.99**49)
    assert chance_of_disagreement(5, 5) == pytest.approx(1e-10)
