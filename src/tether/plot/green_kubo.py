"""The viscosity from fluctuations: spectrum of the stress with its fit, and the running integral."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tether.estimate import Estimate
from tether.plot.style import BLUE, GRAY, UNITS, VERMILION, band, level, points, put_title, save, style, typeset

_PER_DECADE = 12  # drawn points of the spectrum: single amplitudes scatter by their own size


def plot_green_kubo(
    spectrum: xr.Dataset,
    integral: xr.Dataset | None,
    path_stem: Path,
    title: str,
    viscosity: Estimate | None = None,
) -> list[Path]:
    """Mean amplitudes of the stress with the fitted model, and the integral of its autocorrelation over time.

    spectrum: `tether.analysis.green_kubo.GreenKubo.spectrum`; integral: from `running_integral` there. viscosity: the
    result, drawn across both. Writes path_stem with .png and .svg added and returns both paths.
    """
    with style():
        figure = Figure(figsize=(9.2, 4.0), layout="constrained")
        left, right = figure.subplots(1, 2)
        put_title(figure, title)
        _draw_spectrum(left, spectrum)
        left.set_xlabel(f"frequency ({UNITS})")
        left.set_ylabel(rf"spectrum of the stress, $\eta$ at $f \to 0$ ({UNITS})")
        if integral is None:
            right.text(0.5, 0.5, "too short a run", transform=right.transAxes, ha="center", color=GRAY)
        else:
            mean, error = integral["viscosity"].values, integral["viscosity_error"].values
            band(right, integral["time"].values, mean, error, BLUE, "integral of the autocorrelation")
            right.set_xlim(0.0, float(integral["time"].values[-1]))
        right.set_xlabel(f"time ({UNITS})")
        right.set_ylabel(f"running integral ({UNITS})")
        for axes in (left, right):
            if viscosity is not None and np.isfinite(viscosity.value):
                level(axes, viscosity, VERMILION, f"viscosity {typeset(viscosity)}")
            axes.set_ylim(0.0, 1.25 * axes.get_ylim()[1])
            if axes.get_legend_handles_labels()[1]:
                axes.legend(loc="upper left")
        return save(figure, path_stem)


def _draw_spectrum(axes: Axes, spectrum: xr.Dataset) -> None:
    frequency, amplitude = spectrum["frequency"].values, spectrum["amplitude"].values
    error, model, weight = (spectrum[name].values for name in ("amplitude_error", "model", "weight"))
    if len(frequency) == 0:
        return
    # An amplitude scatters in proportion to its expected value: the fit's, where there is one, not its noisy own.
    relative = float(np.median(error / np.where(amplitude > 0, amplitude, np.nan)))
    places, means, errors = in_bands(frequency, amplitude, np.where(np.isfinite(model), model, amplitude), relative)
    points(axes, places, means, errors, BLUE, "means over bands")
    fitted = (weight > 0.0) & np.isfinite(model)
    if fitted.any():
        axes.plot(frequency[fitted], model[fitted], color=VERMILION, linewidth=1.4, label="fit", zorder=4)
    axes.set_xscale("log")


def in_bands(
    frequency: NDArray[np.float64], amplitude: NDArray[np.float64], expected: NDArray[np.float64], relative: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Means over bands of equal width on a logarithmic scale, and their errors."""
    band_of = np.floor(_PER_DECADE * np.log10(frequency / frequency[0]) + 1e-9).astype(np.intp)
    count = np.bincount(band_of)
    filled = count > 0
    logarithm, mean, scale = (
        np.bincount(band_of, weights)[filled] / count[filled] for weights in (np.log(frequency), amplitude, expected)
    )
    return np.exp(logarithm), mean, scale * relative / np.sqrt(count[filled])
