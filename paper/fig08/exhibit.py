"""Fig. 8: relative viscosity of dilute suspensions, 2D

The paper finds eta_r = 1 + 2 phi (Einstein; in 2D Brady 1984) below phi = 2.5 %, with phi the particle fraction of eq.
43, for several masses of the constituents and several kT. It does not print the masses. At its rate of 0.01 and in its
200 000 steps, eta_r - 1 of a few per cent would drown in an error of several per cent: errors fall as one over the
rate. We shear at rate 1, at which the plain fluid and the suspension are both measured; lower rates are there to show
that the slope is the same. The slope [eta] is that of the least-squares line through the plain fluid and all phi below
2.5 %; masses share the plain fluid, and their covariance is kept. Pairwise is the stress of the paper's eq. 16, total
has the bodies' own (section 4.3 in ours).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tether.estimate import Estimate
from tether.paper import (
    COLORS,
    Claim,
    Comparison,
    Findings,
    Panel,
    Part,
    Series,
    judged,
    near,
)
from tether.paper.distributions import number
from tether.theory.suspension import einstein, intrinsic_viscosity

Array = NDArray[np.float64]

DILUTE = 0.025
"""The paper's "less than 2.5 %"."""

TOLERANCE = 0.2
"""Of the slope [eta] = 2: a tenth."""

KINDS = {"pairwise": "viscosity_pairwise", "total": "viscosity"}

RADII = {1.0: 0.3995, 0.5: 0.44, 0.25: 0.465}
"""Effective radius of a disc by kT, Table 1, length."""

MARKERS: tuple[Literal["o", "s", "^", "D"], ...] = ("o", "s", "^", "D")

CASE = ["temperature", "mass", "shear_rate"]


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Relative viscosities, the slopes, and whether they are Einstein's."""
    points = pd.concat([_points(part) for part in parts.values()], ignore_index=True)
    points = points.drop_duplicates(subset=[*CASE, "bodies"]).sort_values([*CASE, "bodies"], ignore_index=True)
    hours = sum(part.core_hours for part in parts.values())
    fits = {kind: slopes_of(points, kind) for kind in KINDS}
    claims = [claim for kind, found in fits.items() for claim in _claims(kind, found, hours)]
    claims += [_beyond(points, hours), _other_fraction(points, hours)]
    tables = {"points": points, "slopes": _table(fits)}
    return Findings(tables, claims)


def _points(part: Part) -> pd.DataFrame:
    """A row for each suspension: case, phi, viscosities of suspension and plain fluid, relative ones."""
    rows = []
    means = part.results.means
    for setting, ensemble in zip(part.study.settings, part.study.ensembles, strict=True):
        configuration = ensemble.configuration
        row: dict[str, float] = {
            "temperature": configuration.fluid.temperature,
            "mass": configuration.body_masses[0],
            "shear_rate": configuration.flow.shear_rate,
            "bodies": sum(configuration.body_counts),
        }
        found = means
        for name, value in setting.values.items():
            found = found[found[name] == value]
        if found.empty:
            continue
        row["volume"] = configuration.box.volume
        row["volume_fraction"] = float(found["volume_fraction"].iloc[0])
        for name in KINDS.values():
            for key in (name, f"plain_fluid_{name}", f"relative_{name}"):
                row[key], row[f"{key}_error"] = float(found[key].iloc[0]), float(found[f"{key}_error"].iloc[0])
        rows.append(row)
    return pd.DataFrame(rows)


class Slopes(NamedTuple):
    """[eta] of several cases with their covariance."""

    cases: list[tuple[float, float, float]]
    """kT, mass of a constituent, shear rate."""
    value: Array
    covariance: Array

    def estimate(self, index: int) -> Estimate:
        """One of them."""
        return number(float(self.value[index]), math.sqrt(float(self.covariance[index, index])))

    def difference(self, index: int, other: int) -> Estimate:
        """One of them less another."""
        of_both = self.covariance[np.ix_([index, other], [index, other])]
        variance = float(of_both[0, 0] + of_both[1, 1] - of_both[0, 1] - of_both[1, 0])
        return number(float(self.value[index] - self.value[other]), math.sqrt(variance))

    def where(self, chosen: Sequence[bool]) -> Slopes:
        """Some of them."""
        kept = np.flatnonzero(chosen)
        return Slopes([self.cases[k] for k in kept], self.value[kept], self.covariance[np.ix_(kept, kept)])

    def mean(self) -> Estimate:
        """The best common value; no value where nothing is known."""
        if not len(self.value) or not np.isfinite(self.covariance).all():
            return number(float(self.value.mean()) if len(self.value) else math.nan, math.nan)
        weight = np.linalg.solve(self.covariance, np.ones(len(self.value)))
        return number(float(weight @ self.value / weight.sum()), float(weight.sum() ** -0.5))


