"""What the paper says of figures 10 to 15, judged from the tables of `tether.paper.rheology`."""

from __future__ import annotations

import math
from dataclasses import replace

import pandas as pd

from tether.estimate import Estimate
from tether.paper.claim import Claim, Comparison, judged, near
from tether.paper.numbers import number
from tether.paper.rheology import HELD, QUANTITIES, fitted, is_held, relative, weighted_mean, zero_crossing
from tether.theory import suspension

PACKING_TOLERANCE = 0.04
"""Of a maximum packing: the paper tells 0.91 from 0.87."""

LOW_PECLET = 5.0
"""Below it normal stresses are those of low Pe; the paper has N1 change its sign at the order of 10."""

HIGH_PECLET = 30.0
"""Above it they are those of high Pe."""


def of_law(
    slowest: pd.DataFrame, kt: float, dimension: int, tolerance: float, greatest: float, source: str, hours: float
) -> list[Claim]:
    """Agreement with Krieger and Dougherty's law, pairwise and total, up to a volume fraction."""
    packing = suspension.MAXIMUM_PACKING[dimension]
    rows = slowest[(slowest["kT"] == kt) & (slowest["volume_fraction"] <= greatest)]
    claims = []
    for end, words in reversed(QUANTITIES.items()):
        comparisons = []
        for _, row in rows.iterrows():
            phi = row["volume_fraction"]
            law = suspension.krieger_dougherty(phi, dimension, packing)
            comparisons.append(near(relative(row, end), law, tolerance * law, f"eta_r({phi:.4f})"))
        claim = judged(
            f"At kT = {kt:g} relative viscosities agree with Krieger and Dougherty's law with phi_m = {packing:g} "
            f"(here: {words}; phi up to {greatest:g})",
            source,
            f"every one within {tolerance:.0%} of the law",
            comparisons,
            hours,
        )
        claims.append(_and(claim, _largest_deviation(rows, end, dimension, packing)) if len(rows) else claim)
    return claims


def _and(claim: Claim, measured: str) -> Claim:
    """The claim with one more thing that was measured."""
    return replace(claim, measured=f"{claim.measured}; {measured}")


def _largest_deviation(rows: pd.DataFrame, end: str, dimension: int, packing: float) -> str:
    laws = suspension.krieger_dougherty(rows["volume_fraction"].to_numpy(float), dimension, packing)
    off = (rows[f"relative_viscosity{end}"] / laws - 1.0).to_numpy()
    worst = int(abs(off).argmax())
    fraction = rows["volume_fraction"].iloc[worst]
    return f"off by {100 * off[worst]:+.1f} % at most, at phi = {fraction:.4f}"


def of_packing(fits: pd.DataFrame, dimension: int, source: str, hours: float) -> list[Claim]:
    """The maximum packing: its value at kT = 1, and that it falls with kT."""
    expected = suspension.MAXIMUM_PACKING[dimension]
    claims = []
    for end, words in reversed(QUANTITIES.items()):
        warm, cold = (fitted(fits, kt, end, "krieger_dougherty", "maximum_packing") for kt in (1.0, 0.5))
        rule = "phi_m of Krieger and Dougherty's law, intrinsic viscosity (d + 2)/2, fitted to the viscosities"
        claims.append(
            judged(
                f"The effective maximum packing at kT = 1 is {expected:g} ({words})", source,
                f"{rule}, within {PACKING_TOLERANCE} of it",
                [near(warm, expected, PACKING_TOLERANCE, "phi_m")], hours,
            )
        )  # fmt: skip
        falls = judged(
                f"The effective maximum packing falls as kT is reduced from 1 to 0.5 ({words})", source,
                f"{rule}, is smaller at kT = 0.5",
                [Comparison(warm - cold, low=0.0, name="phi_m(kT = 1) - phi_m(kT = 0.5)")], hours,
            )  # fmt: skip
        claims.append(_and(falls, f"phi_m = {warm} at kT = 1, {cold} at kT = 0.5"))
    return claims


def of_exponent(fits: pd.DataFrame, kt: float, source: str, hours: float) -> list[Claim]:
    """Quemada's exponent."""
    return [
        judged(
            f"Quemada's relation describes them too: the exponent is about 2 (kT = {kt:g}, "
            f"{words})", source,
            "exponent of (1 - phi/phi_m)^-x, phi_m and x free, within 0.3 of 2",
            [near(fitted(fits, kt, end, "krieger_dougherty_free", "exponent"), 2.0, 0.3, "x")], hours,
        )
        for end, words in reversed(QUANTITIES.items())
    ]  # fmt: skip


