"""Estimates: block means, errors against the exact ones of AR(1) series, short series.

Every random test has a fixed seed, so it either always passes or never does. The false-alarm rates given are
the chance that a seed chosen blindly would have failed a correct estimator.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from tether.estimate import Estimate, block_levels, drifts, estimate, estimate_function


def autoregressive(samples: int, memory: float, generator: np.random.Generator, repeats: int = 1) -> np.ndarray:
    """AR(1) series of unit variance and mean 0 with rho(t) = exp(-t / memory); shape (repeats, samples)."""
    correlation = math.exp(-1.0 / memory)
    noise = generator.standard_normal((repeats, samples)) * math.sqrt(1.0 - correlation**2)
    noise[:, 0] = generator.standard_normal(repeats)  # stationary from the first sample on
    return lfilter([1.0], [1.0, -correlation], noise, axis=1)


def exact_inefficiency(memory: float) -> float:
    """1 + 2 sum of rho(t) = (1 + rho) / (1 - rho)."""
    return 1.0 / math.tanh(0.5 / memory)


def exact_error(samples: int, memory: float) -> float:
    """Standard deviation of the mean of an AR(1) series, from the double sum over all pairs of samples."""
    rho = math.exp(-1.0 / memory)
    pairs = 2.0 * rho * (samples * (1.0 - rho) - (1.0 - rho**samples)) / (1.0 - rho) ** 2
    return math.sqrt(samples + pairs) / samples


def test_exact_error_is_the_double_sum():
    times = np.arange(50)
    direct = np.exp(-np.abs(times[:, None] - times) / 3.0).sum()
    assert exact_error(50, 3.0) == pytest.approx(math.sqrt(direct) / 50, rel=1e-12)


class TestBlocks:
    def test_by_hand(self):
        levels = block_levels([1.0, 3.0, 2.0, 4.0])
        # Deviations from 2.5: -1.5, 0.5, -0.5, 1.5; squares sum to 5, neighbors' products to -1.75.
        assert (levels[0].length, levels[0].blocks) == (1, 4)
        assert levels[0].variance == pytest.approx(5.0 / 4.0)
        assert levels[0].correlation == pytest.approx(-1.75 / 5.0)
        assert levels[0].variance_of_mean == pytest.approx(5.0 / (4.0 * 3.0))
        # Blocks of two: 2 and 3, deviations -0.5 and 0.5.
        assert (levels[1].length, levels[1].blocks) == (2, 2)
        assert levels[1].variance == pytest.approx(0.25)
        assert levels[1].correlation == pytest.approx(-0.5)
        assert len(levels) == 2

    def test_against_plain_reshaping_and_the_remainder_left_out(self):
        series = np.random.default_rng(1).normal(1000.0, 1.0, 1000)
        for level in block_levels(series):
            blocks = series[: level.length * level.blocks].reshape(level.blocks, level.length).mean(axis=1)
            assert level.blocks == len(series) // level.length
            assert level.variance == pytest.approx(blocks.var(), rel=1e-9)
            assert level.variance_of_mean == pytest.approx(blocks.var(ddof=1) / level.blocks, rel=1e-9)

    def test_correlation_between_neighbors_is_put_in_but_never_taken_out(self):
        rising = block_levels([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])[0]
        assert rising.corrected_variance_of_mean > 1.5 * rising.variance_of_mean
        alternating = block_levels([0.0, 1.0] * 4)[0]
        assert alternating.corrected_variance_of_mean == alternating.variance_of_mean


class TestKnownSeries:
    def test_white_noise(self):
        result = estimate(np.random.default_rng(2).normal(5.0, 2.0, 2**16))
        assert result.converged
        assert result.samples == 2**16
        assert abs(result.value - 5.0) < 5.0 * result.error
        # The error of the error is 3 % here: five of them.
        assert result.error == pytest.approx(2.0 / 2**8, rel=0.15)
        assert result.inefficiency == pytest.approx(1.0, abs=0.3)

    @pytest.mark.parametrize(("samples", "memory"), [(2048, 0.7), (5000, 5.0), (16384, 20.0)])
    def test_mean_error_and_inefficiency_of_correlated_series(self, samples, memory):
        """The error's own mean is within 8 %, its scatter within a factor 1.5 of error_of_error."""
        all_series = autoregressive(samples, memory, np.random.default_rng(3), repeats=50)
        results = [estimate(series) for series in all_series]
        assert all(result.converged for result in results)
        errors = np.array([result.error for result in results])
        assert errors.mean() == pytest.approx(exact_error(samples, memory), rel=0.08)
        inefficiency = np.mean([result.inefficiency for result in results])
        assert inefficiency == pytest.approx(exact_inefficiency(memory), rel=0.15)
        stated = np.mean([result.error_of_error for result in results])
        assert 1.0 / 1.5 < errors.std() / stated < 1.5

    def test_anticorrelated_series_is_better_than_independent(self):
        noise = np.random.default_rng(4).standard_normal(20001)
        series = noise[1:] - 0.5 * noise[:-1]  # rho(1) = -0.4: g = 0.2
        result = estimate(series)
        assert result.converged
        assert result.inefficiency == pytest.approx(0.2, rel=0.5)

    def test_slow_component_beneath_fast_noise(self):
        """Where the variance alone chooses too short blocks: 2 % of slow variance carry 97 % of the error.

        Measured over many seeds: 0.93 of the true error (a criterion of block length alone: 0.56).
        """
        generator = np.random.default_rng(5)
        slow = math.sqrt(0.02) * autoregressive(50000, 200.0, generator, repeats=25)
        fast = generator.standard_normal(slow.shape)
        true = math.hypot(1.0 / math.sqrt(50000), math.sqrt(0.02) * exact_error(50000, 200.0))
        errors = [estimate(series).error for series in slow + fast]
        assert np.mean(errors) == pytest.approx(true, rel=0.15)


