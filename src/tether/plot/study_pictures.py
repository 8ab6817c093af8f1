"""All pictures of a study, and the laws fitted to its viscosities."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from tether.analysis.packing import LAWS, Fit, NoFit, fit_all
from tether.errors import InputError
from tether.plot.against import plot_against
from tether.plot.flow_curve import plot_flow_curve
from tether.plot.normal_stress import plot_normal_stress
from tether.plot.relative_curve import plot_relative_curve, viscosities
from tether.plot.sweep import all_curves, direction, is_known, is_number, mean, swept_keys

_PARAMETERS = ("viscosity_at_zero", "maximum_packing", "intrinsic_viscosity", "second_order")


def draw_study(study: xr.Dataset, folder: Path) -> list[Path]:
    """Draw whatever there is to draw into a folder that exists, and return the paths.

    relative_viscosity: against the volume fraction or, where that is the same everywhere, the first swept key;
    flow_curve and normal_stress where the magnitude of the shear rate varies. If none of these can be drawn, viscosity
    or else pressure against the first swept key that has numbers. Raises InputError when there is nothing to draw.
    """
    drawn: list[Path] = []
    first = _first_key(study)
    if is_known(study, "relative_viscosity"):
        if direction(mean(study, "volume_fraction")) is not None or first is None:
            drawn += plot_relative_curve(study, folder / "relative_viscosity")
        else:
            drawn += plot_against(study, "relative_viscosity", first, folder / "relative_viscosity")
    if "shear_rate" in study and direction(abs(mean(study, "shear_rate"))) is not None:
        if is_known(study, "viscosity"):
            drawn += plot_flow_curve(study, folder / "flow_curve")
        if is_known(study, "N1"):
            drawn += plot_normal_stress(study, folder / "normal_stress")
    if drawn:
        return drawn
    quantity = next((name for name in ("viscosity", "pressure") if is_known(study, name)), None)
    if quantity is None or first is None:
        why = "no run of it has ended" if quantity is None else "no key with numbers for values is swept"
        remedy = "run it first" if quantity is None else "sweep a key that has numbers, flow.shear_rate for example"
        raise InputError("the study has nothing to draw", why, remedy)
    return plot_against(study, quantity, first, folder / quantity)


def fits_of(study: xr.Dataset) -> list[dict[str, Any]]:
    """The laws of `tether.analysis.packing` fitted along the volume fraction; one row for each law that was tried.

    For each combination of the other swept keys, of the viscosity and of viscosity_pairwise if there is one. A row
    has the other keys' values by their dotted names; quantity; law; points; each parameter and its error, as
    viscosity_at_zero (DPD units), maximum_packing, intrinsic_viscosity, second_order, and these with _error, nan where
    the law has no such parameter; chi_square, degrees_of_freedom, p_value, nan where they are not known; remark: why
    there is no fit, or that the law does not describe the points, or nothing. The list is empty where the volume
    fraction is the same everywhere. All rows have the same names.
    """
    if "volume_fraction" not in study:
        return []
    along = direction(mean(study, "volume_fraction"))
    if along is None:
        return []
    dimension = int(study.attrs["dimension"])
    rows = []
    for curve in all_curves(study, along):
        for quantity in ("viscosity", "viscosity_pairwise"):
            if is_known(curve.part, quantity):
                fits = fit_all(*viscosities(curve, quantity), dimension)
                rows += [{**curve.values, "quantity": quantity, **_row(each)} for each in fits]
    return rows


def _row(each: Fit | NoFit) -> dict[str, Any]:
    row: dict[str, Any] = {"law": each.law, "points": each.points}
    found = each.parameters if isinstance(each, Fit) else {}
    for name in _PARAMETERS:
        row[name] = found[name].value if name in found else math.nan
        row[f"{name}_error"] = found[name].error if name in found else math.nan
    if isinstance(each, NoFit):
        nothing = {"chi_square": math.nan, "degrees_of_freedom": math.nan, "p_value": math.nan}
        return {**row, **nothing, "remark": each.reason}
    remark = f"{LAWS[each.law].words} does not describe the points" if each.is_contradicted else ""
    row |= {"chi_square": each.chi_square, "degrees_of_freedom": each.degrees_of_freedom}
    return {**row, "p_value": each.p_value, "remark": remark}


def _first_key(study: xr.Dataset) -> str | None:
    """The first swept key that has more than one value, all of them numbers."""
    for key in swept_keys(study):
        if key in study.coords and is_number(study[key]) and len(np.unique(study[key].values)) > 1:
            return key
    return None
