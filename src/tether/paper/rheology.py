"""Rheology: what figures 10 to 15 have in common, from the tables of studies to numbers that claims are judged by.

Relative viscosities are over one viscosity of the solvent for each temperature, as the paper's are, and not over that
of a plain fluid at the same shear rate: below a rate of 1 the solvent is Newtonian, and the viscosity that is known
best is that of the fastest flow that does not heat it yet.

The paper's axes have the velocity gradient along z, ours along y: N1 = S_xx - S_yy and N2 = S_yy - S_zz here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from tether.analysis.packing import Fit, fit
from tether.estimate import Estimate, estimate
from tether.paper.exhibit import Part
from tether.paper.numbers import mean, number
from tether.paper.panel import COLORS, Panel, Series

QUANTITIES = {"": "total stress", "_pairwise": "pairs alone, eq. 16"}
"""Endings of the columns of a viscosity, and what it is of."""

HELD = 0.05
"""A temperature is held where it is off by no more than this part of kT: hotter, it is another fluid."""

NEWTONIAN = 1.0
"""Shear rate up to which plain fluids count for the solvent's viscosity: it heats by 1 % there."""

_MARKERS: tuple[Literal["o", "s", "^", "D", "v"], ...] = ("o", "s", "^", "D", "v")

Array = NDArray[np.float64]
Solvents = Mapping[float, Estimate]


def weighted_mean(values: ArrayLike, errors: ArrayLike) -> Estimate:
    """The mean of independent numbers by 1/error^2, of those that have an error; else the plain mean without one."""
    value, error = np.asarray(values, dtype=np.float64), np.asarray(errors, dtype=np.float64)
    usable = np.isfinite(value) & np.isfinite(error) & (error > 0)
    if not usable.any():
        there = value[np.isfinite(value)]
        return number(there.mean() if len(there) else math.nan, math.nan)
    weight = 1.0 / error[usable] ** 2
    return number(weight @ value[usable] / weight.sum(), weight.sum() ** -0.5)


def _temperatures(part: Part) -> pd.Series:
    """kT of each setting that has been run: swept, or the same for all."""
    means = part.results.means
    if "fluid.temperature" in means:
        return means["fluid.temperature"].astype(float)
    return pd.Series(part.study.ensembles[0].configuration.fluid.temperature, means.index)


def plain_table(part: Part) -> pd.DataFrame:
    """The solvent alone: viscosity, pressure, temperature and normal stresses at each kT and shear rate."""
    means = part.results.means
    table = pd.DataFrame({"kT": _temperatures(part), "shear_rate": means["shear_rate"]})
    names = ["viscosity", "pressure", "temperature_all", "N1", "N2"]
    for name in [name for name in names if name in means]:
        table[name], table[f"{name}_error"] = means[name], means[f"{name}_error"]
    return table


def solvents_of(plain: Part) -> dict[float, Estimate]:
    """The viscosity of the solvent by its temperature, from all rates up to NEWTONIAN."""
    table = plain_table(plain)
    slow = table[table["shear_rate"] <= NEWTONIAN]
    return {float(kt): weighted_mean(rows["viscosity"], rows["viscosity_error"]) for kt, rows in slow.groupby("kT")}


def viscosity_table(part: Part, solvents: Solvents) -> pd.DataFrame:
    """A row for each volume fraction and shear rate: relative viscosities, total and pairwise, and the temperature.

    Errors of relative viscosities hold that of the solvent's viscosity, which all rows of one kT share.
    """
    means = part.results.means
    table = pd.DataFrame({"kT": _temperatures(part)})
    for name in ("volume_fraction", "shear_rate", "peclet", "steps"):
        table[name] = means[name]
    solvent = np.array([solvents[kt].value for kt in table["kT"]])
    share = np.array([solvents[kt].relative_error for kt in table["kT"]])
    for end in QUANTITIES:
        value, error = means[f"viscosity{end}"], means[f"viscosity{end}_error"]
        table[f"relative_viscosity{end}"] = value / solvent
        table[f"relative_viscosity{end}_error"] = np.hypot(error / value, share) * value / solvent
        table[f"viscosity{end}"], table[f"viscosity{end}_error"] = value, error
    table["temperature"], table["temperature_error"] = means["temperature_all"], means["temperature_all_error"]
    return table.sort_values(["kT", "volume_fraction", "shear_rate"], ignore_index=True)


def relative(row: pd.Series, end: str = "") -> Estimate:
    """The relative viscosity of a row. end: one of QUANTITIES."""
    return number(row[f"relative_viscosity{end}"], row[f"relative_viscosity{end}_error"])


