"""The multiple-tau correlator against sums written out, and against the exact correlation of known series."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from tether.observe.correlator import Correlator, MultipleTau


def correlated(series: np.ndarray, **how) -> Correlator:
    made = Correlator(series.shape[1], **how)
    for sample in series:
        made.add(sample)
    return made


def level_series(series: np.ndarray, level: int, factor: int, average: bool) -> np.ndarray:
    """What level `level` takes of a series."""
    spacing = factor**level
    if average:
        whole = len(series) // spacing
        return series[: whole * spacing].reshape(whole, spacing, -1).mean(axis=1)
    return series[spacing if level else 0 :: spacing]


@pytest.mark.parametrize("average", [False, True])
@pytest.mark.parametrize(("points", "factor"), [(16, 2), (8, 4), (9, 3)])
def test_every_lag_is_the_sum_written_out(points, factor, average):
    series = np.random.default_rng(1).normal(0.3, 1.0, (500, 2)).cumsum(axis=0)
    made = correlated(series, points=points, factor=factor, average=average)
    found = dict(zip(made.lags().tolist(), made.correlation()[0][:, 0], strict=True))
    assert list(found) == sorted(found)
    assert max(found) > 500 // (2 * factor)
    for level in range(8):
        taken = level_series(series, level, factor, average)
        if len(taken) < points:
            break
        for lag in range(0 if level == 0 else points // factor, points):
            now = taken[points - 1 :]
            direct = np.mean(now * taken[points - 1 - lag : len(taken) - lag], axis=0)
            assert found.pop(lag * factor**level) == pytest.approx(direct, rel=1e-12)
    assert not found


def test_small_lags_are_the_direct_autocorrelation():
    """Level 0 has all samples: its lags differ from numpy's by the first 15 origins alone."""
    series = np.random.default_rng(2).standard_normal(1000)
    made = correlated(series[:, None])
    full = np.array([np.mean(series[15:] * series[15 - lag : 1000 - lag]) for lag in range(16)])
    assert made.correlation()[0][:16, 0, 0] == pytest.approx(full, abs=1e-14)


@pytest.mark.parametrize("average", [False, True])
def test_known_correlation(average):
    """AR(1) of memory 12, 60000 samples: every lag under 60 is within 4.5 of its errors of exp(-lag/12) (35 lags at
    most: false-alarm rate under 1e-3); a memory of 10 must fail.
    """
    memory, samples = 12.0, 60_000
    correlation = math.exp(-1.0 / memory)
    noise = np.random.default_rng(3).standard_normal(samples) * math.sqrt(1.0 - correlation**2)
    made = correlated(lfilter([1.0], [1.0, -correlation], noise)[1000:, None], average=average)
    lags = made.lags()
    value, error = (each[:, 0, 0] for each in made.correlation())
    known = np.isfinite(error) & (lags < 60)
    assert known.sum() > 25

    def distance(memory):
        return np.abs(value - np.exp(-lags / memory))[known] / error[known]

    assert distance(memory).max() < 4.5
    assert distance(10.0).max() > 4.5


def test_smoothing_by_averages_is_the_stated_one():
    """Of cos(theta t) the triangle leaves (sin(w theta/2) / (w sin(theta/2)))^2 = 1 - (w^2 - 1) theta^2 / 12 + ..."""
    theta = 0.02
    series = np.cos(theta * np.arange(40_000))[:, None]
    made = correlated(series)
    for level, (lags, means) in enumerate(made.levels()[:5]):
        width = 2.0**level
        factor = (math.sin(0.5 * width * theta) / (width * math.sin(0.5 * theta))) ** 2
        assert factor == pytest.approx(1.0 - (width**2 - 1.0) * theta**2 / 12.0, abs=1e-4)
        assert means.value[:, 0, 0] == pytest.approx(0.5 * factor * np.cos(theta * lags), abs=2e-3)
    plain = correlated(series, average=False)
    for lags, means in plain.levels()[:5]:
        assert means.value[:, 0, 0] == pytest.approx(0.5 * np.cos(theta * lags), abs=2e-3)


def test_groups_and_a_known_mean():
    samples = np.random.default_rng(4).normal(7.0, 1.0, (100, 3, 5))
    made = Correlator(3, groups=(2, 3), about=7.0, average=False)
    for sample in samples:
        made.add(sample)
    value = made.correlation()[0]
    assert value.shape == (len(made.lags()), 2, 3)
    away = samples - 7.0
    for group, members in enumerate((slice(0, 2), slice(2, 5))):
        direct = np.mean(away[15:, :, members] * away[12:-3, :, members], axis=(0, 2))
        assert value[3, group] == pytest.approx(direct, rel=1e-12)


def test_no_more_levels_than_asked_for():
    made = correlated(np.zeros((1000, 1)), levels=2)
    assert made.lags().tolist() == [*range(16), *range(16, 32, 2)]


@pytest.mark.parametrize("average", [False, True])
@pytest.mark.parametrize("middle", [0, 1, 37, 64, 201])
def test_goes_on_bit_for_bit(middle, average):
    series = np.random.default_rng(5).standard_normal((700, 2, 7))
    straight, first, second = (Correlator(2, (3, 4), average=average) for _ in range(3))
    for sample in series:
        straight.add(sample)
    for sample in series[:middle]:
        first.add(sample)
    second.restore(first.state())
    for sample in series[middle:]:
        first.add(sample)
        second.add(sample)
    for name, value in straight.state().items():
        assert second.state()[name].tobytes() == value.tobytes()


@pytest.mark.parametrize(("points", "factor"), [(15, 2), (2, 2), (16, 1)])
def test_levels_that_do_not_join_are_refused(points, factor):
    with pytest.raises(ValueError, match="make no levels"):
        MultipleTau((1,), lambda then, now: then * now, (1,), points=points, factor=factor)
