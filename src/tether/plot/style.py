"""What all pictures share: colors, settings, how numbers and errors are drawn, and how a picture is written."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import cycle
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from tether.estimate import Estimate

BLUE = "#0072B2"
SKY = "#56B4E9"
VERMILION = "#D55E00"
GREEN = "#009E73"
ORANGE = "#E69F00"
PURPLE = "#CC79A7"
GRAY = "#6E6E6E"

DASHES = (0, (5, 3))
"""Of lines that were not measured."""

UNITS = "DPD units"

_UNKNOWN = "error not known"

STYLE: dict[Any, Any] = {
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


@contextmanager
def style() -> Iterator[None]:
    """The settings of all pictures, for as long as one is drawn."""
    with mpl.rc_context(STYLE):
        yield


def colored(names: list[str]) -> dict[str, str]:
    """A color for each name: blue for the solvent, which comes first, then others in turn."""
    colors = cycle([BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY])
    return {name: next(colors) for name in names}


def words(name: str) -> str:
    """The name of a species or quantity as words."""
    return name.replace("_", " ")


def typeset(estimate: Estimate | str) -> str:
    """Value and error with the sign for it."""
    return str(estimate).replace("+-", "\N{PLUS-MINUS SIGN}")


def put_title(figure: Figure, text: str) -> None:
    """Above the picture at the left, in as many lines as it needs."""
    wide = int(12.5 * figure.get_figwidth())
    figure.suptitle(fill(text, wide), x=0.01, ha="left", fontsize=10.5, fontweight="bold")


def points(
    axes: Axes,
    x: ArrayLike,
    y: ArrayLike,
    error: ArrayLike,
    color: str,
    label: str | None = None,
    *,
    marker: str = "o",
    size: float = 3.6,
    hollow: bool = False,
) -> None:
    """Means with their errors; pale, and named so in the legend, where the error is not known."""
    place, mean, deviation = (np.asarray(each, dtype=np.float64) for each in (x, y, error))
    face = "white" if hollow else color
    sure = np.isfinite(deviation)
    axes.errorbar(
        place[sure], mean[sure], deviation[sure], fmt=marker, markersize=size, color=color, label=label,
        markerfacecolor=face, markeredgewidth=0.9, elinewidth=0.9, capsize=0.0, zorder=3,
    )  # fmt: skip
    if np.isfinite(mean[~sure]).any():
        shape: dict[str, Any] = {"marker": marker, "markersize": size, "linestyle": "none", "alpha": 0.35}
        axes.plot(place[~sure], mean[~sure], color=color, markerfacecolor=face, **shape)
        if _UNKNOWN not in axes.get_legend_handles_labels()[1]:
            axes.plot([], [], color=GRAY, label=_UNKNOWN, **shape)


def band(axes: Axes, x: ArrayLike, y: ArrayLike, error: ArrayLike, color: str, label: str | None = None) -> None:
    """A line, and its error as a band around it."""
    place, mean, width = (np.asarray(each, dtype=np.float64) for each in (x, y, known(error)))
    axes.fill_between(place, mean - width, mean + width, color=color, alpha=0.25, linewidth=0.0, zorder=2.5)
    axes.plot(place, mean, color=color, linewidth=1.3, label=label, zorder=3)


def level(axes: Axes, estimate: Estimate, color: str, label: str | None = None) -> None:
    """A mean across the picture, and its error as a band."""
    if estimate.converged:
        low, high = estimate.value - estimate.error, estimate.value + estimate.error
        axes.axhspan(low, high, color=color, alpha=0.2, linewidth=0.0, zorder=1)
    axes.axhline(estimate.value, color=color, linewidth=1.0, linestyle=DASHES, label=label, zorder=2)


def marked(axes: Axes, y: float, text: str) -> None:
    """A thin line across the picture with a word at its right end."""
    axes.axhline(y, color=GRAY, linewidth=0.9, linestyle=DASHES, zorder=1.5)
    axes.annotate(
        text, (1.0, y), xycoords=("axes fraction", "data"), xytext=(4, 0),
        textcoords="offset points", color=GRAY, fontsize=8.5, va="center",
    )  # fmt: skip


def known(error: ArrayLike) -> NDArray[np.float64]:
    """Errors, 0 where one is not known, so that it is not drawn."""
    given = np.asarray(error, dtype=np.float64)
    return np.where(np.isfinite(given), given, 0.0)


def legend_above(axes: Axes, columns: int = 3, *, from_zero: bool = False) -> None:
    """A legend, and room for it above what is drawn. from_zero: the scale begins there."""
    rows = -(-len(axes.get_legend_handles_labels()[1]) // columns)
    if rows == 0:
        return
    low, high = axes.get_ylim()
    low = 0.0 if from_zero else low
    share = 0.2 * rows / axes.get_position().height / axes.figure.get_figheight()  # type: ignore[union-attr]
    axes.set_ylim(low, high + 1.3 * share * (high - low))
    axes.legend(loc="upper right", ncols=columns, columnspacing=1.0, handletextpad=0.4)


def room_above(axes: Axes, low: float, high: float, above: float = 0.28) -> None:
    """Limits around values from low to high, with room for a legend above."""
    height = (high - low) or max(abs(high), 1.0) * 1e-3
    axes.set_ylim(low - 0.06 * height, high + above * height)


def save(figure: Figure, path_stem: Path) -> list[Path]:
    """Write the picture with .png and .svg added to the name, which may have a dot; returns both paths."""
    FigureCanvasAgg(figure)
    paths = [path_stem.with_name(f"{path_stem.name}.{kind}") for kind in ("png", "svg")]
    for path in paths:
        dated = {"Date": None} if path.suffix == ".svg" else {}
        figure.savefig(path, metadata=dated)
    return paths
