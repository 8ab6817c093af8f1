"""Block means of many quantities: the arithmetic exactly, the errors against the exact ones of AR(1) series.

Every random test has a fixed seed; false-alarm rates are the chance that a seed chosen blindly would have failed.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter

from tether.observe.blocks import MOST_BLOCKS, Blocks, Means, fitted_slope


def autoregressive(samples: int, memory: float, width: int, seed: int) -> np.ndarray:
    """AR(1) series of unit variance and mean 0 with rho(t) = exp(-t / memory); shape (samples, width)."""
    generator = np.random.default_rng(seed)
    correlation = math.exp(-1.0 / memory)
    noise = generator.standard_normal((samples, width)) * math.sqrt(1.0 - correlation**2)
    noise[0] = generator.standard_normal(width)
    return lfilter([1.0], [1.0, -correlation], noise, axis=0)


def blocks_of(series: np.ndarray) -> Blocks:
    made = Blocks(series.shape[1])
    for row in series:
        made.add(row)
    return made


@pytest.mark.parametrize("samples", [1, MOST_BLOCKS - 1, MOST_BLOCKS, MOST_BLOCKS + 1, 5 * MOST_BLOCKS + 3])
def test_means_are_those_of_the_whole_series(samples):
    series = np.random.default_rng(1).normal(5.0, 1.0, (samples, 3))
    made = blocks_of(series)
    assert made.samples == samples
    assert made.mean() == pytest.approx(series.mean(axis=0), rel=1e-13)
    whole = samples // made.length
    direct = series[: whole * made.length].reshape(whole, made.length, 3).mean(axis=1)
    assert made.means == pytest.approx(direct, rel=1e-13)
    assert samples < MOST_BLOCKS or MOST_BLOCKS // 2 <= whole < MOST_BLOCKS


def test_nothing_yet():
    made = Blocks(2)
    assert np.isnan(made.mean()).all()
    assert np.isnan(made.error()).all()
    assert np.isnan(made.covariance()[0]).all()


def test_errors_of_correlated_series():
    """300 series of 20000 samples, worth 2000 independent ones each. Means over their errors have unit variance: within
    4.5 standard errors of a sample variance, false-alarm rate 1e-5, with 10 % for errors that are 6 % high and scatter.
    Naive errors must fail.
    """
    memory, samples, width = 5.0, 20_000, 300
    series = autoregressive(samples, memory, width, seed=2)
    error = blocks_of(series).error()
    assert np.isfinite(error).mean() > 0.98
    band = 0.10 + 4.5 * math.sqrt(2.0 / width)
    mean = series.mean(axis=0)
    kept = np.isfinite(error)
    assert np.mean((mean[kept] / error[kept]) ** 2) == pytest.approx(1.0, abs=band)
    naive = series.std(axis=0) / math.sqrt(samples)
    assert np.mean((mean / naive) ** 2) > 1.0 + 3.0 * band
    exact = math.sqrt(1.0 / math.tanh(0.5 / memory) / samples)
    assert np.nanmean(error) == pytest.approx(1.06 * exact, rel=0.05)


def test_short_series_have_no_error():
    assert np.isnan(blocks_of(autoregressive(40, 1.0, 4, seed=3)).error()).all()
    assert np.isnan(blocks_of(autoregressive(3000, 1000.0, 4, seed=3)).error()).all()


def test_ratio_of_sums_in_bins_that_are_empty_at_times():
    """Mean velocity 2 of a bin with 0, 1 or 2 particles, momentum = 2 * count + noise: the ratio is 2 with the noise's
    error alone; the mean of ratios would not exist.
    """
    generator = np.random.default_rng(4)
    samples, spread = 4096, 0.3
    count = generator.integers(0, 3, samples)
    momentum = 2.0 * count + spread * np.sqrt(count) * generator.standard_normal(samples)
    made = blocks_of(np.column_stack([momentum, np.zeros(samples), count, np.zeros(samples)]))
    value, error = made.ratio(slice(0, 2), slice(2, 4))
    assert value[0] == pytest.approx(momentum.sum() / count.sum(), rel=1e-12)
    assert error[0] == pytest.approx(spread / math.sqrt(samples), rel=0.3)
    assert abs(value[0] - 2.0) < 4.5 * error[0]
    assert np.isnan(value[1])
    assert np.isnan(error[1])


def test_formulas_carry_their_slopes():
    """Each operation's deviation against a finite difference of the same formula."""
    generator = np.random.default_rng(5)
    value = generator.uniform(1.0, 2.0, (3, 4))
    deviation = 1e-6 * generator.standard_normal((7, 3, 4))

    def formula(a, b, c, log, total, weighted):
        return weighted(log(a * b / c + a - 3.0 * b + 5.0 * c)) + total(a * c)[0]

    made = Means(value, deviation)
    weights = fitted_slope([0.0, 1.0, 3.0, 4.0])
    assert weights @ np.array([1.0, 3.0, 7.0, 9.0]) == pytest.approx(2.0)

    def split(whole):
        return whole[0], whole[1], whole[2]

    found = formula(*split(made), Means.log, lambda m: m.reshaped(1, 4).sum(axis=-1), lambda m: m.weighted(weights))
    for block in range(7):
        moved = formula(*split(value + deviation[block]), np.log, lambda x: x[None].sum(-1), lambda x: weights @ x)
        assert found.deviation[block] == pytest.approx(moved - found.value, abs=1e-10)


def test_covariance_over_bins_that_share_a_constraint():
    """200 sets of 6 bins, correlated in time and, since 7 bins sum to zero, with each other. Hotelling's T^2 with the
    covariance passes a Kolmogorov-Smirnov test of its F distribution at 1e-4; a chi-square that takes bins for
    independent must fail.
    """
    sets, bins, samples = 200, 7, 6000
    series = autoregressive(samples, 3.0, sets * bins, seed=6).reshape(samples, sets, bins)
    series = (series - series.mean(axis=2, keepdims=True))[:, :, :-1]
    chances, wrong = [], []
    for one in range(sets):
        made = blocks_of(series[:, one])
        covariance, blocks = made.covariance()
        width, mean = bins - 1, made.mean()
        square = mean @ np.linalg.solve(covariance, mean)
        chances.append(stats.f.sf(square * (blocks - width) / (width * (blocks - 1)), width, blocks - width))
        plain = made.length * len(made.means)
        wrong.append(stats.chi2.sf(np.sum(mean**2 / (series[:, one].var(axis=0) / plain)), width))
    assert stats.kstest(chances, "uniform").pvalue > 1e-4
    assert stats.kstest(wrong, "uniform").pvalue < 1e-4


@pytest.mark.parametrize("middle", [1, 100, MOST_BLOCKS, 3 * MOST_BLOCKS + 1])
def test_goes_on_bit_for_bit(middle):
    series = np.random.default_rng(7).normal(1.0, 1.0, (4 * MOST_BLOCKS + 5, 3))
    straight = blocks_of(series)
    first = blocks_of(series[:middle])
    second = Blocks(3)
    second.restore(first.state())
    for row in series[middle:]:
        first.add(row)  # what was saved must not be a view of what goes on
        second.add(row)
    for name, value in straight.state().items():
        assert second.state()[name].tobytes() == value.tobytes()
    assert second.error().tobytes() == straight.error().tobytes()


def test_a_state_of_something_else_is_refused():
    with pytest.raises(ValueError, match="rows here have 2 numbers"):
        Blocks(2).restore(Blocks(3).state())
