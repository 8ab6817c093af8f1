"""Pictures of a run, each as PNG and SVG: series over time, velocity profile, relative viscosity.

Colors are Okabe and Ito's, told apart by color-blind readers and in gray print. matplotlib's settings and its
current figure are left as they were, so this can be called from a program with pictures of its own.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from tether.estimate import Estimate, estimate
from tether.measurement import total_stress
from tether.theory import suspension

if TYPE_CHECKING:
    import xarray as xr

BLUE = "#0072B2"
SKY = "#56B4E9"
VERMILION = "#D55E00"
GREEN = "#009E73"
GRAY = "#6E6E6E"

_STYLE: dict[Any, Any] = {
    "figure.facecolor": "white",
    "figure.dpi": 100,
    "savefig.dpi": 200,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # shipped with matplotlib: the same picture everywhere
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.5,
    "axes.linewidth": 0.7,
    "axes.edgecolor": "#404040",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "lines.linewidth": 1.6,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "svg.fonttype": "none",  # text stays text: it can be searched and edited
    "svg.hashsalt": "tether",  # the same picture, the same bytes
}
_UNITS = "DPD units"
_POINTS = 250  # of a drawn series: each is the mean of so many samples that this many are left


def plot_series(series: xr.Dataset, path_stem: Path, title: str, temperature: float | None = None) -> list[Path]:
    """Stress and temperature over time: means over short intervals, the running mean and its error band.

    series: a run's series (stress terms with dims time, row, column; temperature; attribute shear_rate).
    Under shear the stress is S_xy, whose right-hand scale is the viscosity S_xy / rate; at rest it is the
    pressure. temperature: the set kT, drawn as a line. Writes path_stem with .png and .svg added and
    returns both paths.
    """
    time = np.asarray(series["time"].values, dtype=np.float64)
    rate = float(series.attrs["shear_rate"])
    stress = total_stress(series)
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(6.8, 5.2), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True)
        upper.set_title(title, pad=8)
        if rate != 0.0:
            shear = stress.sel(row="x", column="y").values
            _draw_series(upper, time, shear, BLUE, f"viscosity {estimate(shear) / rate}")
            upper.set_ylabel(f"shear stress $S_{{xy}}$\n({_UNITS})")
            scale = upper.secondary_yaxis("right", functions=(lambda s: s / rate, lambda v: v * rate))
            scale.set_ylabel(r"viscosity $S_{xy}/\dot\gamma$")
            scale.spines["right"].set_visible(True)
        else:
            pressure = -np.trace(stress.values, axis1=1, axis2=2) / stress.sizes["row"]
            _draw_series(upper, time, pressure, BLUE, None)
            upper.set_ylabel(f"pressure\n({_UNITS})")
        _draw_series(lower, time, np.asarray(series["temperature"].values, dtype=np.float64), VERMILION, None)
        if temperature is not None:
            lower.axhline(temperature, color=GRAY, linewidth=0.9, linestyle=(0, (5, 3)), zorder=1.5)
            lower.annotate(
                "set", (1.0, temperature), xycoords=("axes fraction", "data"), xytext=(4, 0),
                textcoords="offset points", color=GRAY, fontsize=8.5, va="center",
            )  # fmt: skip
        lower.set_ylabel(f"temperature $kT$\n({_UNITS})")
        lower.set_xlabel(f"time ({_UNITS})")
        lower.set_xlim(*_padded_range(time))
        return _save(figure, path_stem)


def plot_profile(
    y: ArrayLike,
    velocity: ArrayLike,
    velocity_error: ArrayLike,
    imposed: ArrayLike,
    path_stem: Path,
    title: str,
) -> list[Path]:
    """Mean velocity along x against y with the imposed profile, and the difference of the two beneath.

    y, velocity, velocity_error, imposed: shape (bins,), in reduced units; an error that is not finite is
    not drawn. Writes path_stem with .png and .svg added and returns both paths.
    """
    place, mean, error, expected = (
        np.asarray(values, dtype=np.float64) for values in (y, velocity, velocity_error, imposed)
    )
    error = np.where(np.isfinite(error), error, 0.0)
    order = np.argsort(place)
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(6.0, 5.0), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1.0])
        upper.set_title(title, pad=8)
        upper.plot(place[order], expected[order], color=GRAY, linewidth=1.2, label="imposed", zorder=2)
        markers = {"fmt": "o", "markersize": 4.0, "color": BLUE, "elinewidth": 1.0, "capsize": 0.0}
        upper.errorbar(place, mean, error, label="measured", zorder=3, **markers)
        upper.set_ylabel(f"velocity $u_x$\n({_UNITS})")
        upper.legend(loc="best")
        lower.axhline(0.0, color=GRAY, linewidth=1.2, zorder=2)
        lower.errorbar(place, mean - expected, error, zorder=3, **markers)
        lower.set_ylabel("measured\n$-$ imposed")
        lower.set_xlabel(f"position along the gradient $y$ ({_UNITS})")
        figure.align_ylabels([upper, lower])
        return _save(figure, path_stem)


def plot_relative(
    phi: float,
    eta_r: Estimate,
    dimension: int,
    path_stem: Path,
    pairwise: Estimate | None = None,
    title: str = "Relative viscosity",
) -> list[Path]:
    """Relative viscosity at one volume fraction against Einstein's and Krieger and Dougherty's curves.

    eta_r: from the total stress; pairwise: from the stress of the DPD pairs alone, drawn beside it if
    given. An estimate without an error is drawn hollow and labelled so. Writes path_stem with .png and .svg
    added and returns both paths.
    """
    packing = suspension.MAXIMUM_PACKING[dimension]
    end = max(min(max(0.02, 1.6 * phi), 0.985 * packing), 1.1 * phi)  # a point beyond phi_m stands in the picture too
    curve = np.linspace(0.0, end, 400)
    shown = [point for point in (eta_r, pairwise) if point is not None]
    rise = max(point.value + (point.error if point.converged else 0.0) - 1.0 for point in shown)
    expected = suspension.krieger_dougherty(phi, dimension) - 1.0
    # Room above the point for the legend; a law that is far off may leave the picture.
    top = 1.0 + max(1.7 * max(rise, min(expected, 2.0 * rise)), suspension.einstein(end, dimension) - 1.0)
    bottom = min(1.0, *(point.value - 2.0 * (point.error if point.converged else 0.0) for point in shown))
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(6.0, 4.2), layout="constrained")
        axes = figure.subplots()
        axes.set_title(f"{title}, {dimension}D", pad=8)
        axes.plot(
            curve, suspension.krieger_dougherty(curve, dimension), color=BLUE,
            label=rf"Krieger-Dougherty, $\phi_m = {packing}$",
        )  # fmt: skip
        slope = suspension.intrinsic_viscosity(dimension)
        axes.plot(
            curve, suspension.einstein(curve, dimension), color=GREEN, linestyle=(0, (5, 2)),
            label=rf"Einstein, $1 + {slope:g}\,\phi$",
        )  # fmt: skip
        _draw_point(axes, phi, eta_r, "o", VERMILION, "this run")
        if pairwise is not None:
            _draw_point(axes, phi, pairwise, "s", GRAY, "this run, pairs alone")
        axes.set_ylim(bottom - 0.03 * (top - bottom), top)
        axes.set_xlim(0.0, end)
        axes.grid(axis="y", color="#E4E4E4", linewidth=0.6)
        axes.set_xlabel(r"volume fraction $\phi$")
        axes.set_ylabel(r"relative viscosity $\eta / \eta_{\mathrm{solvent}}$")
        axes.legend(loc="upper left")
        return _save(figure, path_stem)


def _draw_series(
    axes: Axes, time: NDArray[np.float64], values: NDArray[np.float64], color: str, text: str | None
) -> None:
    """Block means as a thin line, the running mean as a thick one, its one-sigma band if one is known."""
    final = estimate(values)
    size = max(1, len(values) // _POINTS)
    whole = len(values) - len(values) % size
    blocks = values[:whole].reshape(-1, size).mean(axis=1)
    middles = time[:whole].reshape(-1, size).mean(axis=1)
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
        axes.fill_between(
            time[ends - 1],
            running - error,
            running + error,
            color=color,
            alpha=0.25,
            linewidth=0.0,
            zorder=2.5,
        )
    axes.plot(time[ends - 1], running, color=color, label=f"running mean: {_typeset(text or final)}", zorder=3)
    axes.set_ylim(*_room_for_legend(blocks))
    axes.legend(loc="upper right", ncols=2)


def _draw_point(axes: Axes, phi: float, point: Estimate, marker: str, color: str, name: str) -> None:
    axes.errorbar(
        [phi], [point.value], [[point.error], [point.error]] if point.converged else None,
        fmt=marker, markersize=6.0, color=color, markerfacecolor=color if point.converged else "white",
        elinewidth=1.3, capsize=3.0, label=f"{name}: {_typeset(point)}", zorder=4, clip_on=False,
    )  # fmt: skip


def _typeset(estimate: Estimate | str) -> str:
    return str(estimate).replace("+-", "\N{PLUS-MINUS SIGN}")


def _room_for_legend(values: NDArray[np.float64]) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    height = (high - low) or max(abs(high), 1.0) * 1e-3
    return low - 0.06 * height, high + 0.28 * height


def _padded_range(values: NDArray[np.float64]) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def _save(figure: Figure, path_stem: Path) -> list[Path]:
    FigureCanvasAgg(figure)
    paths = [path_stem.with_name(f"{path_stem.name}.{kind}") for kind in ("png", "svg")]
    for path in paths:
        dated = {"Date": None} if path.suffix == ".svg" else {}
        figure.savefig(path, metadata=dated)
    return paths
