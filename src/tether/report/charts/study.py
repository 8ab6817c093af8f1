"""Curves of a study: relative viscosity with the fitted laws, flow curves, normal stresses, and whatever was swept."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether.analysis.packing import LAWS, SIGNIFICANCE, Fit, fit
from tether.plot.relative_curve import viscosities
from tether.plot.style import GRAY, VERMILION
from tether.plot.sweep import (
    Curve,
    axis_label,
    curves,
    direction,
    error,
    is_known,
    is_number,
    mean,
    points_of,
    quantity_in_words,
    rates_and_peclet,
    swept_keys,
    value_in_words,
)
from tether.report.charts.panel import Panel, Scale, told
from tether.report.page import Chart
from tether.report.style import of_formulas
from tether.theory import suspension

_TOTAL, _PAIRWISE = "relative_viscosity", "relative_viscosity_pairwise"
Points = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
"""Places, values and errors, (n,) each."""

_DRAWN = {"krieger_dougherty": "solid", "krieger_dougherty_free": "dashdot", "quemada": "dot"}
_OFF = 1e3  # laws go to infinity
_WIDE = 10.0  # greatest over least viscosity, from which on the scale is logarithmic


def study_charts(study: xr.Dataset) -> list[Chart]:
    """What `tether.plot.draw_study` draws; empty where there is nothing to draw."""
    charts: list[Chart] = []
    first = _first_key(study)
    if is_known(study, _TOTAL):
        if direction(mean(study, "volume_fraction")) is not None or first is None:
            charts.append(_relative_chart(study))
        else:
            charts.append(_against(study, _TOTAL, first))
    if "shear_rate" in study and direction(abs(mean(study, "shear_rate"))) is not None:
        for quantity in ("viscosity", "N1", "N2"):
            if is_known(study, quantity):
                charts += _rate_charts(study, quantity)
    if not charts and first is not None:
        known = [name for name in ("viscosity", "pressure") if is_known(study, name)]
        charts += [_against(study, name, first) for name in known[:1]]
    return charts


def _relative_chart(study: xr.Dataset) -> Chart:
    """Discs: total stress; hollow: pairs alone; lines: the laws fitted to the viscosities themselves."""
    shown, remark = curves(study, direction(mean(study, "volume_fraction")), (_TOTAL, _PAIRWISE))
    dimension = int(study.attrs["dimension"])
    found = [_relative(curve, name) for curve in shown for name in (_TOTAL, _PAIRWISE) if is_known(curve.part, name)]
    end = min(1.08 * max(float(np.nanmax(phi)) for phi, *_ in found) or 0.1, 1.0)
    high = max(float(np.nanmax(value + np.nan_to_num(deviation))) for _, value, deviation in found)
    low = min(1.0, *(float(np.nanmin(value - np.nan_to_num(deviation))) for _, value, deviation in found))
    room = 0.08 * ((high - low) or 1.0)
    panel = Panel(
        f"Relative viscosity{remark}", Scale(_label(study, "volume_fraction"), ends=(0.0, end)),
        Scale(_label(study, _TOTAL), ends=(low - room, high + room)),
    )  # fmt: skip
    slope = suspension.intrinsic_viscosity(dimension)
    line = np.array([0.0, end])
    einstein = f"Einstein, 1 + {slope:g} \N{GREEK SMALL LETTER PHI}"
    panel.line(line, suspension.einstein(line, dimension), GRAY, einstein, dash="dash", width=1.2)
    for curve in shown:
        draw = _draw_alone if len(shown) == 1 else _draw_among_others
        draw(panel, curve, dimension, end)
    hollow = "Hollow: pairs alone. " if is_known(study, _PAIRWISE) else ""
    return panel.chart(f"{hollow}Laws are fitted to the viscosities and the plain fluid's, not to ratios.", wide=True)


def _draw_alone(panel: Panel, curve: Curve, dimension: int, end: float) -> None:
    """The only curve: all laws of the total stress, and Krieger and Dougherty's of the pairs alone."""
    for name, color, words, before, laws in (
        (_TOTAL, curve.color, "total stress", "", list(_DRAWN)),
        (_PAIRWISE, VERMILION, "pairs alone", "pairs alone, ", list(_DRAWN)[:1]),
    ):
        if is_known(curve.part, name):
            panel.points(*_relative(curve, name), color, words, size=8.0, hollow=name == _PAIRWISE)
            for found in _fits(curve, name, laws, dimension):
                _draw_fit(panel, found, end, color, f"{before}{LAWS[found.law].words}: {_parameters(found)}")


def _draw_among_others(panel: Panel, curve: Curve, dimension: int, end: float) -> None:
    """One color for all of it, and Krieger and Dougherty's law of the total stress."""
    fits = _fits(curve, _TOTAL, list(_DRAWN)[:1], dimension)
    words = of_formulas(curve.label)
    label = f"{words}: {_parameters(fits[0])}" if fits else words
    panel.points(*_relative(curve, _TOTAL), curve.color, label, size=8.0)
    if is_known(curve.part, _PAIRWISE):
        panel.points(*_relative(curve, _PAIRWISE), curve.color, size=8.0, hollow=True)
    for found in fits:
        _draw_fit(panel, found, end, curve.color, "")