def slopes_of(points: pd.DataFrame, kind: str, fraction: str = "volume_fraction", limit: float = DILUTE) -> Slopes:
    """[eta] of every case below a volume fraction of `limit`, by least squares.

    Cases that have a plain fluid in common (kT and rate) are fitted together: eta = eta_0 + b_c phi of each case c
    with one eta_0, and [eta]_c = b_c/eta_0, with the errors of both.
    """
    dilute = points[points["volume_fraction"] < limit]
    cases: list[tuple[float, float, float]] = []
    values, blocks = [], []
    for (temperature, rate), group in dilute.groupby(["temperature", "shear_rate"]):
        masses = sorted(set(group["mass"]))
        value, covariance = _fitted(group, masses, KINDS[kind], fraction)
        cases += [(float(temperature), float(mass), float(rate)) for mass in masses]
        values.append(value)
        blocks.append(covariance)
    total = np.zeros((len(cases), len(cases)))
    at = 0
    for block in blocks:
        total[at : at + len(block), at : at + len(block)] = block
        at += len(block)
    return Slopes(cases, np.concatenate(values) if values else np.zeros(0), total)


def _fitted(group: pd.DataFrame, masses: Sequence[float], name: str, fraction: str) -> tuple[Array, Array]:
    plain = group[[f"plain_fluid_{name}", f"plain_fluid_{name}_error"]].iloc[0].to_numpy(dtype=np.float64)
    eta = np.concatenate([plain[:1], group[name].to_numpy(dtype=np.float64)])
    error = np.concatenate([plain[1:], group[f"{name}_error"].to_numpy(dtype=np.float64)])
    design = np.zeros((len(eta), 1 + len(masses)))
    design[:, 0] = 1.0
    for row, (mass, phi) in enumerate(zip(group["mass"], group[fraction], strict=True), start=1):
        design[row, 1 + masses.index(mass)] = phi
    known = np.isfinite(error).all()
    weight = 1.0 / error**2 if known else np.ones(len(eta))
    normal = np.linalg.inv(design.T @ (weight[:, None] * design))
    found = normal @ design.T @ (weight * eta)
    slope = found[1:] / found[0]
    # d[eta]_c = (d b_c - [eta]_c d eta_0) / eta_0
    change = np.column_stack([-slope, np.eye(len(masses))]) / found[0]
    covariance = change @ normal @ change.T
    return slope, covariance if known else np.full_like(covariance, math.nan)


# --- what the paper says ---


def _claims(kind: str, slopes: Slopes, hours: float) -> list[Claim]:
    expected = intrinsic_viscosity(2)
    highest = _highest_rate(slopes)
    each = [near(highest.estimate(k), expected, TOLERANCE, _case_words(case)) for k, case in enumerate(highest.cases)]
    everything = near(slopes.mean(), expected, TOLERANCE, "all cases")
    warm = highest.where([case[0] == 1.0 for case in highest.cases])
    own_mass = highest.where([case[1] == 1.0 for case in highest.cases])
    rates = slopes.where([case[:2] == (1.0, 1.0) for case in slopes.cases])
    return [
        judged(
            f"Einstein's relation holds below phi = 2.5 %, {kind} stress", "section 4.5, fig. 8",
            f"the slope is {expected:g} within {TOLERANCE:g}, in the mean and in every case at the highest rate",
            [everything, *each], hours,
        ),
        _alike(f"The mass of the constituents makes no difference, {kind} stress", "fig. 8, left", warm, "m", hours),
        _alike(f"kT makes no difference, {kind} stress", "fig. 8, right", own_mass, "kT", hours),
        _alike(f"The shear rate makes no difference, {kind} stress", "section 4.5", rates, "rate", hours),
    ]  # fmt: skip


def _highest_rate(slopes: Slopes) -> Slopes:
    """Those at the highest rate of all, whose errors are the smallest."""
    rate = max((case[2] for case in slopes.cases), default=math.nan)
    return slopes.where([case[2] == rate for case in slopes.cases])


def _alike(text: str, source: str, slopes: Slopes, varied: str, hours: float) -> Claim:
    """Whether slopes are one number: not that errors are too large to tell them apart, but that they are close.

    varied: the letter of what the cases differ in, "kT", "m" or "rate".
    """
    of = ("kT", "m", "rate").index(varied)
    comparisons = [
        near(slopes.difference(k, 0), 0.0, TOLERANCE, f"{varied} = {case[of]:g} less {slopes.cases[0][of]:g}")
        for k, case in enumerate(slopes.cases)
        if k > 0
    ]
    return judged(text, source, f"slopes differ by less than {TOLERANCE:g}", comparisons, hours)