class TestCoverage:
    """How often the true mean lies within one and two errors of the estimate, over 1000 series.

    Nominal 68.3 and 95.4 %; errors that are themselves uncertain by 12 % cost about 1 % of each. The bands
    are four standard deviations of a count of 1000 wide on either side (false-alarm rate 1e-4).
    """

    samples, memory, repeats = 4096, 5.0, 1000
    bands = ((0.615, 0.735), (0.915, 0.975))

    @property
    def all_series(self) -> np.ndarray:
        return autoregressive(self.samples, self.memory, np.random.default_rng(6), self.repeats)

    def covered(self, values, errors) -> tuple[bool, bool]:
        distance = np.abs(np.asarray(values)) / np.asarray(errors)
        within_one, within_two = (float(np.mean(distance < width)) for width in (1.0, 2.0))
        (low_one, high_one), (low_two, high_two) = self.bands
        return low_one < within_one < high_one, low_two < within_two < high_two

    def test_blocking(self):
        results = [estimate(series) for series in self.all_series]
        assert np.mean([result.converged for result in results]) > 0.99
        assert self.covered([r.value for r in results], [r.error for r in results]) == (True, True)

    def test_naive_error_must_fail(self):
        all_series = self.all_series
        naive = all_series.std(axis=1, ddof=1) / math.sqrt(self.samples)
        assert self.covered(all_series.mean(axis=1), naive) == (False, False)


class TestTooShort:
    @pytest.mark.parametrize("samples", [1, 2, 3, 10, 49])
    def test_few_samples(self, samples):
        result = estimate(np.random.default_rng(7).standard_normal(samples))
        assert not result.converged
        assert math.isnan(result.error)
        assert "too short" in str(result)

    @pytest.mark.parametrize(("independent", "flagged"), [(3, 0.99), (16, 0.9)])
    def test_series_of_few_correlation_times(self, independent, flagged):
        """Series worth `independent` samples are found out, nearly all of them."""
        samples = 4096
        memory = 0.5 * samples / independent
        all_series = autoregressive(samples, memory, np.random.default_rng(8), repeats=100)
        found = [not estimate(series).converged for series in all_series]
        assert np.mean(found) >= flagged

    def test_long_enough_is_not_flagged(self):
        all_series = autoregressive(16384, 20.0, np.random.default_rng(9), repeats=50)
        assert np.mean([estimate(series).converged for series in all_series]) == 1.0

    def test_drift_alone(self):
        assert not estimate(np.linspace(0.0, 1.0, 10000)).converged

    def test_constant(self):
        result = estimate(np.full(1000, 0.1))
        assert (result.value, result.error, result.converged) == (pytest.approx(0.1), 0.0, True)
        assert result.inefficiency == 1.0
        assert str(result) == "0.1 +- 0"
        assert not estimate([1.0, 1.0]).converged

    def test_constant_but_for_rounding(self):
        series = np.full(1000, 0.1)
        series[::3] = np.nextafter(0.1, 1.0)
        assert estimate(series).error == 0.0

    @pytest.mark.parametrize(
        ("series", "message"),
        [([], "empty"), ([[1.0, 2.0]], "one dimension"), ([1.0, math.nan], "finite"), ([math.inf], "finite")],
    )
    def test_no_series(self, series, message):
        with pytest.raises(ValueError, match=message):
            estimate(series)


