"""Displacement over lag with the diffusion coefficient, velocity autocorrelation, and rotation of bodies."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from tether.estimate import Estimate
from tether.plot.style import UNITS, colored, words
from tether.report.charts.comparison import Comparison
from tether.report.charts.panel import Panel, Scale, told
from tether.report.page import Chart

_LAG = Scale(f"lag t ({UNITS})", "log")


def displacement_charts(displacement: xr.Dataset, comparison: Comparison) -> list[Chart]:
    """Of the dataset of `tether.observe.displacement`."""
    del comparison
    names = [
        str(name).removeprefix("vacf_")
        for name in displacement
        if str(name).startswith("vacf_") and not str(name).startswith("vacf_axes_") and not str(name).endswith("_error")
    ]
    colors = colored(names)
    charts = [_squares(displacement, colors), _running(displacement, colors), _velocity(displacement, colors)]
    turning = {
        name: color
        for name, color in colors.items()
        if f"msd_angle_{name}" in displacement or f"orientation_{name}" in displacement
    }
    return [*charts, _rotation(displacement, turning)] if turning else charts


def _squares(displacement: xr.Dataset, colors: dict[str, str]) -> Chart:
    lag = displacement["lag"].values
    panel = Panel("Mean-square displacement", _LAG, Scale(f"mean-square displacement ({UNITS})", "log"))
    caption = ""
    for name, color in colors.items():
        mean, error = displacement[f"msd_{name}"].values, displacement[f"msd_{name}_error"].values
        seen = (lag > 0) & (mean > 0)
        below = np.minimum(error, 0.9 * mean)
        panel.points(lag[seen], mean[seen], error[seen], color, words(name), error_below=below[seen])
        diffusion = _coefficient(displacement, f"diffusion_{name}")
        if diffusion is not None:
            axes = int(np.isfinite(displacement[f"diffusion_axes_{name}"].values).sum())  # x is left out in driven flow
            panel.line(lag[seen], 2.0 * axes * diffusion.value * lag[seen], color, dash="dash", width=1.0)
            caption = "Dashed: slope 1, 2dDt with the fitted D."
    return panel.chart(caption)


def _running(displacement: xr.Dataset, colors: dict[str, str]) -> Chart:
    """Half the slope of the mean square at each lag, and the fitted D."""
    lag = displacement["lag"].values
    highest = 0.0
    means = {name: displacement[f"diffusion_running_{name}"].values for name in colors}
    errors = {name: displacement[f"diffusion_running_{name}_error"].values for name in colors}
    found = {name: _coefficient(displacement, f"diffusion_{name}") for name in colors}
    for name in colors:
        sure = means[name][np.isfinite(errors[name])]
        diffusion = found[name]
        highest = max([highest, *sure[:-4], diffusion.value if diffusion is not None else 0.0])
    ends = (0.0, 1.4 * highest) if highest > 0.0 else None  # the longest lags are noise
    panel = Panel("Running diffusion coefficient", _LAG, Scale(f"D(t) ({UNITS})", ends=ends))
    for name, color in colors.items():
        seen, diffusion = lag > 0, found[name]
        label = f"D = {told(diffusion)}" if diffusion is not None else "no D could be fitted"
        panel.points(lag[seen], means[name][seen], errors[name][seen], color, f"{words(name)}: {label}")
        if diffusion is not None:
            panel.level(diffusion, color)
    return panel.chart()


def _velocity(displacement: xr.Dataset, colors: dict[str, str]) -> Chart:
    lag = displacement["velocity_lag"].values
    shown = 0.0
    for name in colors:
        mean = displacement[f"vacf_{name}"].values
        gone = np.flatnonzero(mean < 0.02 * mean[0])
        shown = max(shown, 4.0 * float(lag[gone[0] if len(gone) else -1]))
    high = min(shown, float(lag[-1])) or 1.0
    panel = Panel(
        "Velocity autocorrelation", Scale(f"lag t ({UNITS})", ends=(-0.02 * high, high)),
        Scale("autocorrelation, over that at t = 0"),
    )  # fmt: skip
    for name, color in colors.items():
        mean, error = displacement[f"vacf_{name}"].values, displacement[f"vacf_{name}_error"].values
        panel.points(lag, mean / mean[0], error / mean[0], color, words(name), size=5.0)
    panel.across(0.0, dash="solid", width=0.8)
    return panel.chart()


def _rotation(displacement: xr.Dataset, colors: dict[str, str]) -> Chart:
    """Mean-square angle in 2D, log-log; autocorrelation of the bodies' axes in 3D."""
    lag = displacement["lag"].values
    plane = any(f"msd_angle_{name}" in displacement for name in colors)
    axis = "mean-square angle about its drift (radian<sup>2</sup>)" if plane else "autocorrelation of the bodies' axes"
    panel = Panel("Rotation of bodies", _LAG, Scale(axis, "log" if plane else "linear"))
    for name, color in colors.items():
        of = f"msd_angle_{name}" if plane else f"orientation_{name}"
        mean, error = displacement[of].values, displacement[f"{of}_error"].values
        lags = lag[: len(mean)]
        seen = (lags > 0) & (mean > 0)
        rotation = _coefficient(displacement, f"diffusion_rotational_{name}")
        label = f"D<sub>r</sub> = {told(rotation)}" if rotation is not None else "no D<sub>r</sub> could be fitted"
        below = np.minimum(error, 0.9 * mean) if plane else error
        panel.points(lags[seen], mean[seen], error[seen], color, f"{words(name)}: {label}", error_below=below[seen])
        if rotation is not None:
            line = 2.0 * rotation.value * lags[seen]
            panel.line(lags[seen], line if plane else np.exp(-line), color, dash="dash", width=1.0)
    return panel.chart()


def _coefficient(displacement: xr.Dataset, name: str) -> Estimate | None:
    """A coefficient with its error; None where the run was too short for one."""
    if name not in displacement:
        return None
    value, error = float(displacement[name]), float(displacement[f"{name}_error"])
    return Estimate(value, error, 0, math.nan, converged=math.isfinite(error)) if math.isfinite(value) else None
