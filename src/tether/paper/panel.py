"""Panel: what a figure shows, told once, and drawn for print and for the screen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from tether.plot.style import BLUE, DASHES, GREEN, ORANGE, PURPLE, SKY, VERMILION, band, points, save, style

COLORS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY)
_MARKERS = {"o": "circle", "s": "square", "^": "triangle-up", "D": "diamond", "v": "triangle-down"}


@dataclass(frozen=True)
class Series:
    """Points or a line with errors; nan leaves a gap."""

    label: str
    x: ArrayLike
    y: ArrayLike
    error: ArrayLike | None = None
    """Standard errors; None where there are none to speak of, as of a formula."""
    kind: Literal["points", "line", "dashed", "band"] = "points"
    """band: a line with its error around it."""
    color: str = BLUE
    marker: Literal["o", "s", "^", "D", "v"] = "o"
    hollow: bool = False

    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """x, y and error, zeros where there is none."""
        x, y = np.asarray(self.x, dtype=np.float64), np.asarray(self.y, dtype=np.float64)
        error = np.zeros_like(y) if self.error is None else np.asarray(self.error, dtype=np.float64)
        return x, y, error


@dataclass(frozen=True)
class Panel:
    """One pair of axes. Labels have their units; formulas stand between dollar signs."""

    title: str
    xlabel: str
    ylabel: str
    series: Sequence[Series] = field(default_factory=list)
    log_x: bool = False
    log_y: bool = False
    y_range: tuple[float, float] | None = None
    levels: Sequence[tuple[float, str]] = field(default_factory=list)
    """Thin horizontal lines with a word each."""

    @property
    def plain_title(self) -> str:
        """The title without formulas."""
        return _plain(self.title)


def draw_panels(panels: Sequence[Panel], stem: Path, columns: int = 2) -> list[Path]:
    """The panels side by side as stem.png and stem.svg."""
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    with style():
        figure = Figure(figsize=(5.2 * columns, 4.6 * rows), layout="constrained")
        grid = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, panel in zip(grid, panels, strict=False):
            _draw(axes, panel)
        for axes in grid[len(panels) :]:
            axes.set_axis_off()
        return save(figure, stem)


def _draw(axes: Axes, panel: Panel) -> None:
    axes.set_title(panel.title)
    axes.set_xlabel(panel.xlabel)
    axes.set_ylabel(panel.ylabel)
    axes.set_xscale("log" if panel.log_x else "linear")
    axes.set_yscale("log" if panel.log_y else "linear")
    for each in panel.series:
        x, y, error = each.arrays()
        if each.kind == "points":
            points(axes, x, y, error, each.color, each.label, marker=each.marker, hollow=each.hollow)
        elif each.kind == "band":
            band(axes, x, y, error, each.color, each.label)
        else:
            dashes: Any = DASHES if each.kind == "dashed" else "-"
            axes.plot(x, y, color=each.color, linestyle=dashes, linewidth=1.3, label=each.label or None)
    for level, word in panel.levels:
        axes.axhline(level, color="#6E6E6E", linewidth=0.8, linestyle=DASHES, zorder=1)
        axes.annotate(
            word, (1.0, level), xycoords=("axes fraction", "data"), xytext=(-2, 3), textcoords="offset points",
            ha="right", fontsize=8, color="#6E6E6E",
        )  # fmt: skip
    if panel.y_range is not None:
        axes.set_ylim(*panel.y_range)
    handles, labels = axes.get_legend_handles_labels()
    if labels:
        # Below the axes: what is drawn leaves no room of its own in most of the paper's figures.
        axes.legend(
            handles, labels, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2 if len(labels) > 3 else 1,
            columnspacing=1.0, handletextpad=0.5,
        )  # fmt: skip


def plotly_figure(panel: Panel) -> dict[str, Any]:
    """The panel as a Plotly figure: a dict with data and layout, which the page's own template styles."""
    traces = []
    for each in panel.series:
        x, y, error = each.arrays()
        trace: dict[str, Any] = {
            "type": "scatter", "name": _plain(each.label), "x": _numbers(x), "y": _numbers(y),
            "showlegend": bool(each.label),
        }  # fmt: skip
        if each.kind == "points":
            symbol = _MARKERS[each.marker] + ("-open" if each.hollow else "")
            trace |= {"mode": "markers", "marker": {"color": each.color, "symbol": symbol, "size": 7}}
        else:
            trace |= {
                "mode": "lines",
                "line": {"color": each.color, "dash": "dash" if each.kind == "dashed" else "solid", "width": 2},
            }
        if np.isfinite(error).any() and (np.nan_to_num(error) > 0).any():
            trace["error_y"] = {
                "type": "data",
                "array": _numbers(error),
                "color": each.color,
                "thickness": 1.2,
                "width": 0,
            }
        traces.append(trace)
    shapes = [
        {
            "type": "line",
            "xref": "paper",
            "x0": 0,
            "x1": 1,
            "y0": level,
            "y1": level,
            "line": {"dash": "dot", "width": 1},
        }
        for level, _ in panel.levels
    ]
    layout: dict[str, Any] = {
        "xaxis": {"title": {"text": _plain(panel.xlabel)}, "type": "log" if panel.log_x else "linear"},
        "yaxis": {"title": {"text": _plain(panel.ylabel)}, "type": "log" if panel.log_y else "linear"},
        "shapes": shapes,
    }
    if panel.y_range is not None:
        low, high = panel.y_range
        layout["yaxis"]["range"] = [math.log10(low), math.log10(high)] if panel.log_y else [low, high]
    return {"data": traces, "layout": layout}


def _numbers(values: NDArray[np.float64]) -> list[float | None]:
    return [float(f"{value:.6g}") if math.isfinite(value) else None for value in values.tolist()]


_LETTERS = {
    r"\dot\gamma": "\N{GREEK SMALL LETTER GAMMA}\N{COMBINING DOT ABOVE}",
    r"\gamma": "\N{GREEK SMALL LETTER GAMMA}",
    r"\phi": "\N{GREEK SMALL LETTER PHI}",
    r"\eta": "\N{GREEK SMALL LETTER ETA}",
    r"\sigma": "\N{GREEK SMALL LETTER SIGMA}",
    r"\rho": "\N{GREEK SMALL LETTER RHO}",
    r"\omega": "\N{GREEK SMALL LETTER OMEGA}",
    r"\pm": "\N{PLUS-MINUS SIGN}",
    r"\times": "\N{MULTIPLICATION SIGN}",
    r"\langle": "\N{MATHEMATICAL LEFT ANGLE BRACKET}",
    r"\rangle": "\N{MATHEMATICAL RIGHT ANGLE BRACKET}",
    r"\mathrm": "",
    r"\mathbf": "",
    r"\bar": "",
    r"\,": " ",
    "$": "",
    "{": "",
    "}": "",
    "_": "",
    "^2": "\N{SUPERSCRIPT TWO}",
    "^3": "\N{SUPERSCRIPT THREE}",
}


def _plain(text: str) -> str:
    """A label's formulas in plain letters."""
    for formula, letters in _LETTERS.items():
        text = text.replace(formula, letters)
    return text
