"""Relative viscosity of a study's suspensions against their volume fraction, with the laws fitted to them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tether.analysis.packing import LAWS, SIGNIFICANCE, Fit, fit
from tether.errors import InputError
from tether.plot.style import DASHES, GRAY, VERMILION, known, points, save, style, typeset
from tether.plot.sweep import Curve, axis_label, curves, direction, error, head, is_known, legend_below, mean, points_of
from tether.theory import suspension

_TOTAL, _PAIRWISE = "relative_viscosity", "relative_viscosity_pairwise"
_DRAWN = {"krieger_dougherty": "-", "krieger_dougherty_free": "-.", "quemada": ":"}
"""Laws, and the lines that they have where there is one curve; where there are more, each has the first one."""


def plot_relative_curve(study: xr.Dataset, path_stem: Path) -> list[Path]:
    """eta_r over the volume fraction in the box, a curve for each combination of the other swept keys.

    Discs: from the total stress; hollow: from the stress of the pairs alone. Lines are the laws of
    `tether.analysis.packing`, fitted to the viscosities and the plain fluid's: f(phi) with the fitted parameters, while
    points are over the plain fluid's viscosity as it was measured, so all points of a curve may lie off its line by
    the same factor, within that one's error. Writes path_stem with .png and .svg added and returns both paths. Raises
    InputError for a study without relative viscosities.
    """
    if not is_known(study, _TOTAL):
        raise InputError(
            "the study has no relative viscosity", "the plain fluid was not run, or not sheared",
            "write relative = true into the study and run it again",
        )  # fmt: skip
    shown, remark = curves(study, direction(mean(study, "volume_fraction")), (_TOTAL, _PAIRWISE))
    with style():
        figure = Figure(figsize=(6.8, 5.4), layout="constrained")
        axes = figure.subplots()
        alone = f" ({shown[0].label})" if len(shown) == 1 and shown[0].label else ""
        head(figure, study, "Relative viscosity", remark or alone)
        end = min(1.08 * max(float(np.nanmax(_fraction(curve).values)) for curve in shown) or 0.1, 1.0)
        dimension = int(study.attrs["dimension"])
        _draw_einstein(axes, dimension, end)
        for curve in shown:
            draw = _draw_alone if len(shown) == 1 else _draw_among_others
            draw(axes, curve, dimension, end)
        if len(shown) > 1 and is_known(study, _PAIRWISE):
            points(axes, [], [], [], GRAY, "hollow: pairs alone", hollow=True, size=4.6)
        axes.set_xlim(0.0, end)
        _limit(axes, shown)
        axes.set_xlabel(axis_label(study, "volume_fraction"))
        axes.set_ylabel(axis_label(study, _TOTAL))
        axes.grid(axis="y", color="#E4E4E4", linewidth=0.6)
        legend_below(figure, 2)
        return save(figure, path_stem)


def viscosities(curve: Curve, quantity: str) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Volume fractions, viscosities and errors of a curve's suspensions and, at 0, of its plain fluids; (n,) each.

    quantity: viscosity or viscosity_pairwise. One plain fluid stands beside many suspensions, but is one point.
    """
    plain = f"plain_fluid_{quantity}"
    found = points_of(_fraction(curve), mean(curve.part, quantity), error(curve.part, quantity))
    rows = list(zip(*found, strict=True))
    if f"{plain}_mean" in curve.part:
        values, errors = points_of(mean(curve.part, plain), error(curve.part, plain))
        rows += zip(np.zeros(len(values)), values, errors, strict=True)
    once = list(dict.fromkeys(row for row in rows if np.isfinite(row).all()))
    phi, value, deviation = np.array(once, dtype=np.float64).reshape(-1, 3).T
    return phi, value, deviation


def _draw_alone(axes: Axes, curve: Curve, dimension: int, end: float) -> None:
    """The only curve: all laws of the total stress, and Krieger and Dougherty's of the pairs alone."""
    for name, color, words, of, laws in (
        (_TOTAL, curve.color, "total stress", "", list(_DRAWN)),
        (_PAIRWISE, VERMILION, "pairs alone", "pairs alone, ", list(_DRAWN)[:1]),
    ):
        if is_known(curve.part, name):
            points(axes, *_relative(curve, name), color, words, size=4.6, hollow=name == _PAIRWISE)
            for each in _fits(curve, name, laws, dimension):
                _draw_fit(axes, each, color, end, f"{of}{LAWS[each.law].words}: {_parameters(each)}")


def _draw_among_others(axes: Axes, curve: Curve, dimension: int, end: float) -> None:
    """One color for all of it, and Krieger and Dougherty's law of the total stress."""
    fits = _fits(curve, _TOTAL, list(_DRAWN)[:1], dimension)
    label = f"{curve.label}: {_parameters(fits[0])}" if fits else curve.label
    points(axes, *_relative(curve, _TOTAL), curve.color, label, size=4.6)
    if is_known(curve.part, _PAIRWISE):
        points(axes, *_relative(curve, _PAIRWISE), curve.color, size=4.6, hollow=True)
    for each in fits:
        _draw_fit(axes, each, curve.color, end, None)


def _fits(curve: Curve, name: str, laws: list[str], dimension: int) -> list[Fit]:
    """Those of the laws that could be fitted."""
    measured = viscosities(curve, name.removeprefix("relative_"))
    return [each for each in (fit(law, *measured, dimension) for law in laws) if isinstance(each, Fit)]


def _draw_fit(axes: Axes, each: Fit, color: str, end: float, label: str | None) -> None:
    phi = np.linspace(0.0, end, 400)
    value = each.relative_viscosity(phi)
    inside = np.isfinite(value)
    axes.plot(phi[inside], value[inside], _DRAWN[each.law], color=color, linewidth=1.2, label=label, zorder=2)


def _parameters(each: Fit) -> str:
    """phi_m, [eta] where it was free, and a warning where the law does not describe the points."""
    told = rf"$\phi_m$ = {typeset(each.parameters['maximum_packing'])}"
    if "intrinsic_viscosity" in each.parameters:
        told += rf", [$\eta$] = {typeset(each.parameters['intrinsic_viscosity'])}"
    return f"{told} (fits badly, p < {SIGNIFICANCE:g})" if each.is_contradicted else told


def _draw_einstein(axes: Axes, dimension: int, end: float) -> None:
    slope = suspension.intrinsic_viscosity(dimension)
    line = np.array([0.0, end])
    label = rf"Einstein, $1 + {slope:g}\,\phi$"
    axes.plot(line, suspension.einstein(line, dimension), color=GRAY, linewidth=1.2, linestyle=DASHES, label=label)


def _limit(axes: Axes, shown: list[Curve]) -> None:
    """Scale of the points with their errors: laws go to infinity."""
    ends = [1.0]
    for curve in shown:
        for name in (_TOTAL, _PAIRWISE):
            if is_known(curve.part, name):
                _, value, deviation = _relative(curve, name)
                ends += [float(np.nanmin(value - known(deviation))), float(np.nanmax(value + known(deviation)))]
    low, high = min(ends), max(ends)
    height = (high - low) or 1.0
    axes.set_ylim(low - 0.05 * height, high + 0.08 * height)


def _relative(curve: Curve, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Volume fractions, relative viscosities and their errors, (n,) each."""
    phi, value, deviation = points_of(_fraction(curve), mean(curve.part, name), error(curve.part, name))
    return phi, value, deviation


def _fraction(curve: Curve) -> xr.DataArray:
    return mean(curve.part, "volume_fraction")
