"""Radial distribution functions, where they begin, and the pairs of bodies in the flow-gradient plane."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from tether.observe.radial_distribution import THRESHOLD
from tether.plot.style import GRAY, UNITS, colored, words
from tether.report.charts.comparison import Comparison
from tether.report.charts.panel import Panel, Scale
from tether.report.page import Chart

_POINTS = 300  # of a curve of bodies, which are few: neighboring bins are put together
_G = Scale("g(r)", from_zero=True)
_BEGINS = 1e-3


def radial_distribution_charts(functions: xr.Dataset, comparison: Comparison) -> list[Chart]:
    """Of the dataset of `tether.observe.radial_distribution`."""
    with_solvent = _names(functions, "r")
    colors = colored(with_solvent)
    charts = [_curves("Radial distribution with solvent", functions, "r", colors), _beginnings(functions)]
    of_bodies = _names(functions, "r_bodies")
    if of_bodies:
        coarse = _coarser(functions, of_bodies, comparison.configuration.dimension)
        colors = dict(list(colored(["solvent", *of_bodies]).items())[1:])
        charts.append(_curves("Radial distribution of bodies' centers", coarse, "r_bodies", colors))
    if "g_bodies_plane" in functions and bool((functions["g_bodies_plane"] > 0).any()):
        charts.append(_map(functions))
    return charts


def _names(functions: xr.Dataset, along: str) -> list[str]:
    return [
        str(name)
        for name, g in functions.data_vars.items()
        if g.dims == (along,) and str(name).startswith("g_") and not str(name).endswith("_error")
    ]


def _curves(title: str, functions: xr.Dataset, along: str, colors: dict[str, str]) -> Chart:
    panel = Panel(title, Scale(f"distance r ({UNITS})", ends=(0.0, float(functions[along][-1]))), _G)
    for name, color in colors.items():
        label = words(name.removeprefix("g_"))
        panel.band(functions[along].values, functions[name].values, functions[f"{name}_error"].values, color, label)
    panel.across(1.0, dash="solid", width=0.8)
    return panel.chart()


def _beginnings(functions: xr.Dataset) -> Chart:
    """On a logarithmic scale, on which a bin without a pair has no place; dotted where g is 0.01."""
    r = functions["r"].values
    ends, contacts, drawn = [0.3], [], []
    for name, color in colored(_names(functions, "r")).items():
        kind = name.removeprefix("g_").removesuffix("_solvent")
        g, error = functions[name].values, functions[f"{name}_error"].values
        distance = float(functions.get(f"contact_distance_{kind}", math.nan))
        if math.isfinite(distance):
            contacts.append((distance, color))
            ends.append(1.6 * distance)
        elif (g > 0).any():
            ends.append(float(r[g > 0][0]) + 0.3)
        radius = float(functions.get(f"effective_radius_{kind}", math.nan))
        size = f", effective radius {radius:.3g}" if math.isfinite(radius) else ""
        drawn.append((g, error, color, f"{words(kind)}{size}"))
    panel = Panel(
        "Where g(r) begins", Scale(f"distance r ({UNITS})", ends=(0.0, max(ends))),
        Scale("g(r)", "log", ends=(_BEGINS, 30.0)),
    )  # fmt: skip
    for g, error, color, label in drawn:
        seen = (g > 0.0) & (r <= max(ends))
        low = np.minimum(error, 0.9 * g)  # a bar that passes zero ends where it can still be drawn
        panel.points(r[seen], g[seen], error[seen], color, label, size=4.0, error_below=low[seen])
    for distance, color in contacts:
        panel.upright(distance, color)
    panel.across(THRESHOLD, GRAY, f"{THRESHOLD:g}, where contact is")
    return panel.chart()


def _coarser(functions: xr.Dataset, names: list[str], dimension: int) -> xr.Dataset:
    """Fewer bins, weighted as shells are large; errors of neighboring bins as if independent."""
    r = functions["r_bodies"].values
    size = max(1, len(r) // _POINTS)
    whole = len(r) - len(r) % size
    weight = (r[:whole] ** (dimension - 1)).reshape(-1, size)
    weight = weight / weight.sum(axis=1, keepdims=True)
    made = {}
    for name in names:
        g, error = (functions[each].values[:whole].reshape(-1, size) for each in (name, f"{name}_error"))
        made[name] = ("r_bodies", (weight * g).sum(axis=1))
        made[f"{name}_error"] = ("r_bodies", np.sqrt(((weight * error) ** 2).sum(axis=1)))
    return xr.Dataset(made, {"r_bodies": r[:whole].reshape(-1, size).mean(axis=1)})


def _map(functions: xr.Dataset) -> Chart:
    """1 is white, more pairs than by chance are red, fewer are blue."""
    values = functions["g_bodies_plane"].transpose("separation_y", "separation_x").values
    # Single bins may be far up by chance: the color ends where all but one in 200 are.
    most = max(1.5, float(np.quantile(values, 0.995)))
    panel = Panel(
        "Pairs of bodies in the flow-gradient plane", Scale(f"separation along the flow x ({UNITS})"),
        Scale(f"separation along the gradient y ({UNITS})"),
    )  # fmt: skip
    x, y = functions["separation_x"].values, functions["separation_y"].values
    panel.map(x, y, values, most, "pairs, 1 by chance")
    return panel.chart()
