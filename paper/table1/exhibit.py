"""Table 1: effective sizes from radial distribution functions

The paper takes the distance at which g becomes 0.01 for the diameter of a solvent particle, and for the sum of the
radii of a body and a solvent particle, in bins of 0.01 and without errors. We take the same threshold, interpolated
between bins, with several bodies in one box: g of each bin is then known as well as from one body in as many times the
run, which is what a threshold of 0.01 needs. With few counts, bins near the foot are empty by chance and the threshold
is met later. Where g at zero distance is above 0.01 there is no such distance; what is read off is then the width of a
bin, or what bins a short run has left empty.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import pandas as pd

from tether.estimate import Estimate
from tether.observe.radial_distribution import THRESHOLD
from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, Verdict, judged, near
from tether.paper.distributions import contact_distance, curves, increases, number, shell_mean

PRINTED = {
    (2, 1.0): (0.01, 0.005, 0.4, 0.3995, 80.0),
    (2, 0.5): (0.12, 0.06, 0.5, 0.44, 7.3),
    (2, 0.25): (0.21, 0.105, 0.57, 0.465, 4.4),
    (3, 1.0): (0.05, 0.025, 0.63, 0.605, 24.0),
    (3, 0.5): (0.18, 0.09, 0.73, 0.64, 7.1),
    (3, 0.25): (0.25, 0.125, 0.8, 0.675, 5.4),
}
"""Table 1 by dimension and kT: distance and radius of the solvent, of a body, and the ratio of the radii."""

SHAPES = {2: "square", 3: "cube"}

BINS = 0.03
"""Three of the paper's bins of 0.01: what a threshold in noisy bins can be off by, length."""

_RATIO = 0.1
_SMALL = 0.03
"""g at contact is the mean up to here, length."""

Sizes = Mapping[tuple[int, float], Estimate]


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Sizes beside those of Table 1."""
    solvent: dict[tuple[int, float], Estimate] = {}
    body: dict[tuple[int, float], Estimate] = {}
    contact: dict[tuple[int, float], Estimate] = {}
    before: dict[tuple[int, float], Estimate] = {}
    bins: dict[tuple[int, float], float] = {}
    for dimension in (2, 3):
        part = parts[f"{dimension}d"]
        table = curves(part, SHAPES[dimension])
        for setting in part.study.settings:
            temperature = float(setting.values["fluid.temperature"])
            case = dimension, temperature
            solvent[case] = contact_distance(part, temperature, "solvent")
            body[case] = contact_distance(part, temperature, SHAPES[dimension])
            if not table.empty:
                contact[case] = shell_mean(table, temperature, "solvent", 0.0, _SMALL)
                before[case] = shell_mean(table, temperature, "solvent", 0.0, PRINTED[case][0])
                bins[case] = _first_bin(table, temperature)
    hours = sum(part.core_hours for part in parts.values())
    claims = [
        *_distances(solvent, body, hours),
        *_at_contact(before, bins, hours),
        _growth(solvent, body, hours),
        *_ratios(solvent, body, hours),
        _printed_radii(),
    ]
    return Findings({"sizes": _table(solvent, body, contact)}, claims)


def _first_bin(table: pd.DataFrame, temperature: float) -> float:
    """Middle of the first bin in which g is 0.01 or more: the paper's reading without interpolation, length."""
    rows = table[(table["temperature"] == temperature) & (table["g_solvent"] >= THRESHOLD)]
    return math.nan if rows.empty else float(rows["q"].iloc[0])


def _distances(solvent: Sizes, body: Sizes, hours: float) -> list[Claim]:
    claims = []
    for dimension in (2, 3):
        for name, found, column in (("solvent particles", solvent, 0), ("a body and the solvent", body, 2)):
            cases = [case for case in found if case[0] == dimension and (column == 2 or case[1] < 1.0)]
            comparisons = [near(found[case], PRINTED[case][column], BINS, f"kT = {case[1]:g}: q") for case in cases]
            printed = ", ".join(f"{PRINTED[case][column]:g} (kT = {case[1]:g})" for case in cases)
            claim = judged(
                f"{dimension}D, {name}: g reaches 0.01 at {printed}", "Table 1",
                f"the distance is within {BINS:g}, three of the paper's bins", comparisons, hours,
            )  # fmt: skip
            off = [found[case].value - PRINTED[case][column] for case in cases]
            if off and all(each < 0.0 for each in off):
                claim = claim.with_remark(f"all are below the printed, by {-max(off):.3f} to {-min(off):.3f}")
            claims.append(claim)
    return claims


def _at_contact(before: Sizes, bins: Mapping[tuple[int, float], float], hours: float) -> list[Claim]:
    """The solvent at kT = 1, whose printed distances ask that there is next to nothing nearer."""
    claims = []
    for case, g in before.items():
        dimension, temperature = case
        if temperature < 1.0:
            continue
        q = PRINTED[case][0]
        claim = judged(
            f"{dimension}D, solvent particles: g reaches 0.01 at {q:g} (kT = 1)", "Table 1",
            f"mean g nearer than that is below {THRESHOLD:g}",
            [Comparison(g, high=THRESHOLD, name=f"mean g over q < {q:g}")], hours,
        )  # fmt: skip
        if claim.verdict is Verdict.FAILS:
            claim = claim.with_remark(
                "g at zero distance is above the threshold, so that there is no such distance; the first bin with "
                f"0.01 or more is that at {bins[case]:g}, and the printed figure is one of bins and counts"
            )
        claims.append(claim)
    return claims