# --- shear thinning ---


def of_thinning(table: pd.DataFrame, exponents: pd.DataFrame, low: float, high: float, source: str,
                hours: float) -> list[Claim]:  # fmt: skip
    """It thins, and the more so the lower kT."""
    claims = []
    held = table[is_held(table)]
    for end, words in reversed(QUANTITIES.items()):
        drops = []
        for (kt, fraction), rows in held[held["volume_fraction"] >= 0.3].groupby(["kT", "volume_fraction"]):
            first, last = rows.loc[rows["shear_rate"].idxmin()], rows.loc[rows["shear_rate"].idxmax()]
            if first["shear_rate"] < last["shear_rate"]:
                fall = _viscosity(first, end) / _viscosity(last, end)
                drops.append(Comparison(fall, low=1.0, name=f"fall(kT = {kt:g}, phi = {fraction:.4f})"))
        claims.append(
            judged(
                f"The suspensions are shear-thinning (phi > 0.3, {words})", source,
                "viscosity at the lowest rate over that at the highest at which the temperature is held within "
                f"{HELD:.0%} "
                "is greater than 1", drops, hours,
            )
        )  # fmt: skip
        differences = _differences(exponents, end)
        claims.append(
            judged(
                f"Shear thinning is stronger at lower kT (phi > 0.4, {words})", source,
                f"exponent p of eta_r = c Pe^p, fitted over {low:g} <= Pe <= {high:g}, is more negative at kT = 0.5 "
                "than "
                "at kT = 1",
                differences, hours,
            )
        )  # fmt: skip
    return claims


def _differences(exponents: pd.DataFrame, end: str) -> list[Comparison]:
    found = []
    if len(exponents):
        for fraction, rows in exponents[exponents["volume_fraction"] >= 0.4].groupby("volume_fraction"):
            by_kt = {
                row["kT"]: number(row[f"exponent{end}"], row[f"exponent{end}_error"]) for _, row in rows.iterrows()
            }
            if {0.5, 1.0} <= by_kt.keys():
                difference = by_kt[0.5] - by_kt[1.0]
                found.append(Comparison(difference, high=0.0, name=f"p(0.5) - p(1) at phi = {fraction:.4f}"))
    return found


def of_power_law(cold: dict[str, Estimate], printed: float, words: str, source: str, rule: str,
                 hours: float) -> list[Claim]:  # fmt: skip
    """The exponent that the paper prints. cold: by the ends of QUANTITIES."""
    return [
        judged(f"{words} ({of})", source, rule, [near(cold[end], printed, 0.05, "p")], hours)
        for end, of in reversed(QUANTITIES.items())
    ]


def of_plateau(table: pd.DataFrame, source: str, hours: float, greatest: float = 1.0) -> list[Claim]:
    """At the lowest rate shear-rate dependence is of no concern."""
    claims = []
    for kt, part in table.groupby("kT", sort=False):
        ratios = []
        for fraction, rows in part[part["volume_fraction"] <= greatest].groupby("volume_fraction"):
            first = rows.sort_values("shear_rate").iloc[:2]
            if len(first) == 2 and fraction >= 0.3:
                ratio = _viscosity(first.iloc[0], "") / _viscosity(first.iloc[1], "")
                times = first["shear_rate"].iloc[1] / first["shear_rate"].iloc[0]
                ratios.append(near(ratio, 1.0, 0.05, f"eta(lowest)/eta({times:.3g} times that), phi = {fraction:.4f}"))
        claims.append(
            judged(
                f"At the lowest shear rate its effect on the viscosity is of no concern (kT = {kt:g}, phi > 0.3, total "
                "stress)", source, "at the next higher rate the viscosity is the same within 5 %", ratios, hours,
            )
        )  # fmt: skip
    return claims


def of_temperature(table: pd.DataFrame, source: str, hours: float) -> Claim:
    """It is better held at low Pe."""
    comparisons, highest = [], []
    for (kt, fraction), rows in table.groupby(["kT", "volume_fraction"]):
        first, last = rows.loc[rows["shear_rate"].idxmin()], rows.loc[rows["shear_rate"].idxmax()]
        rise = number(last["temperature"], last["temperature_error"]) - number(
            first["temperature"], first["temperature_error"]
        )
        comparisons.append(Comparison(rise * (1.0 / kt), low=0.0, name=f"rise(kT = {kt:g}, phi = {fraction:.4f})"))
        highest.append((last["temperature"] / kt - 1.0, kt, last["shear_rate"]))
    claim = judged(
        "For a given time step the temperature is better held at low Pe", source,
        "T/kT at the highest shear rate minus that at the lowest is positive", comparisons, hours,
    )  # fmt: skip
    off, kt, rate = max(highest)
    held = table[is_held(table)]["shear_rate"].max()
    return claim.with_remark(
        f"at rate {rate:g} the fluid is {100 * off:.0f} % too hot (kT = {kt:g}); it is held within {HELD:.0%} up to "
        "rate "
        f"{held:g}"
    )


