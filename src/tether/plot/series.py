"""Stress and temperature over time."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tether.estimate import estimate
from tether.measurement import total_stress
from tether.plot.style import BLUE, GRAY, UNITS, VERMILION, marked, put_title, room_above, save, style, typeset

_POINTS = 250  # of a drawn series: each is the mean of so many samples that this many are left
_CYCLES = 4  # of a flow that comes again, the last ones, that are drawn


def plot_series(
    series: xr.Dataset,
    path_stem: Path,
    title: str,
    temperature: float | None = None,
    *,
    flow_energy: Mapping[str, float] | None = None,
    cycle: float | None = None,
) -> list[Path]:
    """Stress and temperature over time: means over short intervals, the running mean and its error band.

    series: a run's series (stress terms with dims time, row, column; temperature; attribute shear_rate). Under steady
    shear the stress is S_xy, whose right-hand scale is the viscosity S_xy / rate; where the rate changes (the series
    has a variable shear_rate) it is S_xy beneath the imposed rate, over the last cycles if `cycle`, the time of one, is
    given; else it is the pressure. temperature: the set kT, drawn as a line. flow_energy: what the mean flow of a
    driven flow adds to "temperature" and "pressure", which is taken off. Writes path_stem with .png and .svg added and
    returns both paths.
    """
    moving = flow_energy or {}
    time = np.asarray(series["time"].values, dtype=np.float64)
    kinetic = np.asarray(series["temperature"].values, dtype=np.float64) - moving.get("temperature", 0.0)
    with style():
        figure = Figure(figsize=(6.8, 5.2), layout="constrained")
        put_title(figure, title)
        if "shear_rate" in series:
            figure.set_figheight(6.4)
            rate, upper, lower = figure.subplots(3, 1, height_ratios=[0.6, 1.2, 1.0])
            _draw_unsteady(rate, upper, series, cycle)
        else:
            upper, lower = figure.subplots(2, 1, sharex=True)
            _draw_steady(upper, series, moving.get("pressure", 0.0))
        _draw_series(lower, time, kinetic, VERMILION, None)
        if temperature is not None:
            marked(lower, temperature, "set")
        lower.set_ylabel(f"temperature $kT$\n({UNITS})")
        lower.set_xlabel(f"time ({UNITS})")
        lower.set_xlim(*_padded_range(time))
        figure.align_ylabels()
        return save(figure, path_stem)


def _draw_steady(axes: Axes, series: xr.Dataset, moving: float) -> None:
    time = np.asarray(series["time"].values, dtype=np.float64)
    rate = float(series.attrs["shear_rate"])
    stress = total_stress(series)
    if rate == 0.0:
        pressure = -np.trace(stress.values, axis1=1, axis2=2) / stress.sizes["row"] - moving
        _draw_series(axes, time, pressure, BLUE, None)
        axes.set_ylabel(f"pressure\n({UNITS})")
        return
    shear = stress.sel(row="x", column="y").values
    _draw_series(axes, time, shear, BLUE, f"viscosity {estimate(shear) / rate}")
    axes.set_ylabel(f"shear stress $S_{{xy}}$\n({UNITS})")
    scale = axes.secondary_yaxis("right", functions=(lambda s: np.divide(s, rate), lambda v: np.multiply(v, rate)))
    scale.set_ylabel(r"viscosity $S_{xy}/\dot\gamma$")
    scale.spines["right"].set_visible(True)


def _draw_unsteady(upper: Axes, lower: Axes, series: xr.Dataset, cycle: float | None) -> None:
    """Imposed rate, and shear stress beneath it; no running mean, for nothing runs towards one."""
    time = np.asarray(series["time"].values, dtype=np.float64)
    begin = -math.inf if cycle is None else time[-1] - _CYCLES * cycle
    shown = np.flatnonzero(time > begin)
    rate = np.asarray(series["shear_rate"].values, dtype=np.float64)[shown]
    stress = total_stress(series).sel(row="x", column="y").values[shown]
    interval = (time[-1] - time[0]) / (len(time) - 1)
    size = max(1, len(shown) // _POINTS)
    middles, blocks = _blocks(time[shown] - 0.5 * interval, size), _blocks(stress, size)
    upper.step(time[shown] - 0.5 * interval, rate, where="mid", color=GRAY, linewidth=1.2)
    upper.set_ylabel("imposed\nrate $\\dot\\gamma$")
    upper.set_xticklabels([])
    label = f"means over {interval * size:.2g}" if size > 1 else "samples"
    lower.plot(middles, blocks, color=BLUE, linewidth=0.9, label=label)
    lower.axhline(0.0, color=GRAY, linewidth=0.7, zorder=1)
    lower.set_ylabel(f"shear stress $S_{{xy}}$\n({UNITS})")
    room_above(lower, float(blocks.min()), float(blocks.max()), 0.2)
    lower.legend(loc="upper right")
    if cycle is not None and time[0] < begin:
        lower.set_xlabel(f"the last {_CYCLES} cycles ({UNITS})")
    for axes in (upper, lower):
        axes.set_xlim(*_padded_range(time[shown]))


def _draw_series(
    axes: Axes, time: NDArray[np.float64], values: NDArray[np.float64], color: str, text: str | None
) -> None:
    """Block means as a thin line, the running mean as a thick one, its one-sigma band if one is known."""
    final = estimate(values)
    size = max(1, len(values) // _POINTS)
    middles, blocks = _blocks(time, size), _blocks(values, size)
    if size > 1:
        interval = (time[-1] - time[0]) / (len(time) - 1) * size
        label = f"means over {interval:.2g}"
    else:
        label = "samples"
    axes.plot(middles, blocks, color=color, alpha=0.45, linewidth=0.7, label=label, zorder=2)

    # Over fewer than 4 independent samples a running mean is noise and its error unknown: it begins there.
    first = min(max(size, math.ceil(4.0 * final.inefficiency) if final.converged else size), len(values))
    ends = np.unique(np.geomspace(first, len(values), 2 * _POINTS).round().astype(np.intp))
    running = np.cumsum(values)[ends - 1] / ends
    if final.converged:
        error = final.error * np.sqrt(len(values) / ends)
        low, high = running - error, running + error
        axes.fill_between(time[ends - 1], low, high, color=color, alpha=0.25, linewidth=0.0, zorder=2.5)
    axes.plot(time[ends - 1], running, color=color, label=f"running mean: {typeset(text or final)}", zorder=3)
    room_above(axes, float(blocks.min()), float(blocks.max()))
    axes.legend(loc="upper right", ncols=2)


def _blocks(values: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Means of so many neighbors each."""
    whole = len(values) - len(values) % size
    return np.asarray(values[:whole].reshape(-1, size).mean(axis=1))


def _padded_range(values: NDArray[np.float64]) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    return (low, high) if high > low else (low - 0.5, high + 0.5)