def _case_words(case: tuple[float, float, float]) -> str:
    return f"kT = {case[0]:g}, m = {case[1]:g}"


def _beyond(points: pd.DataFrame, hours: float) -> Claim:
    """The paper's bound of 2.5 %: whether there is more than Einstein's at higher phi."""
    highest = points[(points["shear_rate"] == points["shear_rate"].max()) & (points["volume_fraction"] > DILUTE)]
    highest = highest[highest["volume_fraction"] == highest["volume_fraction"].max()]
    comparisons = []
    for _, row in highest.iterrows():
        excess = number(
            float(row["relative_viscosity_pairwise"]) - float(einstein(float(row["volume_fraction"]), 2)),
            float(row["relative_viscosity_pairwise_error"]),
        )
        case = (float(row["temperature"]), float(row["mass"]), float(row["shear_rate"]))
        words = f"{_case_words(case)}, phi = {row['volume_fraction']:.4f}"
        comparisons.append(Comparison(excess, low=0.0, name=words))
    return judged(
        "Einstein's relation is one for low volume fractions: below 2.5 %", "section 4.5",
        "at the largest phi here the relative viscosity (pairwise) less 1 + 2 phi is above 0", comparisons, hours,
    )  # fmt: skip


def _other_fraction(points: pd.DataFrame, hours: float) -> Claim:
    """[eta] with the area of discs of Table 1's radius for the volume fraction."""
    if points.empty:
        comparisons: list[Comparison] = []
    else:
        area = points["temperature"].map(lambda kT: math.pi * RADII[kT] ** 2)
        other = points.assign(area_fraction=points["bodies"] * area / points["volume"])
        found = _highest_rate(slopes_of(other, "pairwise", "area_fraction"))
        bound = intrinsic_viscosity(2) + TOLERANCE
        comparisons = [
            Comparison(found.estimate(k), low=bound, name=_case_words(case)) for k, case in enumerate(found.cases)
        ]
    return judged(
        "Only with the volume fraction of eq. 43 is Einstein's relation recovered", "section 4.5",
        f"with the area of discs of Table 1's radius the slope (pairwise) is above {2 + TOLERANCE:g}",
        comparisons, hours,
    )  # fmt: skip


# --- tables and pictures ---


def _table(fits: Mapping[str, Slopes]) -> pd.DataFrame:
    rows = []
    for kind, slopes in fits.items():
        for k, case in enumerate(slopes.cases):
            each = slopes.estimate(k)
            rows.append((kind, *case, each.value, each.error))
        mean = slopes.mean()
        rows.append((kind, math.nan, math.nan, math.nan, mean.value, mean.error))
    return pd.DataFrame(rows, columns=["stress", *CASE, "intrinsic_viscosity", "intrinsic_viscosity_error"])


def panels(findings: Findings) -> list[Panel]:
    """The paper's two panels, pairwise, and the same with the total stress below."""
    points = findings.tables["points"]
    if points.empty:
        return []
    points = points[points["shear_rate"] == points["shear_rate"].max()]
    panels = []
    for kind, name in KINDS.items():
        for title, words, column, chosen in (
            ("masses of the constituents", "$m$", "mass", points[points["temperature"] == 1.0]),
            ("temperatures", "$kT$", "temperature", points[points["mass"] == 1.0]),
        ):
            panels.append(
                Panel(
                    f"{kind.capitalize()} stress, {title}", r"volume fraction $\phi$", r"relative viscosity $\eta_r$",
                    [_einstein(points), *_series(chosen, words, column, f"relative_{name}")],
                )
            )  # fmt: skip
    return panels


def _einstein(points: pd.DataFrame) -> Series:
    phi = np.linspace(0.0, float(points["volume_fraction"].max()), 30)
    return Series(r"$1 + 2\phi$", phi, einstein(phi, 2), kind="line", color="#6E6E6E")


def _series(points: pd.DataFrame, words: str, column: str, name: str) -> list[Series]:
    shown = []
    for color, marker, value in zip(COLORS, MARKERS, sorted(set(points[column])), strict=False):
        rows = points[points[column] == value]
        phi, eta, error = (rows[key].to_numpy() for key in ("volume_fraction", name, f"{name}_error"))
        shown.append(Series(f"{words} = {value:g}", phi, eta, error, color=color, marker=marker))
    return shown
