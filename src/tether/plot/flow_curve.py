"""Flow curves of a study: viscosity against shear rate and against the Peclet number."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from tether.errors import InputError
from tether.plot.style import save, style
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
    mean,
    rates_and_peclet,
)

_WIDE = 10.0  # greatest over least viscosity, from which on the scale is logarithmic


def plot_flow_curve(study: xr.Dataset, path_stem: Path) -> list[Path]:
    """Viscosity of the total stress over |shear rate| and, where there are bodies, over Pe.

    A curve for each combination of the other swept keys. Logarithmic scales, that of the viscosity only where it spans
    more than a decade; runs at rest are not on them. Writes path_stem with .png and .svg added and returns both paths.
    Raises InputError for a study without viscosities.
    """
    if not is_known(study, "viscosity") or "shear_rate" not in study:
        raise InputError(
            "the study has no viscosity", "no run of it has both an end and a shear rate",
            "run it, or draw another quantity",
        )  # fmt: skip
    places = rates_and_peclet(study)
    shown, remark = curves(study, direction(places["shear_rate"]), ("viscosity",))
    with style():
        figure = Figure(figsize=(4.9 * len(places) if len(places) > 1 else 6.4, 4.6), layout="constrained")
        head(figure, study, "Flow curve", remark)
        panels = figure.subplots(1, len(places), sharey=True, squeeze=False)[0]
        for axes, name in zip(panels, places, strict=True):
            axes.set_xscale("log")
            for curve in shown:
                draw_against_rate(axes, curve, name, "viscosity")
            axes.set_xlabel(axis_label(study, name, magnitude=name == "shear_rate"))
            logarithmic(axes.xaxis)
            axes.grid(color="#E4E4E4", linewidth=0.6)
        value = mean(study, "viscosity").values
        positive = value[np.isfinite(value) & (value > 0.0)]
        if len(positive) == np.isfinite(value).sum() and positive.max() > _WIDE * positive.min():
            panels[0].set_yscale("log")
            logarithmic(panels[0].yaxis)
        panels[0].set_ylabel(axis_label(study, "viscosity"))
        explain_signs(panels[0], study)
        legend_below(figure, 3)
        return save(figure, path_stem)
