"""Stress and temperature over time."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tether.estimate import Estimate, estimate
from tether.measurement import total_stress
from tether.plot.style import BLUE, GRAY, UNITS, VERMILION
from tether.report.charts.comparison import Comparison
from tether.report.charts.panel import Panel, Scale, told
from tether.report.page import Chart

_POINTS = 800  # of a drawn series: each is the mean of so many samples that this many are left
_CYCLES = 4  # of a flow that comes again, the last ones, that are drawn

_TIME = Scale(f"time ({UNITS})")
_RATE = "\N{GREEK SMALL LETTER GAMMA}\N{COMBINING DOT ABOVE}"
_STRESS = f"shear stress S<sub>xy</sub> ({UNITS})"


def series_charts(comparison: Comparison) -> list[Chart]:
    """Viscosity (steady shear), stress (shear that changes) or else pressure over time, and temperature."""
    series, moving = comparison.over_time, comparison.flow_energy()
    time = np.asarray(series["time"].values, dtype=np.float64)
    stress = total_stress(series)
    rate = float(series.attrs["shear_rate"])
    if "shear_rate" in series:
        charts = _unsteady(comparison)
    elif rate != 0.0:
        words = f"viscosity S<sub>xy</sub>/{_RATE} ({UNITS})"
        charts = [_mean_over_time("Viscosity", words, time, stress.sel(row="x", column="y").values / rate, BLUE)]
    else:
        pressure = -np.trace(stress.values, axis1=1, axis2=2) / stress.sizes["row"] - moving.get("pressure", 0.0)
        charts = [_mean_over_time("Pressure", f"pressure p ({UNITS})", time, pressure, BLUE)]
    kinetic = np.asarray(series["temperature"].values, dtype=np.float64) - moving.get("temperature", 0.0)
    set_ = comparison.configuration.fluid.temperature
    title = "Temperature"
    if comparison.configuration.flow.is_driven and not moving:
        title += ", energy of the flow included"
    return [*charts, _mean_over_time(title, f"temperature kT ({UNITS})", time, kinetic, VERMILION, set_)]


def _mean_over_time(
    title: str, words: str, time: NDArray[np.float64], values: NDArray[np.float64], color: str,
    wanted: float | None = None,
) -> Chart:  # fmt: skip
    """Means over short intervals, the running mean and its error."""
    final = estimate(values)
    size = max(1, len(values) // _POINTS)
    middles, means = blocks(time, size), blocks(values, size)
    panel = Panel(title, _TIME, Scale(words))
    interval = (time[-1] - time[0]) / (len(time) - 1) * size
    label = f"means over {interval:.2g}" if size > 1 else "samples"
    panel.line(middles, means, color, label, width=0.7, opacity=0.45)
    place, running, error = _running_mean(time, values, final, size)
    panel.band(place, running, error, color, f"running mean: {told(final)}")
    if wanted is not None:
        panel.across(wanted, GRAY, f"set: {wanted:g}")
    return panel.chart()


def _running_mean(
    time: NDArray[np.float64], values: NDArray[np.float64], final: Estimate, size: int
) -> tuple[NDArray[np.float64], ...]:
    """Times, means so far and their errors, from 4 independent samples on: before that these are noise."""
    first = min(max(size, math.ceil(4.0 * final.inefficiency) if final.converged else size), len(values))
    ends = np.unique(np.geomspace(first, len(values), _POINTS // 2).round().astype(np.intp))
    running = np.cumsum(values)[ends - 1] / ends
    error = final.error * np.sqrt(len(values) / ends) if final.converged else np.full(len(ends), math.nan)
    return time[ends - 1], running, error


def _unsteady(comparison: Comparison) -> list[Chart]:
    """Shear stress and the imposed rate over the last cycles; nothing runs towards a mean."""
    series, cycle = comparison.over_time, comparison.cycle()
    time = np.asarray(series["time"].values, dtype=np.float64)
    interval = (time[-1] - time[0]) / (len(time) - 1)
    begin = -math.inf if cycle is None else time[-1] - _CYCLES * cycle
    seen = np.flatnonzero(time > begin)
    size = max(1, len(seen) // _POINTS)
    middles = time[seen] - 0.5 * interval
    stress = total_stress(series).sel(row="x", column="y").values[seen]
    last = f", the last {_CYCLES} cycles" if time[0] < begin else ""
    upper = Panel(f"Shear stress{last}", _TIME, Scale(_STRESS))
    label = f"means over {interval * size:.2g}" if size > 1 else "samples"
    upper.line(blocks(middles, size), blocks(stress, size), BLUE, label, width=1.0)
    upper.across(0.0, dash="solid", width=0.7)
    lower = Panel(f"Imposed shear rate{last}", _TIME, Scale(f"shear rate {_RATE} ({UNITS})"))
    rate = np.asarray(series["shear_rate"].values, dtype=np.float64)[seen]
    lower.line(blocks(middles, size), blocks(rate, size), GRAY, stepped=True)
    return [upper.chart(), lower.chart()]


def blocks(values: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Means of so many neighbors each."""
    whole = len(values) - len(values) % size
    return np.asarray(values[:whole].reshape(-1, size).mean(axis=1))