def is_held(table: pd.DataFrame) -> pd.Series:
    """Whether the temperature of each row is within HELD of kT."""
    return (table["temperature"] / table["kT"] - 1.0).abs() <= HELD


def lowest(table: pd.DataFrame) -> pd.DataFrame:
    """The row of the lowest shear rate for each kT and volume fraction."""
    return table.loc[table.groupby(["kT", "volume_fraction"])["shear_rate"].idxmin()]


# --- how the viscosity goes with the volume fraction ---


def fits_table(slowest: pd.DataFrame, solvents: Solvents, dimension: int) -> pd.DataFrame:
    """Laws fitted to the viscosities at the lowest rates and the solvent's, for each kT, total and pairwise.

    Rows: kT, quantity, law ("krieger_dougherty": exponent [eta] phi_m with [eta] = (d + 2)/2; "free": both free;
    "quemada": exponent 2), maximum_packing, exponent, intrinsic_viscosity, errors, chi_square, degrees_of_freedom.
    """
    rows = []
    for kt, part in slowest.groupby("kT"):
        solvent = solvents[float(kt)]
        for end in QUANTITIES:
            phi = np.append(part["volume_fraction"], 0.0)
            value = np.append(part[f"viscosity{end}"], solvent.value)
            error = np.append(part[f"viscosity{end}_error"], solvent.error)
            for law in ("krieger_dougherty", "krieger_dougherty_free", "quemada"):
                found = fit(law, phi, value, error, dimension)
                row = {"kT": kt, "quantity": end.strip("_") or "total", "law": law, "dimension": dimension}
                rows.append({**row, **_parameters(found, phi, value, error)})
    columns = ["kT", "quantity", "law", "dimension", *_parameters(None, *np.zeros((3, 1)))]
    return pd.DataFrame(rows, columns=columns)


def fitted(fits: pd.DataFrame, kt: float, quantity: str, law: str, name: str) -> Estimate:
    """A parameter of a fit, nan where there is none. quantity: an end of QUANTITIES."""
    rows = fits[(fits["kT"] == kt) & (fits["quantity"] == (quantity.strip("_") or "total")) & (fits["law"] == law)]
    if not len(rows):
        return number(math.nan, math.nan)
    row = rows.iloc[0]
    # A law that does not describe the points has parameters whose errors say too little: scaled up (Particle Data
    # Group, Phys. Rev. D 110, 030001 (2024), sec. 5.2.2).
    scale = math.sqrt(max(1.0, row["chi_square"] / max(1.0, row["degrees_of_freedom"])))
    return number(row[name], row[f"{name}_error"] * scale)


def _parameters(found: object, phi: Array, value: Array, error: Array) -> dict[str, float]:
    names = ("maximum_packing", "exponent", "intrinsic_viscosity")
    row = {key: math.nan for name in names for key in (name, f"{name}_error")}
    row |= {"chi_square": math.nan, "degrees_of_freedom": math.nan}
    if not isinstance(found, Fit):
        return row
    for name in ("maximum_packing", "intrinsic_viscosity"):
        if name in found.parameters:
            row[name], row[f"{name}_error"] = found.parameters[name].value, found.parameters[name].error
    if found.law == "krieger_dougherty_free":
        exponent = _exponent(found, phi, value, error)
        row["exponent"], row["exponent_error"] = exponent.value, exponent.error
    return row | {"chi_square": found.chi_square, "degrees_of_freedom": float(found.degrees_of_freedom)}


def _exponent(found: Fit, phi: Array, value: Array, error: Array) -> Estimate:
    """x of eta_0 (1 - phi/phi_m)^-x, with the error that its correlation with phi_m leaves it."""
    eta, packing, slope = (found.parameters[name].value for name in found.parameters)
    x = slope * packing
    room = 1.0 - phi / packing
    curve = eta * room**-x
    slopes = np.stack([curve / eta, -x * curve / room * phi / packing**2, -curve * np.log(room)])
    usable = np.isfinite(value) & np.isfinite(error) & (error > 0)
    weighted = slopes[:, usable] / error[usable]
    covariance = np.linalg.pinv(weighted @ weighted.T)
    return number(x, math.sqrt(covariance[2, 2]))


# --- how it goes with the shear rate ---


