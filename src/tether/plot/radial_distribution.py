"""Radial distribution functions, where they begin, and the pairs of bodies in the flow-gradient plane."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tether.estimate import Estimate
from tether.observe.radial_distribution import THRESHOLD
from tether.plot.style import GRAY, UNITS, band, colored, marked, put_title, save, style, typeset, words

_COARSE = 0.05  # distance over which the function of bodies is averaged: they are few, and bins are narrow

Curve = tuple[str, NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
"""A name, distances, g and its error."""


def plot_radial_distribution(functions: xr.Dataset, path_stem: Path, title: str, *, dimension: int = 3) -> list[Path]:
    """g(r) with solvent and of bodies, their beginnings on a logarithmic scale with sizes, and the map of pairs.

    functions: the dataset of `tether.observe.radial_distribution`, of so many dimensions. Writes path_stem with .png
    and .svg added and returns both paths.
    """
    with_solvent = _curves(functions, "r")
    kinds = [name.removesuffix("_solvent") for name, *_ in with_solvent]
    names = {f"{a}_{b}": f"{words(a)} - {words(b)}" for a in kinds for b in kinds}
    of_bodies = [_coarser(curve, dimension) for curve in _curves(functions, "r_bodies")]
    has_map = "g_bodies_plane" in functions and bool((functions["g_bodies_plane"] > 0).any())
    colors = colored([name for name, *_ in with_solvent])
    lower_panels = [draw for draw, wanted in ((_draw_bodies, bool(of_bodies)), (_draw_map, has_map)) if wanted]
    with style():
        figure = Figure(figsize=(9.2, 3.8 if not lower_panels else 7.8), layout="constrained")
        axes = figure.subplots(2 if lower_panels else 1, 2, squeeze=False)
        put_title(figure, title)
        _draw_curves(axes[0, 0], with_solvent, colors, names)
        _draw_beginnings(axes[0, 1], functions, with_solvent, colors)
        for place in range(2 if lower_panels else 0):
            if place >= len(lower_panels):
                axes[1, place].remove()
            elif lower_panels[place] is _draw_bodies:
                _draw_bodies(axes[1, place], of_bodies, names)
            else:
                _draw_map(axes[1, place], functions, figure)
        return save(figure, path_stem)


def _draw_curves(axes: Axes, curves: list[Curve], colors: dict[str, str], names: dict[str, str]) -> None:
    for name, r, g, error in curves:
        band(axes, r, g, error, colors[name], names[name])
    _finish(axes, curves, "distance $r$")


def _draw_bodies(axes: Axes, curves: list[Curve], names: dict[str, str]) -> None:
    colors = colored(["solvent", *(name for name, *_ in curves)])
    for name, r, g, error in curves:
        band(axes, r, g, error, colors[name], names[name])
    _finish(axes, curves, f"distance of centers $r$, means over {_COARSE:g}")


def _finish(axes: Axes, curves: list[Curve], label: str) -> None:
    axes.axhline(1.0, color=GRAY, linewidth=0.8, zorder=1)
    axes.set_xlim(0.0, max((float(r[-1]) for _, r, *_ in curves), default=1.0))
    axes.set_ylim(0.0, 1.25 * max((float(g.max()) for *_, g, _ in curves), default=1.0) or 1.0)
    axes.set_xlabel(f"{label} ({UNITS})")
    axes.set_ylabel("$g(r)$")
    axes.legend(loc="upper right")


def _draw_beginnings(axes: Axes, functions: xr.Dataset, curves: list[Curve], colors: dict[str, str]) -> None:
    """Where each curve passes the threshold. A bin without a pair has no place on the scale and no dot."""
    ends = [0.3]
    for name, r, g, error in curves:
        kind = name.removesuffix("_solvent")
        color, seen = colors[name], g > 0.0
        low = np.minimum(error, 0.9 * g)  # a bar that passes zero ends where it can still be drawn
        axes.errorbar(
            r[seen], g[seen], np.stack([low[seen], error[seen]]), fmt="o", markersize=2.4, color=color,
            elinewidth=0.7, alpha=0.9, label=_size(functions, kind), zorder=3,
        )  # fmt: skip
        distance = _scalar(functions, f"contact_distance_{kind}")
        if math.isfinite(distance):
            axes.plot([distance] * 2, [1e-3, 3.0], color=color, linewidth=0.9, linestyle=(0, (2, 2)), zorder=2)
            ends.append(1.6 * distance)
        elif seen.any():
            ends.append(float(r[seen][0]) + 0.3)
    axes.set_yscale("log")
    axes.set_ylim(1e-3, 60.0)
    axes.set_xlim(0.0, max(ends))
    marked(axes, THRESHOLD, f"{THRESHOLD:g}")
    axes.set_xlabel(f"distance $r$ ({UNITS})")
    axes.set_ylabel("$g(r)$")
    axes.legend(loc="upper left", handletextpad=0.2)


def _draw_map(axes: Axes, functions: xr.Dataset, figure: Figure) -> None:
    """g in the flow-gradient plane: 1 is white, more pairs than by chance are red, fewer are blue."""
    values = functions["g_bodies_plane"]
    x, y = functions["separation_x"].values, functions["separation_y"].values
    half = 0.5 * float(x[1] - x[0]) if len(x) > 1 else 0.5
    # Single bins may be far up by chance: the color ends where all but one in 200 are.
    most = max(1.5, float(np.quantile(values.values, 0.995)))
    image = axes.imshow(
        values.transpose("separation_y", "separation_x").values, origin="lower", cmap="RdBu_r", interpolation="nearest",
        norm=TwoSlopeNorm(1.0, vmin=0.0, vmax=most),
        extent=(float(x[0]) - half, float(x[-1]) + half, float(y[0]) - half, float(y[-1]) + half),
    )  # fmt: skip
    axes.set_xlabel(f"separation along the flow $x$ ({UNITS})")
    axes.set_ylabel(f"separation along the gradient $y$ ({UNITS})")
    bar = figure.colorbar(image, ax=axes, extend="max", shrink=0.85, ticks=[0.0, 0.5, 1.0, 0.5 * (1.0 + most), most])
    bar.ax.set_yticklabels(["0", "0.5", "1", f"{0.5 * (1.0 + most):.3g}", f"{most:.3g}"])
    bar.set_label("pairs of bodies, 1 by chance")


def _curves(functions: xr.Dataset, dimension: str) -> list[Curve]:
    return [
        (str(name).removeprefix("g_"), functions[dimension].values, g.values, functions[f"{name}_error"].values)
        for name, g in functions.data_vars.items()
        if g.dims == (dimension,) and str(name).startswith("g_") and not str(name).endswith("_error")
    ]


def _coarser(curve: Curve, dimension: int) -> Curve:
    """Means over _COARSE, weighted as shells are large; errors of neighboring bins as if independent."""
    name, r, g, error = curve
    size = max(1, round(_COARSE / (r[1] - r[0]))) if len(r) > 1 else 1
    whole = len(r) - len(r) % size
    weight = (r[:whole] ** (dimension - 1)).reshape(-1, size)
    weight = weight / weight.sum(axis=1, keepdims=True)
    mean = (weight * g[:whole].reshape(-1, size)).sum(axis=1)
    its_error = np.sqrt(((weight * error[:whole].reshape(-1, size)) ** 2).sum(axis=1))
    return name, r[:whole].reshape(-1, size).mean(axis=1), mean, its_error


def _size(functions: xr.Dataset, kind: str) -> str:
    """The effective radius in words, or that there is none."""
    radius, error = (_scalar(functions, f"effective_radius_{kind}{ending}") for ending in ("", "_error"))
    if not math.isfinite(radius):
        resolved = _scalar(functions, f"effective_radius_{kind}_by_resolution")
        by = f", radius {resolved:.3g} by resolution" if math.isfinite(resolved) else ""
        return f"{words(kind)}: begins above {THRESHOLD:g}{by}"
    told = Estimate(radius, error, samples=1, inefficiency=1.0, converged=math.isfinite(error) and error > 0.0)
    contact = _scalar(functions, f"contact_distance_{kind}")
    number = typeset(told) if told.converged else f"{radius:.3f}"
    return f"{words(kind)}: from {contact:.3f} on, effective radius {number}"


def _scalar(functions: xr.Dataset, name: str) -> float:
    return float(functions[name]) if name in functions else math.nan