def _growth(solvent: Sizes, body: Sizes, hours: float) -> Claim:
    comparisons = []
    for dimension in (2, 3):
        for name, found in (("solvent", solvent), ("body", body)):
            sizes = {temperature: q for (d, temperature), q in found.items() if d == dimension}
            comparisons += increases(sizes, f"{dimension}D, {name}")
    return judged(
        "Particles are the larger the lower kT", "section 4.4",
        "every distance is larger than that at the next higher kT where there is one", comparisons, hours,
    )  # fmt: skip


def _ratios(solvent: Sizes, body: Sizes, hours: float) -> list[Claim]:
    ratios = {case: _ratio(solvent[case], body[case]) for case in solvent}
    cases = [case for case in ratios if case[1] < 1.0]
    printed = ", ".join(f"{PRINTED[case][4]:g} ({case[0]}D, kT = {case[1]:g})" for case in cases)
    comparisons = [
        near(ratios[case], PRINTED[case][4], _RATIO * PRINTED[case][4], f"{case[0]}D, kT = {case[1]:g}")
        for case in cases
    ]
    by_size = judged(
        f"A body's radius is {printed} times that of a solvent particle", "Table 1",
        f"the ratio is within {_RATIO:.0%} of the printed", comparisons, hours,
    )  # fmt: skip
    higher = sum(ratios[case].value > PRINTED[case][4] for case in cases)
    if cases and higher == len(cases):
        by_size = by_size.with_remark("all are higher: what a small solvent radius lacks weighs heavily in a ratio")
    falls = [
        Comparison(ratios[d, 0.5] - ratios[d, 0.25], low=0.0, name=f"{d}D, at kT = 0.5 less at 0.25")
        for d in (2, 3)
        if (d, 0.5) in ratios and (d, 0.25) in ratios
    ]
    by_temperature = judged(
        "The ratio of the sizes falls with kT", "section 4.5", "it is larger at kT = 0.5 than at 0.25", falls, hours
    )
    return [by_size, by_temperature]


def _ratio(solvent: Estimate, body: Estimate) -> Estimate:
    """a_C/a_S = (q_C - q_S/2)/(q_S/2) = 2 q_C/q_S - 1; no value where one of them has none."""
    if not solvent.value > 0.0:
        return number(math.nan, math.nan)
    return 2.0 * body / solvent - 1.0


def _printed_radii() -> Claim:
    """Table 1 against its own formulas, no measurement."""
    comparisons = [
        near(number(round(row[2] - row[0] / 2.0, 6), 0.0), row[3], 5e-4, f"{d}D, kT = {temperature:g}")
        for (d, temperature), row in PRINTED.items()
    ]
    claim = judged(
        "a_C is q less a_S", "Table 1",
        "the printed q of a body less the printed a_S is the printed a_C within 0.0005, half of its last digit",
        comparisons,
    )  # fmt: skip
    wrong = [f"{each.name}: {each.measured.value:g}" for each in comparisons if each.verdict(0.0) is Verdict.FAILS]
    return claim.with_remark(f"not so for {'; '.join(wrong)}: a slip of no consequence") if wrong else claim


def _table(solvent: Sizes, body: Sizes, contact: Sizes) -> pd.DataFrame:
    rows = []
    for case, q in solvent.items():
        ratio, radius = _ratio(q, body[case]), body[case] - (0.5 * q if math.isfinite(q.value) else 0.0)
        g = contact.get(case, number(math.nan, math.nan))
        rows.append(
            {
                "dimension": case[0],
                "temperature": case[1],
                "solvent_distance": q.value,
                "solvent_distance_error": q.error,
                "solvent_distance_printed": PRINTED[case][0],
                "solvent_radius": 0.5 * q.value,
                "solvent_radius_error": 0.5 * q.error,
                "solvent_radius_printed": PRINTED[case][1],
                "g_solvent_at_contact": g.value,
                "g_solvent_at_contact_error": g.error,
                "body_distance": body[case].value,
                "body_distance_error": body[case].error,
                "body_distance_printed": PRINTED[case][2],
                "body_radius": radius.value,
                "body_radius_error": radius.error,
                "body_radius_printed": PRINTED[case][3],
                "ratio": ratio.value,
                "ratio_error": ratio.error,
                "ratio_printed": PRINTED[case][4],
            }
        )
    return pd.DataFrame(rows)


def panels(findings: Findings) -> list[Panel]:
    """The distances against kT, ours and the printed."""
    table = findings.tables["sizes"]
    return [
        Panel(
            f"{dimension}D", "temperature $kT$ (energy)", "distance at which $g$ = 0.01 ($r_c$)",
            _series(table[table["dimension"] == dimension]),
        )
        for dimension in (2, 3)
    ]  # fmt: skip


def _series(table: pd.DataFrame) -> Sequence[Series]:
    temperature = table["temperature"].to_numpy()
    shown = []
    for name, words, color in (("body", "center of a body and solvent", COLORS[0]), ("solvent", "solvent", COLORS[1])):
        ours, error = table[f"{name}_distance"].to_numpy(), table[f"{name}_distance_error"].to_numpy()
        shown.append(Series(words, temperature, ours, error, color=color))
        printed = table[f"{name}_distance_printed"].to_numpy()
        shown.append(Series(f"{words}, the paper", temperature, printed, color=color, marker="s", hollow=True))
    return shown