def power_law(table: pd.DataFrame, end: str, low: float, high: float) -> Estimate:
    """p of eta_r = c Pe^p by weighted least squares over low <= Pe <= high; nan for fewer than three points.

    The solvent's viscosity is in c. Where the points do not lie on a power law the error is larger by the root of
    chi-square over degrees of freedom.
    """
    inside = table[(table["peclet"] >= low) & (table["peclet"] <= high)]
    value, error = inside[f"viscosity{end}"].to_numpy(float), inside[f"viscosity{end}_error"].to_numpy(float)
    usable = np.isfinite(error) & (error > 0) & (value > 0)
    if usable.sum() < 3:
        return number(math.nan, math.nan)
    x, y = np.log(inside["peclet"].to_numpy(float)[usable]), np.log(value[usable])
    weight = (value[usable] / error[usable]) ** 2
    center = weight @ x / weight.sum()
    spread = weight @ (x - center) ** 2
    slope = float(weight @ ((x - center) * y) / spread)
    deviation = y - weight @ y / weight.sum() - slope * (x - center)
    scale = max(1.0, float(weight @ deviation**2) / (len(x) - 2))
    return number(slope, math.sqrt(scale / spread))


def exponents_table(table: pd.DataFrame, low: float, high: float) -> pd.DataFrame:
    """The exponent of shear thinning of each kT and volume fraction, total and pairwise, over a range of Pe."""
    rows = []
    for (kt, fraction), part in table[is_held(table)].groupby(["kT", "volume_fraction"]):
        row = {"kT": kt, "volume_fraction": fraction, "lowest_peclet": low, "highest_peclet": high}
        for end in QUANTITIES:
            found = power_law(part, end, low, high)
            row[f"exponent{end}"], row[f"exponent{end}_error"] = found.value, found.error
        rows.append(row)
    return pd.DataFrame(rows)


# --- normal stress differences ---


def normal_stress_table(part: Part, solvents: Solvents, plain: pd.DataFrame) -> pd.DataFrame:
    """A row for each volume fraction and shear rate: N1 and N2 over eta_s rate, of the total stress, of the pairs alone
    (eq. 16), and N1 and N2 of the solvent alone at that rate over the same."""
    means = part.results.means
    kt = float(_temperatures(part).iloc[0])
    series = _pairwise_normal_stresses(part)
    rows = []
    for _, run in means.iterrows():
        rate, fraction = float(run["shear_rate"]), float(run["volume_fraction"])
        scale = solvents[kt] * rate
        row = {"kT": kt, "volume_fraction": fraction, "shear_rate": rate, "peclet": run["peclet"]}
        alone = plain[(plain["kT"] == kt) & np.isclose(plain["shear_rate"], rate)]
        for name in ("N1", "N2"):
            total = number(run[name], run[f"{name}_error"]) / scale
            pairs = series[fraction, rate][name] / scale
            row |= {name: total.value, f"{name}_error": total.error}
            row |= {f"{name}_pairwise": pairs.value, f"{name}_pairwise_error": pairs.error}
            own = number(alone[name].iloc[0], alone[f"{name}_error"].iloc[0]) / scale if len(alone) else None
            row |= {f"{name}_solvent": own.value if own else math.nan}
            row |= {f"{name}_solvent_error": own.error if own else math.nan}
        rows.append({**row, "temperature": run["temperature_all"], "temperature_error": run["temperature_all_error"]})
    return pd.DataFrame(rows).sort_values(["kT", "volume_fraction", "shear_rate"], ignore_index=True)


def _pairwise_normal_stresses(part: Part) -> dict[tuple[float, float], dict[str, Estimate]]:
    """N1 and N2 without the bodies' own stress, by volume fraction and shear rate."""
    found: dict[tuple[float, float], dict[str, list[Estimate]]] = {}
    for _, record in part.records:
        summary = record.summary()
        key = (float(summary["particles"]["volume_fraction"]), float(summary["shear_rate"]))
        series = record.series()
        pairs = [series[f"stress_{name}"].to_numpy() for name in ("kinetic", "conservative", "dissipative")]
        stress = np.sum(pairs, axis=0)
        entry = found.setdefault(key, {"N1": [], "N2": []})
        entry["N1"].append(estimate(stress[:, 0, 0] - stress[:, 1, 1]))
        entry["N2"].append(estimate(stress[:, 1, 1] - stress[:, 2, 2]))
    return {key: {name: mean(each) for name, each in entry.items()} for key, entry in found.items()}