class TestFunctionsOfMeans:
    def test_ratio_of_correlated_columns(self):
        """x and y = 2 x + noise: the ratio of means is known far better than independent errors say."""
        generator = np.random.default_rng(10)
        x = 3.0 + autoregressive(8192, 5.0, generator)[0]
        y = 2.0 * x + 0.01 * generator.standard_normal(8192)
        ratio = estimate_function(lambda means: means[1] / means[0], np.column_stack([x, y]))
        assert ratio.value == pytest.approx(y.mean() / x.mean())
        assert ratio.error == pytest.approx(0.01 / 3.0 / math.sqrt(8192), rel=0.2)
        independent = estimate(y) / estimate(x)
        assert independent.error > 50.0 * ratio.error

    def test_mean_of_a_column_is_the_estimate_itself(self):
        columns = autoregressive(4096, 3.0, np.random.default_rng(11), repeats=2).T
        result = estimate_function(lambda means: means[1], columns, unit="s")
        plain = estimate(columns[:, 1], unit="s")
        assert result.error == pytest.approx(plain.error, rel=1e-9)
        assert result.value == plain.value
        assert result.unit == "s"

    def test_coverage_of_a_variance(self):
        """<x^2> - <x>^2 of AR(1): true value 1, 68 and 95 % of 300 within one and two errors, +- 4 sigma."""
        all_series = 2.0 + autoregressive(4096, 4.0, np.random.default_rng(12), repeats=300)
        results = [
            estimate_function(lambda m: m[1] - m[0] ** 2, np.column_stack([series, series**2])) for series in all_series
        ]
        distance = np.array([abs(result.value - 1.0) / result.error for result in results])
        assert 0.57 < np.mean(distance < 1.0) < 0.79
        assert 0.90 < np.mean(distance < 2.0) < 0.99

    def test_rotation_temperature_with_a_mean_spin(self):
        """Bodies spinning about s at kT: (<L.omega> - 2 s.<L> + s.<I>s)/3 is kT, <L.omega>/3 is not."""
        generator = np.random.default_rng(13)
        inertia, temperature, spin = 0.5, 2.0, np.array([0.0, 0.0, -1.5])
        omega = spin + generator.normal(0.0, math.sqrt(temperature / inertia), (20000, 3))
        momentum = inertia * omega
        twice_energy = (momentum * omega).sum(axis=1)
        columns = np.column_stack([twice_energy, omega, momentum, np.full(20000, inertia)])

        def kinetic_temperature(means):
            mean_spin = means[1:4]
            return (means[0] - 2.0 * mean_spin @ means[4:7] + means[7] * mean_spin @ mean_spin) / 3.0

        result = estimate_function(kinetic_temperature, columns)
        assert abs(result.value - temperature) < 4.0 * result.error
        assert result.error == pytest.approx(temperature * math.sqrt(2.0 / 3.0 / 20000), rel=0.25)
        assert abs(twice_energy.mean() / 3.0 - temperature) > 20.0 * result.error

    @pytest.mark.parametrize("columns", [[1.0, 2.0], np.empty((0, 2)), np.empty((5, 0)), [[math.nan, 1.0]]])
    def test_no_columns(self, columns):
        with pytest.raises(ValueError, match=r"shape|finite"):
            estimate_function(lambda means: means[0], columns)


class TestDrift:
    def test_stationary_series_rarely_alarm(self):
        """|z| > 3 in at most 1.5 % of 500 stationary series, scatter of z near 1."""
        all_series = autoregressive(8192, 5.0, np.random.default_rng(14), repeats=500)
        scores = np.array([drifts(series) for series in all_series])
        assert np.mean(np.abs(scores) > 3.0) < 0.015
        assert 0.85 < scores.std() < 1.2

    def test_a_drift_as_great_as_the_scatter_alarms(self):
        ramp = np.linspace(0.0, 1.0, 8192)
        rising = autoregressive(8192, 5.0, np.random.default_rng(15), repeats=50) + ramp
        assert np.mean([drifts(series) > 3.0 for series in rising]) > 0.9
        assert np.mean([drifts(-series) < -3.0 for series in rising]) > 0.9

    def test_too_short(self):
        assert drifts([1.0, 2.0, 3.0]) is None
        assert drifts(autoregressive(4096, 4096.0, np.random.default_rng(16))[0]) is None

    def test_constants(self):
        assert drifts(np.ones(100)) == 0.0
        assert drifts(np.repeat([1.0, 2.0], 50)) == math.inf
        assert drifts(np.repeat([2.0, 1.0], 50)) == -math.inf


