"""Panel: one interactive plot. What all of them share is what `tether.plot.style` says of pictures: colors, fonts,
units on every axis, errors always drawn, and drawn pale where they are not known.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from plotly import graph_objects as go

from tether.estimate import Estimate
from tether.plot.style import GRAY
from tether.report.page import Chart

_UNKNOWN = "error not known"
_DIGITS = 6  # of numbers in a page: more than any plot shows, or any error is worth
_FEW_DECADES = 300.0  # greatest over least place on an axis whose numbers are written out
_LAST = 2000  # rank in the legend; others have 1000
_WIDE = 440  # height of a plot that takes all of the width, pixels
_SYMBOLS = {"o": "circle", "s": "square", "v": "triangle-down"}


def told(estimate: Estimate) -> str:
    """Value and error for a legend."""
    return str(estimate).replace("+-", "\N{PLUS-MINUS SIGN}")


@dataclass(frozen=True)
class Scale:
    """An axis: what stands along it, with its unit, and how."""

    words: str
    kind: Literal["linear", "log"] = "linear"
    ends: tuple[float, float] | None = None
    """Where it begins and ends, if not with what is drawn."""
    from_zero: bool = False
    names: tuple[str, ...] = ()
    """What stands at 0, 1, 2, ... instead of numbers."""

    def as_dict(self) -> dict[str, Any]:
        """For Plotly, whose ends are logarithms on a logarithmic scale."""
        axis: dict[str, Any] = {"title": {"text": self.words}, "type": self.kind}
        if self.ends is not None:
            axis["range"] = [math.log10(end) if self.kind == "log" else end for end in self.ends]
        if self.from_zero:
            axis["rangemode"] = "tozero"
        if self.names:
            axis |= {"tickvals": list(range(len(self.names))), "ticktext": list(self.names)}
            axis["range"] = [-0.5, len(self.names) - 0.5]
        return axis


class Panel:
    """One plot, made of points, lines, bands and levels."""

    def __init__(self, title: str, x: Scale, y: Scale) -> None:
        """title: what is drawn, above the plot; it is no part of it."""
        self._title, self._x, self._y = title, x, y
        self._figure = go.Figure()
        self._named: set[str] = set()

    def points(
        self, x: ArrayLike, y: ArrayLike, error: ArrayLike, color: str, label: str = "", *, marker: str = "o",
        size: float = 6.0, hollow: bool = False, error_below: ArrayLike | None = None, joined: bool = False,
    ) -> None:  # fmt: skip
        """Means with their errors, shape (n,) each; pale, and named so in the legend, where the error is not known.

        error_below: of the lower half of the bars, where it is another. joined: with a thin line between them.
        """
        place, mean, deviation = (np.atleast_1d(np.asarray(each, dtype=np.float64)) for each in (x, y, error))
        if joined:
            self.line(place, mean, color, width=0.8, opacity=0.45)
        sure = np.isfinite(deviation)
        mark = {"symbol": _SYMBOLS[marker] + ("-open" if hollow else ""), "size": size, "color": color}
        bars: dict[str, Any] = {"array": _rounded(deviation[sure]), "thickness": 1.3, "width": 0, "color": color}
        if error_below is not None:
            bars |= {"symmetric": False, "arrayminus": _rounded(np.asarray(error_below, dtype=np.float64)[sure])}
        if sure.any() or not len(place):
            self._add(
                go.Scatter, x=_rounded(place[sure]), y=_rounded(mean[sure]), error_y=bars, mode="markers",
                marker=mark, name=label,
                hovertemplate="(%{x:.5g}, %{y:.5g} \N{PLUS-MINUS SIGN} %{error_y.array:.2g})",
            )  # fmt: skip
        unsure = ~sure & np.isfinite(mean)
        if unsure.any():
            self._add(
                go.Scatter, x=_rounded(place[unsure]), y=_rounded(mean[unsure]), mode="markers", opacity=0.4,
                marker=mark, name="" if sure.any() else label, hovertemplate=f"(%{{x:.5g}}, %{{y:.5g}}, {_UNKNOWN})",
            )  # fmt: skip
            self._add(
                go.Scatter, x=[None], y=[None], mode="markers", opacity=0.4, name=_UNKNOWN, legendrank=_LAST,
                marker={**mark, "color": GRAY},
            )  # fmt: skip

    def line(
        self, x: ArrayLike, y: ArrayLike, color: str, label: str = "", *, width: float = 1.4, dash: str = "solid",
        opacity: float = 1.0, stepped: bool = False,
    ) -> None:  # fmt: skip
        """A line; stepped: with its values in the middle of steps."""
        shape = {"color": color, "width": width, "dash": dash, "shape": "hvh" if stepped else "linear"}
        self._add(
            go.Scatter, x=_rounded(x), y=_rounded(y), mode="lines", line=shape, opacity=opacity, name=label,
            hovertemplate="(%{x:.5g}, %{y:.5g})",
        )  # fmt: skip

    def band(self, x: ArrayLike, y: ArrayLike, error: ArrayLike, color: str, label: str = "") -> None:
        """A line, and its error as a band around it where it is known."""
        place, mean, width = (np.asarray(each, dtype=np.float64) for each in (x, y, error))
        known = np.isfinite(width) & np.isfinite(mean)
        if known.any():
            around = np.concatenate([mean[known] - width[known], (mean[known] + width[known])[::-1]])
            self._add(
                go.Scatter, x=_rounded(np.concatenate([place[known], place[known][::-1]])), y=_rounded(around),
                fill="toself", fillcolor=_pale(color, 0.25), line={"width": 0}, mode="lines", hoverinfo="skip", name="",
            )  # fmt: skip
        self._add(
            go.Scatter, x=_rounded(place), y=_rounded(mean), mode="lines", line={"color": color, "width": 1.6},
            name=label, customdata=_rounded(width),
            hovertemplate="(%{x:.5g}, %{y:.5g} \N{PLUS-MINUS SIGN} %{customdata:.2g})",
        )  # fmt: skip

    def level(self, estimate: Estimate, color: str, label: str = "") -> None:
        """A mean across the plot, and its error as a band."""
        value, error = estimate.value, estimate.error
        if estimate.converged and math.isfinite(error):
            self._figure.add_shape(
                type="rect", xref="paper", x0=0, x1=1, y0=value - error, y1=value + error, layer="below",
                fillcolor=_pale(color, 0.2), line={"width": 0},
            )  # fmt: skip
        self.across(value, color, label)

    def across(self, y: float, color: str = GRAY, label: str = "", *, dash: str = "dash", width: float = 1.0) -> None:
        """A line from one side to the other, named in the legend."""
        line = {"color": color, "width": width, "dash": dash}
        self._figure.add_shape(type="line", xref="paper", x0=0, x1=1, y0=y, y1=y, layer="below", line=line)
        if label:
            self._add(go.Scatter, x=[None], y=[None], mode="lines", line=line, name=label)

    def upright(self, x: float, color: str = GRAY, *, dash: str = "dot") -> None:
        """A line from top to bottom."""
        line = {"color": color, "width": 1.0, "dash": dash}
        self._figure.add_shape(type="line", yref="paper", x0=x, x1=x, y0=0, y1=1, layer="below", line=line)

    def map(self, x: ArrayLike, y: ArrayLike, z: ArrayLike, most: float, words: str) -> None:
        """Values of shape (y, x) by color, 1 in the middle of the scale, to the same scale along both axes."""
        middle = 1.0 / most
        colors = [[0.0, "#2166ac"], [0.5 * middle, "#92c5de"], [middle, "#f7f7f7"]]
        colors += [[0.5 * (1.0 + middle), "#f4a582"], [1.0, "#b2182b"]]
        self._add(
            go.Heatmap, x=_rounded(x), y=_rounded(y), z=[_rounded(row) for row in np.asarray(z)], zmin=0.0, zmax=most,
            colorscale=colors, colorbar={"title": {"text": words, "side": "right"}, "thickness": 12, "len": 0.9},
            hovertemplate="(%{x:.3g}, %{y:.3g}): %{z:.3g}<extra></extra>",
        )  # fmt: skip
        self._figure.update_xaxes(constrain="domain")
        self._figure.update_yaxes(scaleanchor="x", constrain="domain")

    def chart(self, caption: str = "", *, wide: bool = False) -> Chart:
        """What stands in a page; its alternative text says what is drawn against what."""
        x, y = self._x.as_dict(), self._y.as_dict()
        for name, scale, axis in (("x", self._x, x), ("y", self._y, y)):
            if scale.kind == "log" and self._spans_few_decades(name):
                axis |= {"dtick": "D2", "tickformat": "~g"}  # plain numbers at 1, 2 and 5
        self._figure.update_layout(xaxis=x, yaxis=y, **({"height": _WIDE} if wide else {}))
        words = re.sub(r"</?\w+>", "", f"{self._title}: {self._y.words} against {self._x.words}")
        return Chart(self._figure.to_dict(), alt=words, title=self._title, caption=caption, wide=wide)

    def _spans_few_decades(self, along: str) -> bool:
        drawn = [each for trace in self._figure.data for each in trace[along] if each is not None and each > 0.0]
        return bool(drawn) and max(drawn) < _FEW_DECADES * min(drawn)

    def _add(self, kind: Any, *, name: str = "", **settings: Any) -> None:
        """A trace, in the legend if it has a name that is not there yet."""
        shown = bool(name) and name not in self._named
        self._named.add(name)
        if kind is not go.Heatmap:
            settings["showlegend"] = shown
        self._figure.add_trace(kind(name=name, **settings))


def _rounded(values: ArrayLike) -> list[float | None]:
    """Numbers short enough for a page; None where there is none."""
    numbers: NDArray[np.float64] = np.asarray(values, dtype=object).astype(np.float64)
    return [float(f"{each:.{_DIGITS}g}") if math.isfinite(each) else None for each in numbers.ravel().tolist()]


def _pale(color: str, opacity: float) -> str:
    red, green, blue = (int(color[place : place + 2], 16) for place in (1, 3, 5))
    return f"rgba({red},{green},{blue},{opacity})"