def zero_crossing(peclet: ArrayLike, values: ArrayLike, errors: ArrayLike) -> Estimate:
    """log10 of the Pe at which a quantity turns from positive to negative: between the last significantly positive
    point (by two errors) and the first significantly negative one after it, where a straight line in log Pe through
    all points from the one to the other is zero. nan where there is no such pair."""
    pe, value, error = (np.asarray(each, dtype=np.float64) for each in (peclet, values, errors))
    usable = np.isfinite(value) & np.isfinite(error) & (error > 0) & (pe > 0)
    order = np.argsort(pe[usable])
    x, y, e = np.log10(pe[usable][order]), value[usable][order], error[usable][order]
    positive = np.flatnonzero(y > 2 * e)
    if not len(positive):
        return number(math.nan, math.nan)
    last = positive[-1]
    negative = np.flatnonzero((y < -2 * e) & (np.arange(len(y)) > last))
    if not len(negative):
        return number(math.nan, math.nan)
    x, y, w = x[last : negative[0] + 1], y[last : negative[0] + 1], 1 / e[last : negative[0] + 1] ** 2
    center, level = w @ x / w.sum(), w @ y / w.sum()
    spread = w @ (x - center) ** 2
    slope = w @ ((x - center) * y) / spread
    place = center - level / slope
    # The line is an interpolation: the width of what it bridges is part of what is not known.
    statistical = math.sqrt(1 / w.sum() + (place - center) ** 2 / spread) / abs(slope)
    return number(place, math.hypot(statistical, (x[-1] - x[0]) / 6.0))


# --- pictures ---


def look(place: int) -> tuple[str, Literal["o", "s", "^", "D", "v"]]:
    """Color and marker of the n-th curve of a family, from 0: twice six colors are told apart by their markers."""
    return COLORS[place % len(COLORS)], _MARKERS[place // len(COLORS)]


def against_peclet(table: pd.DataFrame) -> list[Panel]:
    """A panel for each kT: relative viscosities against Pe, filled of the total stress, hollow of the pairs alone."""
    panels = []
    for kt, part in table.groupby("kT", sort=False):
        series = []
        for place, (fraction, rows) in enumerate(part.groupby("volume_fraction")):
            color, marker = look(place)
            for end, hollow in (("", False), ("_pairwise", True)):
                name = f"relative_viscosity{end}"
                label = "" if hollow else rf"$\phi$ = {fraction:.4f}"
                x, y, error = rows["peclet"], rows[name], rows[f"{name}_error"]
                series.append(Series(label, x, y, error, color=color, marker=marker, hollow=hollow))
        panels.append(
            Panel(
                f"kT = {kt:g} (hollow: pairs alone, eq. 16)",
                "Pe",
                r"relative viscosity $\eta_r$",
                series,
                log_x=True,
            )
        )
    return panels


def normal_stress_panels(table: pd.DataFrame) -> list[Panel]:
    """N1 and N2 over eta_s rate against Pe: filled of the total stress, hollow of the pairs, dashed the solvent's."""
    panels = []
    for name, symbol in (("N1", "N_1"), ("N2", "N_2")):
        series = []
        for place, (fraction, rows) in enumerate(table.groupby("volume_fraction")):
            color, marker = look(place)
            for end, hollow in (("", False), ("_pairwise", True)):
                label = "" if hollow else rf"$\phi$ = {fraction:.4f}"
                column = f"{name}{end}"
                x, y, error = rows["peclet"], rows[column], rows[f"{column}_error"]
                series.append(Series(label, x, y, error, color=color, marker=marker, hollow=hollow))
        alone = table.drop_duplicates("peclet").dropna(subset=[f"{name}_solvent"]).sort_values("peclet")
        if len(alone):
            series.append(
                Series("solvent alone", alone["peclet"], alone[f"{name}_solvent"], kind="dashed", color="#6E6E6E")
            )
        title = f"kT = {table['kT'].iloc[0]:g} (hollow: pairs alone, eq. 16)"
        label = rf"${symbol}/\eta_s\dot\gamma$"
        panels.append(Panel(title, "Pe", label, series, log_x=True, levels=[(0.0, "")], y_range=_seen(table, name)))
    return panels


def _seen(table: pd.DataFrame, name: str) -> tuple[float, float] | None:
    """Limits that hold all points that are known to better than 0.5, which those of the lowest rates are not."""
    ends = []
    for end in QUANTITIES:
        value, error = table[f"{name}{end}"], table[f"{name}{end}_error"]
        good = value[(error < 0.5) & value.notna()]
        ends += [good.min(), good.max()] if len(good) else []
    if not ends or not max(ends) > min(ends):
        return None
    room = 0.3 * (max(ends) - min(ends))
    return min(*ends, 0.0) - room, max(*ends, 0.0) + room
