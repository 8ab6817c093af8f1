"""Normal stress differences of a study against shear rate and against the Peclet number."""

from __future__ import annotations

from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure

from tether.errors import InputError
from tether.plot.style import GRAY, save, style
from tether.plot.sweep import (
    axis_label,
    curves,
    direction,
    draw_against_rate,
    explain_signs,
    head,
    is_known,
    legend_below,
    logarithmic,
    rates_and_peclet,
)


def plot_normal_stress(study: xr.Dataset, path_stem: Path) -> list[Path]:
    """N1 = S_xx - S_yy and, in 3D, N2 = S_yy - S_zz over |shear rate| and, where there are bodies, over Pe.

    The stress S is positive in tension. Both are even functions of the shear rate. A curve for each combination of the
    other swept keys; runs at rest are not on the logarithmic scale. Writes path_stem with .png and .svg added and
    returns both paths. Raises InputError for a study without normal stress differences.
    """
    names = [name for name in ("N1", "N2") if is_known(study, name)]
    if not names or "shear_rate" not in study:
        raise InputError(
            "the study has no normal stress differences", "no run of it has both an end and a shear rate",
            "run it, or draw another quantity",
        )  # fmt: skip
    places = rates_and_peclet(study)
    shown, remark = curves(study, direction(places["shear_rate"]), names)
    with style():
        wide = 4.9 * len(places) if len(places) > 1 else 6.4
        figure = Figure(figsize=(wide, 1.3 + 3.0 * len(names)), layout="constrained")
        head(figure, study, "Normal stress differences" if len(names) > 1 else "Normal stress difference", remark)
        panels = figure.subplots(len(names), len(places), sharex="col", sharey="row", squeeze=False)
        for row, quantity in zip(panels, names, strict=True):
            for axes, name in zip(row, places, strict=True):
                axes.set_xscale("log")
                axes.axhline(0.0, color=GRAY, linewidth=0.9, zorder=1)
                for curve in shown:
                    draw_against_rate(axes, curve, name, quantity)
                axes.grid(color="#E4E4E4", linewidth=0.6)
            row[0].set_ylabel(axis_label(study, quantity).replace(" difference", "\ndifference"))
        for axes, name in zip(panels[-1], places, strict=True):
            logarithmic(axes.xaxis)
            axes.set_xlabel(axis_label(study, name, magnitude=name == "shear_rate"))
        explain_signs(panels[0][0], study)
        legend_below(figure, 3)
        return save(figure, path_stem)
