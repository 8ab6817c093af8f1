"""Contours of a field about a body, for figures 3 and 4."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tether.plot.style import BLUE, DASHES, GRAY, SKY, VERMILION, save, style

_REACH = 1.25  # from the body's center to the edge of the picture
_POINTS = 241


@dataclass(frozen=True)
class Landscape:
    """A field in the plane about a body, and its mean over all directions."""

    title: str
    sites: NDArray[np.float64]
    """Shape (p, 2)."""
    field: NDArray[np.float64]
    """On the points of `plane`, shape (_POINTS, _POINTS)."""
    radius: NDArray[np.float64]
    least: NDArray[np.float64]
    mean: NDArray[np.float64]
    greatest: NDArray[np.float64]
    """Over the directions, at each radius."""


def plane() -> NDArray[np.float64]:
    """The points of the picture, (_POINTS, _POINTS, 2): rows of y, columns of x."""
    line = np.linspace(-_REACH, _REACH, _POINTS)
    return np.stack(np.meshgrid(line, line), axis=-1)


def draw_landscapes(landscapes: Sequence[Landscape], label: str, size: float, stem: Path) -> list[Path]:
    """Contours above, profiles below, a column each. label: the field with its unit; size: of the circle drawn in."""
    greatest = max(each.field.max() for each in landscapes)
    levels = np.arange(0.0, greatest + 5.0, 5.0)
    with style():
        figure = Figure(figsize=(4.6 * len(landscapes), 8.6), layout="constrained")
        above, below = figure.subplots(2, len(landscapes), squeeze=False, height_ratios=(1.25, 1.0))
        for axes, each in zip(above, landscapes, strict=True):
            shades = _contours(axes, each, levels, size)
        figure.colorbar(shades, ax=list(above), label=label, shrink=0.85)
        for axes, each in zip(below, landscapes, strict=True):
            _profile(axes, each, label, size)
        return save(figure, stem)


def _contours(axes: Axes, landscape: Landscape, levels: NDArray[np.float64], size: float) -> ContourSet:
    line = np.linspace(-_REACH, _REACH, _POINTS)
    shades = axes.contourf(line, line, landscape.field, levels, cmap="Blues")
    axes.contour(line, line, landscape.field, levels[1:], colors=GRAY, linewidths=0.5)
    axes.plot(*landscape.sites.T, "o", color=VERMILION, markersize=4.5, markeredgecolor="white")
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    axes.plot(size * np.cos(turn), size * np.sin(turn), color=VERMILION, linewidth=1.0, linestyle=DASHES)
    axes.set_title(landscape.title)
    axes.set_aspect("equal")
    axes.set_xlabel("$x$ (length)")
    axes.set_ylabel("$y$ (length)")
    return shades


def _profile(axes: Axes, landscape: Landscape, label: str, size: float) -> None:
    axes.fill_between(
        landscape.radius, landscape.least, landscape.greatest, color=SKY, alpha=0.5, label="all directions"
    )
    axes.plot(landscape.radius, landscape.mean, color=BLUE, label="mean over directions")
    axes.axvline(size, color=VERMILION, linewidth=1.0, linestyle=DASHES, label=f"{size:g}, where the solvent begins")
    axes.set_xlabel("distance from the body's center (length)")
    axes.set_ylabel(label)
    axes.set_ylim(0.0, None)
    axes.legend(loc="upper right")