def known(value: float, error: float, unit: str = "", blocks: int = 100) -> Estimate:
    return Estimate(value, error, samples=1000, inefficiency=2.0, converged=True, unit=unit, blocks=blocks)


class TestArithmetic:
    a, b = known(10.0, 0.3, blocks=20), known(4.0, 0.4, blocks=50)

    @pytest.mark.parametrize(
        ("result", "value", "error"),
        [
            (a + b, 14.0, 0.5),
            (a - b, 6.0, 0.5),
            (a * b, 40.0, math.hypot(4.0 * 0.3, 10.0 * 0.4)),
            (a / b, 2.5, 2.5 * math.hypot(0.03, 0.1)),
            (-a, -10.0, 0.3),
            (a + 1, 11.0, 0.3),
            (1 + a, 11.0, 0.3),
            (a - 1, 9.0, 0.3),
            (1 - a, -9.0, 0.3),
            (a * -2, -20.0, 0.6),
            (-2 * a, -20.0, 0.6),
            (a / -2, -5.0, 0.15),
            (5 / a, 0.5, 0.015),
        ],
    )
    def test_values_and_errors(self, result, value, error):
        assert result.value == pytest.approx(value)
        assert result.error == pytest.approx(error)
        assert result.converged

    def test_propagation_against_random_numbers(self):
        """Error of a ratio of two normal numbers, from 200 000 pairs (its own error 0.2 %)."""
        generator = np.random.default_rng(17)
        ratios = generator.normal(10.0, 0.3, 200_000) / generator.normal(4.0, 0.1, 200_000)
        assert (self.a / known(4.0, 0.1)).error == pytest.approx(ratios.std(), rel=0.01)

    def test_blocks_are_those_of_the_greater_error(self):
        assert (self.a + self.b).blocks == self.b.blocks
        assert (self.b + self.a).blocks == self.b.blocks
        assert (self.a * 1.0).error_of_error == pytest.approx(0.3 / math.sqrt(20))

    def test_an_unknown_error_stays_unknown(self):
        unknown = Estimate(1.0, math.nan, samples=5, inefficiency=1.0, converged=False)
        for result in (self.a / unknown, unknown / self.a, unknown + self.a, 2 * unknown, 1 / unknown):
            assert not result.converged
            assert math.isnan(result.error)
            assert math.isnan(result.error_of_error)

    def test_units(self):
        length, time = known(2.0, 0.1, "m"), known(4.0, 0.1, "s")
        assert (length / time).unit == "m/s"
        assert (length * time).unit == "m s"
        assert (length / length).unit == ""
        assert (1 / time).unit == "1/s"
        assert (3 * length + 1).unit == "m"
        with pytest.raises(ValueError, match="units differ"):
            length + time


class TestText:
    @pytest.mark.parametrize(
        ("value", "error", "text"),
        [
            (4.0712, 0.0304, "4.07 +- 0.03"),
            (2.5031, 0.0228, "2.503 +- 0.023"),
            (14.8401, 0.05, "14.84 +- 0.05"),
            (4.0, 0.12, "4.00 +- 0.12"),
            (4.0, 0.0096, "4.000 +- 0.010"),
            (4.0, 0.0995, "4.00 +- 0.10"),
            (4.0, 0.0296, "4.00 +- 0.03"),
            (1234.4, 56.0, "1230 +- 60"),
            (-0.004, 0.05, "0.00 +- 0.05"),
            (-3.21, 1.7, "-3.2 +- 1.7"),
            (1.234e-7, 5e-9, "(1.23 +- 0.05)e-07"),
            (6.02e23, 1.1e21, "(6.020 +- 0.011)e+23"),
            (12.0, 0.0, "12 +- 0"),
        ],
    )
    def test_digits(self, value, error, text):
        assert str(known(value, error)) == text

    def test_unit(self):
        assert str(known(4.07, 0.03, "Pa s")) == "4.07 +- 0.03 Pa s"

    def test_too_short(self):
        short = Estimate(4.111, math.nan, samples=5, inefficiency=1.0, converged=False)
        assert str(short) == "4.1 (too short for an error)"
        assert short.as_dict() == {"value": 4.111, "error": None}

    def test_dictionary(self):
        assert known(4.0, 0.5).as_dict() == {"value": 4.0, "error": 0.5}
        assert known(math.nan, math.nan).as_dict() == {"value": None, "error": None}
        assert known(2.0, 0.5).relative_error == 0.25
        assert known(0.0, 0.5).relative_error == math.inf
