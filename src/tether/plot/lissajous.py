"""Stress over a cycle of oscillating shear, against strain and against rate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from tether.estimate import Estimate
from tether.plot.style import BLUE, GRAY, UNITS, points, put_title, save, style, typeset


def plot_lissajous(
    cycle: xr.Dataset,
    path_stem: Path,
    title: str,
    *,
    strain_amplitude: float,
    angular_frequency: float,
    storage: Estimate | None = None,
    loss: Estimate | None = None,
) -> list[Path]:
    """Mean stress of each phase against strain and against rate, with the ellipse of the linear response.

    cycle: from `tether.analysis.oscillatory.lissajous`. storage, loss: G' and G'', energy/length^d; the ellipse is
    gamma_0 (G' sin + G'' cos) of the phase. Writes path_stem with .png and .svg added and returns both paths.
    """
    phase = np.linspace(0.0, 2.0 * np.pi, 400)
    strain, rate = strain_amplitude * np.sin(phase), strain_amplitude * angular_frequency * np.cos(phase)
    with style():
        figure = Figure(figsize=(9.2, 4.3), layout="constrained")
        both = figure.subplots(1, 2, sharey=True)
        put_title(figure, title)
        for axes, name, line in zip(both, ("strain", "shear_rate"), (strain, rate), strict=True):
            points(axes, cycle[name].values, cycle["stress"].values, cycle["stress_error"].values, BLUE, "measured")
            if storage is not None and loss is not None:
                ellipse = strain_amplitude * (storage.value * np.sin(phase) + loss.value * np.cos(phase))
                axes.plot(line, ellipse, color=GRAY, linewidth=1.2, label="linear response", zorder=2)
            axes.axhline(0.0, color=GRAY, linewidth=0.6, zorder=1)
            axes.axvline(0.0, color=GRAY, linewidth=0.6, zorder=1)
        both[0].set_ylabel(f"shear stress $S_{{xy}}$ ({UNITS})")
        both[0].set_xlabel(r"strain $\gamma$")
        both[1].set_xlabel(rf"shear rate $\dot\gamma$ ({UNITS})")
        both[1].legend(loc="upper left")
        if storage is not None and loss is not None:
            told = f"$G'$ = {typeset(storage)}\n$G''$ = {typeset(loss)}\n{cycle.attrs['cycles']} cycles"
            both[1].text(0.97, 0.05, told, transform=both[1].transAxes, ha="right", va="bottom", fontsize=9.0)
        return save(figure, path_stem)