def _relative(curve: Curve, name: str) -> Points:
    phi, value, deviation = points_of(
        mean(curve.part, "volume_fraction"), mean(curve.part, name), error(curve.part, name)
    )
    return phi, value, deviation


def _fits(curve: Curve, name: str, laws: list[str], dimension: int) -> list[Fit]:
    """Those of the laws that could be fitted."""
    measured = viscosities(curve, name.removeprefix("relative_"))
    return [found for found in (fit(law, *measured, dimension) for law in laws) if isinstance(found, Fit)]


def _draw_fit(panel: Panel, found: Fit, end: float, color: str, label: str) -> None:
    phi = np.linspace(0.0, end, 200)
    value = found.relative_viscosity(phi)
    inside = np.isfinite(value) & (value < _OFF)
    panel.line(phi[inside], value[inside], color, label, dash=_DRAWN[found.law], width=1.3)


def _parameters(found: Fit) -> str:
    """phi_m, [eta] where it was free, and a warning where the law does not describe the points."""
    words = f"\N{GREEK SMALL LETTER PHI}<sub>m</sub> = {told(found.parameters['maximum_packing'])}"
    if "intrinsic_viscosity" in found.parameters:
        words += f", [\N{GREEK SMALL LETTER ETA}] = {told(found.parameters['intrinsic_viscosity'])}"
    return f"{words} (fits badly, p < {SIGNIFICANCE:g})" if found.is_contradicted else words


def _rate_charts(study: xr.Dataset, quantity: str) -> list[Chart]:
    """A quantity over |shear rate| and, where there are bodies, over Pe; rest is not on the logarithmic scale."""
    places = rates_and_peclet(study)
    shown, remark = curves(study, direction(places["shear_rate"]), (quantity,))
    value = mean(study, quantity).values
    positive = value[np.isfinite(value) & (value > 0.0)]
    is_wide = quantity == "viscosity" and len(positive) == np.isfinite(value).sum()
    kind = "log" if is_wide and positive.max() > _WIDE * positive.min() else "linear"
    charts = []
    for name in places:
        x = Scale(_label(study, name, magnitude=name == "shear_rate"), "log")
        against = "Peclet number" if name == "peclet" else "shear rate"
        y = Scale(_label(study, quantity), "log") if kind == "log" else Scale(_label(study, quantity))
        panel = Panel(f"{_title(quantity)} against {against}{remark}", x, y)
        for curve in shown:
            _draw_against_rate(panel, curve, name, quantity)
        if quantity != "viscosity":
            panel.across(0.0, dash="solid", width=0.9)
        charts.append(
            panel.chart("Triangles: negative shear rate." if bool((mean(study, "shear_rate") < 0).any()) else "")
        )
    return charts


def _draw_against_rate(panel: Panel, curve: Curve, against: str, quantity: str) -> None:
    x = rates_and_peclet(curve.part).get(against)
    if x is None:
        return
    place, rate, value, deviation = points_of(
        x, mean(curve.part, "shear_rate"), mean(curve.part, quantity), error(curve.part, quantity)
    )
    for signed, marker in ((rate >= 0.0, "o"), (rate < 0.0, "v")):
        here = np.flatnonzero(signed & np.isfinite(value) & (place > 0.0))
        here = here[np.argsort(place[here], kind="stable")]
        if len(here):
            label = of_formulas(curve.label)
            panel.points(
                place[here], value[here], deviation[here], curve.color, label, marker=marker, size=7.0, joined=True
            )


def _against(study: xr.Dataset, quantity: str, key: str) -> Chart:
    shown, remark = curves(study, key, (quantity,))
    x = study[key]
    names = () if is_number(x) else tuple(value_in_words(each) for each in x.values.tolist())
    panel = Panel(f"{_title(quantity)}{remark}", Scale(_label(study, key), names=names), Scale(_label(study, quantity)))
    for curve in shown:
        place = mean(curve.part, key) if not names else xr.zeros_like(curve.part[key], dtype=float) + np.arange(x.size)
        at, value, deviation = points_of(place, mean(curve.part, quantity), error(curve.part, quantity))
        panel.points(at, value, deviation, curve.color, of_formulas(curve.label), size=7.0, joined=not names)
    return panel.chart(wide=True)


def _title(quantity: str) -> str:
    return of_formulas(quantity_in_words(quantity))


def _label(study: xr.Dataset, name: str, *, magnitude: bool = False) -> str:
    return of_formulas(axis_label(study, name, magnitude=magnitude))


def _first_key(study: xr.Dataset) -> str | None:
    """The first swept key that has more than one value, numbers before words."""
    varied = [key for key in swept_keys(study) if key in study.coords and len(np.unique(study[key].values)) > 1]
    return next((key for key in varied if is_number(study[key])), varied[0] if varied else None)
