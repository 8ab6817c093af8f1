"""Stress after a change of the shear rate, averaged over repeats of the same stages.

A flow goes through stages, each with a shear rate and a duration, again and again: start-up {rate, t_1} and stop
{0, t_2}, say. One passage is a cycle. Samples at the same time within the cycle are averaged over the repeats; their
scatter between repeats, which are independent if the last stage lasts until all is forgotten, gives the standard
error. The first repeat starts from another past than the others (a run's equilibration, not the last stage); leave it
out where the last stage is not rest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import ndtri

from tether.estimate import Estimate, estimate

FALSE_ALARM = 0.01
"""Chance that noise alone puts off the time at which a stress is found to be steady."""


@dataclass(frozen=True)
class Overshoot:
    """The greatest stress of a stage, in the direction of its steady stress."""

    stress: Estimate
    """Read from one half of the repeats where the other half has its greatest: noise does not lift it."""
    time: float
    """Since the start of the stage."""
    strain: float
    """Since the start of the cycle."""


def start_up(
    time: NDArray[np.float64],
    stress: NDArray[np.float64],
    stages: Sequence[tuple[float, float]],
    interval_time: float,
    first_time: float = 0.0,
    *,
    skipped_repeats: int = 0,
) -> xr.Dataset:
    """Mean stress and its standard error as functions of the time since the start of a cycle; dims time.

    time: ends of the samples' intervals, (n,). stress: S_xy without its random term, means over the intervals, (n,).
    stages: (shear rate, duration) in their order; together they must last a whole number of intervals. first_time: when
    the first cycle began. An unfinished last repeat is left out.

    Coordinates: time, the middle of the interval since the start of the cycle; strain, the mean over the interval of
    the strain since then; stage, from 0; shear_rate. Variables: stress and stress_error, nan with one repeat;
    stress_of_repeat, dims (repeat, time).
    """
    rates, durations = np.array(stages, dtype=np.float64).reshape(-1, 2).T
    length = float(durations.sum())
    samples = round(length / interval_time)
    if samples < 1 or abs(samples * interval_time - length) > 1e-6 * interval_time * max(samples, 1):
        raise ValueError(
            f"the stages last {length:.6g}, no whole number of intervals of {interval_time:.6g} (samples would fall"
            " at other times in each repeat); change a duration or the interval"
        )
    begin = first_time + skipped_repeats * length
    kept = stress[time - interval_time >= begin - 1e-6 * interval_time]
    repeats = len(kept) // samples
    if repeats == 0:
        raise ValueError(f"the run has no whole cycle of stages (one lasts {length:.6g}); measure for longer")
    table = kept[: repeats * samples].reshape(repeats, samples)
    middle = interval_time * (np.arange(samples) + 0.5)
    ends = np.cumsum(durations)
    stage = np.searchsorted(ends, middle, side="right").clip(0, len(ends) - 1)
    error = table.std(axis=0, ddof=1) / math.sqrt(repeats) if repeats > 1 else np.full(samples, math.nan)
    return xr.Dataset(
        {
            "stress": ("time", table.mean(axis=0)),
            "stress_error": ("time", error),
            "stress_of_repeat": (("repeat", "time"), table),
        },
        coords={
            "time": ("time", middle, {"units": "time", "long_name": "since the start of the cycle"}),
            "strain": ("time", mean_strain(stages, interval_time, samples)),
            "stage": ("time", stage),
            "shear_rate": ("time", rates[stage]),
        },
        attrs={"title": "stress after a change of the shear rate", "repeats": repeats, "interval_time": interval_time},
    )


def mean_strain(stages: Sequence[tuple[float, float]], interval_time: float, samples: int) -> NDArray[np.float64]:
    """Means over the intervals of the strain since the start of the cycle, (samples,).

    The strain is linear within a stage, so its integral is known at every time.
    """
    rates, durations = np.array(stages, dtype=np.float64).reshape(-1, 2).T
    starts = np.concatenate([[0.0], np.cumsum(durations)])
    strains = np.concatenate([[0.0], np.cumsum(rates * durations)])
    integrals = np.concatenate([[0.0], np.cumsum(0.5 * (strains[1:] + strains[:-1]) * durations)])
    times = interval_time * np.arange(samples + 1)
    stage = np.searchsorted(starts, times, side="right").clip(1, len(durations)) - 1
    since = times - starts[stage]
    integral = integrals[stage] + strains[stage] * since + 0.5 * rates[stage] * since**2
    mean: NDArray[np.float64] = np.diff(integral) / interval_time
    return mean


def steady_stress(curve: xr.Dataset, stage: int, *, last: float = 0.5, unit: str = "") -> Estimate:
    """Mean stress of the last part of a stage.

    curve: from `start_up`. last: the part of the stage that counts. The error is the scatter between repeats; of one
    repeat, that of its samples by blocking.
    """
    table = _of_stage(curve, stage).stress_of_repeat.values
    tail = table[:, table.shape[1] - max(1, round(last * table.shape[1])) :]
    return estimate(tail[0], unit) if len(tail) == 1 else _over_repeats(tail.mean(axis=1), unit)


def settling_time(curve: xr.Dataset, stage: int, *, within: float = 0.05, last: float = 0.5) -> float:
    """Time since the start of a stage from which on its stress stays at its steady value; nan if it never does.

    It does where no later sample differs from the steady stress by more than `within` of it plus the noise, so many
    standard errors that noise alone has a chance of 1 % to exceed them anywhere in the stage.
    """
    part = _of_stage(curve, stage)
    steady = steady_stress(curve, stage, last=last)
    error = part.stress_error.values
    if not np.isfinite(error).all():
        return math.nan  # of one repeat nothing is known of the noise
    noise = -ndtri(0.5 * FALSE_ALARM / len(error)) * np.hypot(error, steady.error)
    away = np.abs(part.stress.values - steady.value) > within * abs(steady.value) + noise
    if away[-1]:
        return math.nan
    interval = float(curve.attrs["interval_time"])
    return interval * float(np.flatnonzero(away)[-1] + 1) if away.any() else 0.0


def overshoot(curve: xr.Dataset, stage: int, *, last: float = 0.5, unit: str = "") -> Overshoot:
    """The greatest stress of a stage (the least, where its steady stress is negative).

    The maximum of a noisy curve is too high. So the repeats are dealt into two halves; where one half has its maximum
    the other one is read, and the two readings are averaged. Of one repeat the maximum is read as it is and has no
    error.
    """
    part = _of_stage(curve, stage)
    table = part.stress_of_repeat.values
    sign = -1.0 if steady_stress(curve, stage, last=last).value < 0.0 else 1.0
    top = int(np.argmax(sign * part.stress.values))
    half = 0.5 * float(curve.attrs["interval_time"])
    when, strain = float(part.time[top] - part.time[0]) + half, float(part.strain[top])
    if len(table) < 2:
        return Overshoot(Estimate(float(table[0, top]), math.nan, 1, 1.0, converged=False, unit=unit), when, strain)
    halves = (table[0::2], table[1::2])
    tops = [int(np.argmax(sign * rows.mean(axis=0))) for rows in halves]
    readings = [rows[:, at] for rows, at in zip(halves, reversed(tops), strict=True)]
    value = 0.5 * sum(float(reading.mean()) for reading in readings)
    deviations = np.concatenate([reading - reading.mean() for reading in readings])
    freedom = max(1, len(deviations) - 2)
    # The halves are independent, and with as many repeats in each the error is that of the mean of all.
    error = math.sqrt(float(deviations @ deviations) / freedom) * 0.5 * math.sqrt(sum(1.0 / len(r) for r in readings))
    enough = len(table) >= 4
    made = Estimate(
        value, error if enough else math.nan, len(table), 1.0, converged=enough, unit=unit, blocks=len(table)
    )
    return Overshoot(made, when, strain)


def _of_stage(curve: xr.Dataset, stage: int) -> xr.Dataset:
    chosen = np.flatnonzero(curve.stage.values == stage)
    if len(chosen) == 0:
        raise ValueError(f"there is no sample of stage {stage} (they count from 0); take samples at shorter intervals")
    return curve.isel(time=chosen)


def _over_repeats(values: NDArray[np.float64], unit: str) -> Estimate:
    """Mean of independent values, two at least."""
    error = float(values.std(ddof=1)) / math.sqrt(len(values))
    return Estimate(float(values.mean()), error, len(values), 1.0, converged=True, unit=unit, blocks=len(values))