def of_errors(table: pd.DataFrame, source: str, hours: float) -> Claim:
    """Deviations are small at high Pe and large at low Pe, and so the solution converges faster at high Pe."""
    comparisons = []
    for (kt, fraction), rows in table.groupby(["kT", "volume_fraction"]):
        first, last = rows.loc[rows["shear_rate"].idxmin()], rows.loc[rows["shear_rate"].idxmax()]
        if not first["shear_rate"] < last["shear_rate"]:
            continue
        noise = [row["viscosity_error"] / row["viscosity"] * math.sqrt(row["steps"]) for row in (first, last)]
        ratio = noise[0] / noise[1]
        # An error is itself known to about a fifth.
        comparisons.append(
            Comparison(number(ratio, 0.3 * ratio), low=1.0, name=f"ratio(kT = {kt:g}, phi = {fraction:.4f})")
        )
    return judged(
        "Deviations are small at high Pe and large at low Pe; the solution converges faster at high Pe", source,
        "relative error of the viscosity of equally long runs, lowest over highest rate, is above 1 (its own error "
        "taken "
        "as 30 %)", comparisons, hours,
    )  # fmt: skip


def _viscosity(row: pd.Series, end: str) -> Estimate:
    return number(row[f"viscosity{end}"], row[f"viscosity{end}_error"])


# --- normal stress differences ---


def of_normal_stresses(table: pd.DataFrame, source: str, hours: float) -> list[Claim]:
    """Signs, zero crossing, magnitudes and order, for the total stress and for the pairs alone."""
    claims: list[Claim] = []
    for end, words in reversed(QUANTITIES.items()):
        dense = _densest(table)
        claims += [
            *_signs(dense, end, words, source, hours),
            _crossing(dense, end, words, source, hours),
            _magnitudes(dense, end, words, source, hours),
            *_vanishing(dense, end, words, source, hours),
            *_order(table, end, words, source, hours),
        ]
    return claims


def _densest(table: pd.DataFrame) -> pd.DataFrame:
    """The two greatest volume fractions, where normal stresses are largest."""
    fractions = sorted(table["volume_fraction"].unique())[-2:]
    return table[table["volume_fraction"].isin(fractions)]


def _over(rows: pd.DataFrame, name: str, end: str) -> Estimate:
    return weighted_mean(rows[f"{name}{end}"], rows[f"{name}{end}_error"])


def _signs(dense: pd.DataFrame, end: str, words: str, source: str, hours: float) -> list[Claim]:
    slow, fast = dense[dense["peclet"] <= LOW_PECLET], dense[dense["peclet"] >= HIGH_PECLET]
    regions = (
        ("At low Pe N1 is positive", "N1", slow, 1), ("At low Pe N2 is negative", "N2", slow, -1),
        ("At high Pe N1 is negative", "N1", fast, -1), ("At high Pe N2 is negative", "N2", fast, -1),
    )  # fmt: skip
    claims = []
    for text, name, rows, sign in regions:
        where = f"Pe <= {LOW_PECLET:g}" if rows is slow else f"Pe >= {HIGH_PECLET:g}"
        comparisons = [
            _signed(_over(part, name, end), sign, f"{name}/(eta_s rate) at phi = {fraction:.4f}")
            for fraction, part in rows.groupby("volume_fraction")
        ]
        rule = f"weighted mean over {where} is {'positive' if sign > 0 else 'negative'}, at both of the greatest phi"
        claim = judged(f"{text} ({words})", source, rule, comparisons, hours)
        claims.append(_with_solvents_share(claim, fast, name, end) if rows is fast and len(fast) else claim)
    return claims


def _signed(value: Estimate, sign: int, name: str) -> Comparison:
    return Comparison(value, low=0.0, name=name) if sign > 0 else Comparison(value, high=0.0, name=name)


