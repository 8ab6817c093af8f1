"""Any quantity of a study against any of its swept keys or numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tether.errors import InputError
from tether.plot.style import points, save, style
from tether.plot.sweep import (
    Curve,
    axis_label,
    curves,
    direction,
    error,
    head,
    is_number,
    keys,
    legend_below,
    mean,
    numbers,
    points_of,
    quantities,
    quantity_in_words,
    value_in_words,
)

_WIDE = 50  # letters that stand side by side beneath a picture


def plot_against(study: xr.Dataset, quantity: str, key: str, path_stem: Path) -> list[Path]:
    """Mean over the repeats of a quantity or number, against the values of a swept key or a number.

    quantity: viscosity, pressure, peclet ...; key: a dotted key such as fluid.temperature, also one that changes with
    another, or a number such as volume_fraction, which stands along the key that it changes most with. Words stand
    side by side. A curve for each combination of the other swept keys. Writes path_stem with .png and .svg added and
    returns both paths. Raises InputError for names that the study has not, and where there is nothing to draw.
    """
    _check(quantity, [*quantities(study), *numbers(study)], "quantity")
    _check(key, [*keys(study), *numbers(study)], "swept key or number")
    x = study[key] if key in study.coords else mean(study, key)
    along = str(x.dims[0]) if key in study.coords else direction(x)
    shown, remark = curves(study, along, (quantity,))
    if not shown or (is_number(x) and not bool(np.isfinite(x).any())):
        raise InputError(
            f"{quantity} cannot be drawn against {key}", "no finished run of the study has both",
            "run the study, or draw another quantity",
        )  # fmt: skip
    with style():
        figure = Figure(figsize=(6.8, 4.8), layout="constrained")
        axes = figure.subplots()
        head(figure, study, quantity_in_words(quantity), remark)
        for curve in shown:
            _draw(axes, curve, quantity, key)
        if not is_number(x):
            _name_places(axes, [value_in_words(each) for each in x.values.tolist()])
        axes.set_xlabel(axis_label(study, key))
        axes.set_ylabel(axis_label(study, quantity))
        axes.grid(axis="y", color="#E4E4E4", linewidth=0.6)
        legend_below(figure, 3)
        return save(figure, path_stem)


def _check(name: str, known: list[str], kind: str) -> None:
    if name not in known:
        raise InputError(
            f"the study has no {kind} {name}", f"it has {', '.join(known) or 'none'}", "choose one of these"
        )


def _name_places(axes: Axes, words: list[str]) -> None:
    axes.set_xticks(range(len(words)), words)
    axes.set_xlim(-0.5, len(words) - 0.5)
    if sum(map(len, words)) > _WIDE:
        axes.tick_params("x", labelrotation=25.0)
        for label in axes.get_xticklabels():
            label.set(horizontalalignment="right", rotation_mode="anchor")


def _draw(axes: Axes, curve: Curve, quantity: str, key: str) -> None:
    x = mean(curve.part, key)
    if not is_number(x):
        x = xr.zeros_like(x, dtype=np.float64) + np.arange(x.size)
    place, value, deviation = points_of(x, mean(curve.part, quantity), error(curve.part, quantity))
    seen = np.isfinite(place) & np.isfinite(value)
    joined = np.flatnonzero(seen)[np.argsort(place[seen], kind="stable")]
    if is_number(mean(curve.part, key)):
        axes.plot(place[joined], value[joined], color=curve.color, linewidth=0.8, alpha=0.45, zorder=2)
    points(axes, place[seen], value[seen], deviation[seen], curve.color, curve.label or None, size=4.6)
