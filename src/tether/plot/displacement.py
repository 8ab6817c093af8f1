"""Displacement over lag with the diffusion coefficient, velocity autocorrelation, and rotation of bodies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tether.estimate import Estimate
from tether.plot.style import DASHES, GRAY, UNITS, colored, level, points, put_title, save, style, typeset, words


def plot_displacement(displacement: xr.Dataset, path_stem: Path, title: str) -> list[Path]:
    """Mean square over lag with the fitted line, running diffusion, velocity autocorrelation, and rotation if any.

    displacement: the dataset of `tether.observe.displacement`. Writes path_stem with .png and .svg added and returns
    both paths.
    """
    names = [str(name).removeprefix("vacf_") for name in displacement if _is_of_group(str(name))]
    colors = colored(names)
    turning = [name for name in names if f"msd_angle_{name}" in displacement or f"orientation_{name}" in displacement]
    with style():
        figure = Figure(figsize=(9.2, 7.4), layout="constrained")
        ((square, running), (velocity, rotation)) = figure.subplots(2, 2)
        put_title(figure, title)
        _draw_squares(square, displacement, colors)
        _draw_running(running, displacement, colors)
        _draw_velocity(velocity, displacement, colors)
        if turning:
            _draw_rotation(rotation, displacement, {name: colors[name] for name in turning})
        else:
            rotation.remove()
        return save(figure, path_stem)


def _draw_squares(axes: Axes, displacement: xr.Dataset, colors: dict[str, str]) -> None:
    lag = displacement["lag"].values
    for name, color in colors.items():
        mean, error = _variable(displacement, f"msd_{name}")
        seen = (lag > 0) & (mean > 0)
        points(axes, lag[seen], mean[seen], error[seen], color, words(name))
        diffusion = _diffusion(displacement, f"diffusion_{name}")
        if diffusion is None:
            continue
        square = 2.0 * _dimensions(displacement, name) * diffusion.value * lag[seen]
        axes.plot(lag[seen], square, color=color, linewidth=1.0, linestyle=DASHES, zorder=2)
    if "diffusion" in "".join(map(str, displacement)):
        axes.plot([], [], color=GRAY, linewidth=1.0, linestyle=DASHES, label="slope 1: $2dDt$ with the fitted $D$")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(f"lag $t$ ({UNITS})")
    axes.set_ylabel(f"mean-square displacement ({UNITS})")
    axes.legend(loc="upper left")


def _draw_running(axes: Axes, displacement: xr.Dataset, colors: dict[str, str]) -> None:
    """Half the slope of the mean square at each lag, the fitted D across, thick where it was fitted."""
    lag = displacement["lag"].values
    highest = 0.0
    for name, color in colors.items():
        mean, error = _variable(displacement, f"diffusion_running_{name}")
        seen = lag > 0
        points(axes, lag[seen], mean[seen], error[seen], color, None)
        diffusion = _diffusion(displacement, f"diffusion_{name}")
        sure = mean[seen][np.isfinite(error[seen])]
        highest = max([highest, *sure[:-4], diffusion.value if diffusion is not None else 0.0])
        if diffusion is None:
            axes.plot([], [], color=color, label=f"{words(name)}: no $D$ could be fitted")
            continue
        level(axes, diffusion, color, f"{words(name)}: $D$ = {typeset(diffusion)}")
        fitted = displacement[f"diffusion_{name}"].attrs
        if "lag_from" in fitted:
            between = [fitted["lag_from"], fitted["lag_to"]]
            axes.plot(between, [diffusion.value] * 2, color=color, linewidth=9.0, alpha=0.3, zorder=1)
    axes.set_xscale("log")
    if highest > 0.0:
        axes.set_ylim(0.0, 1.7 * highest)  # the longest lags are noise
    axes.set_xlabel(f"lag $t$ ({UNITS})")
    axes.set_ylabel(f"running diffusion $D(t)$ ({UNITS})")
    axes.legend(loc="upper left")


def _draw_velocity(axes: Axes, displacement: xr.Dataset, colors: dict[str, str]) -> None:
    lag = displacement["velocity_lag"].values
    shown = 0.0
    for name, color in colors.items():
        mean, error = _variable(displacement, f"vacf_{name}")
        points(axes, lag, mean / mean[0], error / mean[0], color, words(name))
        gone = np.flatnonzero(mean < 0.02 * mean[0])
        shown = max(shown, 4.0 * float(lag[gone[0] if len(gone) else -1]))
    axes.axhline(0.0, color=GRAY, linewidth=0.8, zorder=1)
    axes.set_xlim(-0.02 * shown, min(shown, float(lag[-1])) or 1.0)
    axes.set_xlabel(f"lag $t$ ({UNITS})")
    axes.set_ylabel(r"velocity autocorrelation, over that at $t = 0$")
    axes.legend(loc="upper right")


def _draw_rotation(axes: Axes, displacement: xr.Dataset, colors: dict[str, str]) -> None:
    """Mean-square angle in 2D, log-log; autocorrelation of the bodies' axes in 3D."""
    lag = displacement["lag"].values
    plane = any(f"msd_angle_{name}" in displacement for name in colors)
    for name, color in colors.items():
        mean, error = _variable(displacement, f"msd_angle_{name}" if plane else f"orientation_{name}")
        lags = lag[: len(mean)]
        seen = (lags > 0) & (mean > 0)
        rotation = _diffusion(displacement, f"diffusion_rotational_{name}")
        told = f"$D_r$ = {typeset(rotation)}" if rotation is not None else "no $D_r$ could be fitted"
        points(axes, lags[seen], mean[seen], error[seen], color, f"{words(name)}: {told}")
        if rotation is not None:
            line = 2.0 * rotation.value * lags[seen]
            shown = line if plane else np.exp(-line)
            axes.plot(lags[seen], shown, color=color, linewidth=1.0, linestyle=DASHES, zorder=2)
    axes.set_xscale("log")
    if plane:
        axes.set_yscale("log")
        axes.set_ylabel("mean-square angle about its drift (radian$^2$)")
        axes.legend(loc="upper left")
    else:
        axes.set_ylim(0.0, 1.25)
        axes.set_ylabel("autocorrelation of the bodies' axes")
        axes.legend(loc="upper right")
    axes.set_xlabel(f"lag $t$ ({UNITS})")


def _variable(displacement: xr.Dataset, name: str) -> tuple[np.ndarray, np.ndarray]:
    return displacement[name].values, displacement[f"{name}_error"].values


def _diffusion(displacement: xr.Dataset, name: str) -> Estimate | None:
    """A coefficient with its error; None where the run was too short for one."""
    if name not in displacement:
        return None
    value, error = float(displacement[name]), float(displacement[f"{name}_error"])
    if not np.isfinite(value):
        return None
    return Estimate(value, error, samples=1, inefficiency=1.0, converged=bool(np.isfinite(error)))


def _dimensions(displacement: xr.Dataset, name: str) -> int:
    """Axes that the mean square is taken over: x is left out where a force drives the flow."""
    return int(np.isfinite(displacement[f"diffusion_axes_{name}"].values).sum())


def _is_of_group(name: str) -> bool:
    return name.startswith("vacf_") and not name.startswith("vacf_axes_") and not name.endswith("_error")