def _with_solvents_share(claim: Claim, fast: pd.DataFrame, name: str, end: str) -> Claim:
    """What the solvent alone has at the highest rate: a remark where it is a third of the suspension's or more."""
    row = fast.loc[fast["shear_rate"].idxmax()]
    own = number(row[f"{name}_solvent"], row[f"{name}_solvent_error"])
    measured = number(row[f"{name}{end}"], row[f"{name}{end}_error"])
    if not own.value / measured.value >= 1.0 / 3.0:
        return claim
    return claim.with_remark(
        f"at rate {row['shear_rate']:g}, phi = {row['volume_fraction']:.4f}, the suspension has {measured} and the "
        "solvent "
        f"alone {own}, at T/kT = {row['temperature'] / row['kT']:.2f}"
    )


def _crossing(dense: pd.DataFrame, end: str, words: str, source: str, hours: float) -> Claim:
    comparisons = []
    for fraction, rows in dense.groupby("volume_fraction"):
        place = zero_crossing(rows["peclet"], rows[f"N1{end}"], rows[f"N1{end}_error"])
        comparisons.append(Comparison(place, 0.5, 1.5, f"log10 Pe at phi = {fraction:.4f}"))
    return judged(
        f"N1 changes from positive to negative at Pe = O(10) ({words})", source,
        "the Pe at which it is zero is between 10^0.5 and 10^1.5, at both of the greatest phi", comparisons, hours,
    )  # fmt: skip


def _magnitudes(dense: pd.DataFrame, end: str, words: str, source: str, hours: float) -> Claim:
    comparisons = []
    for fraction, rows in dense[dense["peclet"] <= LOW_PECLET].groupby("volume_fraction"):
        first, second = _over(rows, "N1", end), _over(rows, "N2", end)
        ratio = abs(first.value / second.value) if second.value else math.nan
        error = ratio * math.hypot(first.relative_error, second.relative_error) if ratio else math.nan
        # The logarithm is what is symmetric, and bounded neither way.
        logarithm = math.log10(ratio) if ratio and math.isfinite(ratio) else math.nan
        spread = error / ratio / math.log(10.0) if ratio else math.nan
        comparisons.append(
            near(number(logarithm, spread), 0.0, math.log10(5.0), f"log10 abs(N1/N2) at phi = {fraction:.4f}")
        )
    return judged(
        f"Both normal stress differences are of comparable magnitude ({words})", source,
        f"the ratio of their weighted means over Pe <= {LOW_PECLET:g} is between 1/5 and 5", comparisons, hours,
    )  # fmt: skip


def _vanishing(dense: pd.DataFrame, end: str, words: str, source: str, hours: float) -> list[Claim]:
    claims = []
    for name in ("N1", "N2"):
        comparisons = []
        for fraction, rows in dense.groupby("volume_fraction"):
            slow = rows[rows["peclet"] <= LOW_PECLET].sort_values("peclet")
            sign = 1.0 if name == "N1" else -1.0
            if len(slow) >= 3:
                first = slow.iloc[0]
                least = number(sign * first[f"{name}{end}"], first[f"{name}{end}_error"])
                typical = sign * _over(slow.iloc[1:], name, end)
                comparisons.append(Comparison(typical - least, low=0.0, name=f"difference at phi = {fraction:.4f}"))
        claims.append(
            judged(
                f"{name} vanishes as Pe goes to 0 ({words})", source,
                f"{'' if name == 'N1' else '-'}{name}/(eta_s rate) at the lowest Pe is smaller than its weighted "
                "mean over "
                f"the other Pe <= {LOW_PECLET:g}", comparisons, hours,
            )
        )  # fmt: skip
    return claims


def _order(table: pd.DataFrame, end: str, words: str, source: str, hours: float) -> list[Claim]:
    fractions = sorted(table["volume_fraction"].unique())
    slow = table[table["peclet"] <= LOW_PECLET]
    claims = []
    for name, sign, text in (("N1", 1, "largest N1"), ("N2", -1, "most negative N2")):
        most, least = (
            _over(slow[slow["volume_fraction"] == fraction], name, end) for fraction in (fractions[-1], fractions[0])
        )
        claims.append(
            judged(
                f"The greatest volume fraction has the {text} at low Pe ({words})", source,
                f"{name}/(eta_s rate), weighted mean over Pe <= {LOW_PECLET:g}, at phi = {fractions[-1]:.4f} minus "
                "that at "
                f"{fractions[0]:.4f} is {'positive' if sign > 0 else 'negative'}",
                [_signed(most - least, sign, "difference")], hours,
            )
        )  # fmt: skip
    return claims
