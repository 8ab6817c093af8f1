"""Relative viscosity against the volume fraction, beside theory."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tether.estimate import Estimate
from tether.plot.style import BLUE, GRAY, GREEN, VERMILION, save, style, typeset
from tether.theory import suspension


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
    with style():
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
        return save(figure, path_stem)


def _draw_point(axes: Axes, phi: float, point: Estimate, marker: str, color: str, name: str) -> None:
    axes.errorbar(
        [phi], [point.value], [[point.error], [point.error]] if point.converged else None,
        fmt=marker, markersize=6.0, color=color, markerfacecolor=color if point.converged else "white",
        elinewidth=1.3, capsize=3.0, label=f"{name}: {typeset(point)}", zorder=4, clip_on=False,
    )  # fmt: skip
