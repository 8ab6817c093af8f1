"""Mean velocity across the gradient against the imposed profile, from the frames of the trajectory."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from tether.plot.style import BLUE, GRAY, UNITS, known, save, style


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
    error = known(error)
    order = np.argsort(place)
    with style():
        figure = Figure(figsize=(6.0, 5.0), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1.0])
        upper.set_title(title, pad=8)
        upper.plot(place[order], expected[order], color=GRAY, linewidth=1.2, label="imposed", zorder=2)
        markers = {"fmt": "o", "markersize": 4.0, "color": BLUE, "elinewidth": 1.0, "capsize": 0.0}
        upper.errorbar(place, mean, error, label="measured", zorder=3, **markers)
        upper.set_ylabel(f"velocity $u_x$\n({UNITS})")
        upper.legend(loc="best")
        lower.axhline(0.0, color=GRAY, linewidth=1.2, zorder=2)
        lower.errorbar(place, mean - expected, error, zorder=3, **markers)
        lower.set_ylabel("measured\n$-$ imposed")
        lower.set_xlabel(f"position along the gradient $y$ ({UNITS})")
        figure.align_ylabels([upper, lower])
        return save(figure, path_stem)
