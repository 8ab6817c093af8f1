"""Stress after changes of the shear rate, averaged over the times that the stages were gone through."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tether.analysis.start_up import steady_stress
from tether.plot.style import GRAY, UNITS, band, colored, level, put_title, save, style, typeset


def plot_start_up(curve: xr.Dataset, path_stem: Path, title: str) -> list[Path]:
    """Imposed rate and stress against time, and stress against the strain of each stage that shears.

    curve: from `tether.analysis.start_up.start_up`. The second half of a sheared stage is taken for its steady stress,
    a dashed line. Writes path_stem with .png and .svg added and returns both paths.
    """
    stages = sorted({int(stage) for stage in curve["stage"].values})
    colors = colored([str(stage) for stage in stages])
    sheared = [stage for stage in stages if bool((_of_stage(curve, stage)["shear_rate"] != 0).any())]
    with style():
        figure = Figure(figsize=(6.8, 7.0), layout="constrained")
        upper, middle, lower = figure.subplots(3, 1, height_ratios=[0.5, 1.2, 1.2])
        middle.sharex(upper)
        put_title(figure, title)
        time = curve["time"].values
        upper.step(time, curve["shear_rate"].values, where="mid", color=GRAY, linewidth=1.2)
        upper.set_ylabel("imposed\nrate $\\dot\\gamma$")
        upper.tick_params(labelbottom=False)
        for stage in stages:
            part = _of_stage(curve, stage)
            band(middle, part["time"].values, part["stress"].values, part["stress_error"].values, colors[str(stage)])
        middle.set_xlim(0.0, float(time[-1] + time[0]))
        middle.set_xlabel(f"time since the start of the cycle ({UNITS}), {_repeats(curve)}")
        _draw_against_strain(lower, curve, sheared, colors)
        for axes in (middle, lower):
            axes.axhline(0.0, color=GRAY, linewidth=0.7, zorder=1)
            axes.set_ylabel(f"shear stress $S_{{xy}}$\n({UNITS})")
        figure.align_ylabels()
        return save(figure, path_stem)


def _draw_against_strain(axes: Axes, curve: xr.Dataset, sheared: list[int], colors: dict[str, str]) -> None:
    for stage in sheared:
        part = _of_stage(curve, stage)
        rate = float(part["shear_rate"].values[0])
        strain = rate * (part["time"].values - part["time"].values[0] + 0.5 * float(curve.attrs["interval_time"]))
        steady = steady_stress(curve, stage)
        color = colors[str(stage)]
        label = rf"stage {stage + 1}, $\dot\gamma$ = {rate:g}"
        band(axes, np.abs(strain), part["stress"].values, part["stress_error"].values, color, label)
        level(axes, steady, color, f"its second half: {typeset(steady)}")
    axes.set_xlabel("strain since the start of the stage")
    axes.set_xlim(left=0.0)
    if sheared:
        axes.legend(loc="best", ncols=2)


def _of_stage(curve: xr.Dataset, stage: int) -> xr.Dataset:
    return curve.isel(time=np.flatnonzero(curve["stage"].values == stage))


def _repeats(curve: xr.Dataset) -> str:
    repeats = int(curve.attrs["repeats"])
    return f"mean of {repeats} cycles" if repeats > 1 else "one cycle, no error known"
