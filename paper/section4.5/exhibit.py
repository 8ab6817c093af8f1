r"""Section 4.5: the sizes of bodies and of solvent particles, and the maximum packing

The paper holds the ratio of the radii of bodies and solvent particles responsible for the effective maximum packing
$\phi_m$: it grows with $kT$ (Table 1), and with the number of constituents of a body. Above $kT = 1$ a further
increase does not change $\phi_m$, it says, and a larger body is the preferred way to a large ratio.

Here: discs in two dimensions in a box of 10 by 10 at a shear rate of 0.2, at three temperatures, and at $kT = 0.5$
with bodies of 4 (the paper's square), 7 (a hexagon and its center) and 19 constituents (two hexagons), all 0.25
apart. The volume fraction is eq. 42's: constituents over all particles. Each set of viscosities, with the solvent's,
is fitted by $(1 - \phi/\phi_m)^{-x}$, with $x = 2\phi_m$ (Krieger and Dougherty with $[\eta] = 2$) and with $x$ free.
If a body takes more or less room than eq. 42 counts, all $\phi$ are off by a factor: that moves $\phi_m$ and
$[\eta]$, and leaves $x$ as it is, so that $x/2$ is a maximum packing which does not hang on how the volume fraction
is counted. A larger body diffuses less, so that at the same rate it is sheared at a greater Pe, and thins. The
pairwise viscosity of eq. 16 leaves out what the bodies carry, which is more in larger bodies. (Figures 10 and 11 have
$\phi_m$ by temperature at the lowest rates; figure 9 the size of a pore.)
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, exact, judged, near
from tether.paper.rheology import QUANTITIES, fits_table, fitted, plain_table, solvents_of, viscosity_table
from tether.theory import suspension

SOURCE = "section 4.5"
SIZES = (4, 7, 19)
TABLE_1 = {(2, 1.0): (0.3995, 0.005), (2, 0.5): (0.44, 0.06), (3, 1.0): (0.605, 0.025), (3, 0.5): (0.64, 0.09)}
"""Radii of a body and of a solvent particle, as printed, by dimension and kT."""

PRINTED_RATIOS = {(2, 1.0): 80.0, (2, 0.5): 7.3, (3, 1.0): 24.2, (3, 0.5): 7.1}
ROUNDING = {80.0: 0.5, 7.3: 0.05, 24.2: 0.05, 7.1: 0.05}


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Curves and fits by temperature and by the size of a body."""
    solvents = solvents_of(parts["plain"]) | solvents_of(parts["plain-hot"])
    by_kt = viscosity_table(parts["kt"], solvents)
    sizes = {count: viscosity_table(parts[f"bodies{count}"], solvents) for count in SIZES}
    fits = {count: fits_table(table, solvents, 2) for count, table in sizes.items()}
    tables = {
        "temperatures": by_kt,
        "temperature-fits": fits_table(by_kt, solvents, 2),
        "sizes": _numbered(sizes),
        "size-fits": _numbered(fits),
        "solvent": pd.concat([plain_table(parts[name]) for name in ("plain", "plain-hot")]),
    }
    hours = sum(part.core_hours for part in parts.values())
    return Findings(tables, claims_of(tables, hours))


def _numbered(tables: Mapping[int, pd.DataFrame]) -> pd.DataFrame:
    """One below the other, with the number of constituents in a column."""
    return pd.concat([table.assign(constituents=count) for count, table in tables.items()], ignore_index=True)


def claims_of(tables: Mapping[str, pd.DataFrame], hours: float) -> list[Claim]:
    """What becomes of the paper's statements."""
    return [*_arithmetic(), *_temperatures(tables["temperature-fits"], hours), *_sizes(tables["size-fits"], hours)]


def _arithmetic() -> list[Claim]:
    claims = [
        exact(f"The ratio of the radii of Table 1 is {PRINTED_RATIOS[key]:g} in {key[0]}D at kT = {key[1]:g}", SOURCE,
              body / solvent, PRINTED_RATIOS[key], ROUNDING[PRINTED_RATIOS[key]])
        for key, (body, solvent) in TABLE_1.items()
    ]  # fmt: skip
    return [
        *claims,
        exact("Solvent particles shrink 21 times as kT grows fourfold (Table 1, 2D)", SOURCE, 0.105 / 0.005, 21.0, 0.5),
        exact("Hexagonal packing of discs: phi_m = 0.91", SOURCE, math.pi / math.sqrt(12.0), 0.91, 0.005),
        exact("Hexagonal packing of spheres: phi_m = 0.71", SOURCE, math.pi / math.sqrt(18.0), 0.71, 0.005),
    ]


def _temperatures(fits: pd.DataFrame, hours: float) -> list[Claim]:
    claims = []
    for end, words in reversed(QUANTITIES.items()):
        packing = {kt: fitted(fits, kt, end, "krieger_dougherty", "maximum_packing") for kt in (0.5, 1.0, 2.0)}
        rule = "phi_m of Krieger and Dougherty's law with the slope 2, rate 0.2"
        told = ", ".join(f"phi_m({kt:g}) = {value}" for kt, value in packing.items())
        rises = Comparison(packing[1.0] - packing[0.5], low=0.0, name="phi_m(1) - phi_m(0.5)")
        stays = near(packing[2.0] - packing[1.0], 0.0, 0.04, "phi_m(2) - phi_m(1)")
        claims += [
            judged(
                f"The effective maximum packing rises with kT, from 0.5 to 1 ({words})", SOURCE,
                f"{rule}, is larger at kT = 1", [rises], hours,
            ),
            judged(
                f"Increasing kT beyond 1 does not affect it further ({words})", SOURCE,
                f"{rule}, at kT = 2 within 0.04 of that at 1 ({told})", [stays], hours,
            ),
        ]  # fmt: skip
    return claims


def _sizes(fits: pd.DataFrame, hours: float) -> list[Claim]:
    small, large = (fits[fits["constituents"] == count] for count in (SIZES[0], SIZES[-1]))
    claims = []
    for end, words in reversed(QUANTITIES.items()):
        laws = (("krieger_dougherty", "maximum_packing", 1.0), ("krieger_dougherty_free", "exponent", 0.5))
        names = ("phi_m with the slope 2, phi by eq. 42", "x/2, which does not hang on how phi is counted")
        for (law, name, factor), what in zip(laws, names, strict=True):
            first, last = (fitted(each, 0.5, end, law, name) * factor for each in (small, large))
            claims.append(
                judged(
                    f"A body of more constituents has a larger effective maximum packing (kT = 0.5, {words}; {what})",
                    SOURCE, f"it is larger with {SIZES[-1]} constituents than with {SIZES[0]}",
                    [Comparison(last - first, low=0.0, name=f"{last} - {first}")], hours,
                )
            )  # fmt: skip
        slope = fitted(large, 0.5, end, "krieger_dougherty_free", "intrinsic_viscosity")
        claims.append(
            judged(
                f"Eq. 42 is the volume fraction that gives Einstein's slope 2, for larger bodies too ({words})",
                "section 4.4", f"slope at phi = 0, free beside phi_m, within 0.2 of 2 with {SIZES[-1]} constituents",
                [near(slope, 2.0, 0.2, "slope")], hours,
            )
        )  # fmt: skip
    return claims


def panels(findings: Findings) -> list[Panel]:
    """By temperature, and by the size of a body."""
    phi = np.linspace(0.0, 0.52, 105)
    law = Series(r"Krieger-Dougherty, $\phi_m$ = 0.91", phi, suspension.krieger_dougherty(phi, 2, 0.91), kind="dashed",
                 color="#6E6E6E")  # fmt: skip
    kinds = (
        ("temperatures", "kT", "kT = {:g}", "Temperatures, rate 0.2 (hollow: pairs alone)"),
        ("sizes", "constituents", "{:g} constituents", "Sizes, kT = 0.5, rate 0.2 (hollow: pairs alone)"),
    )
    drawn = []
    for name, key, label, title in kinds:
        shown = [law]
        for color, (value, rows) in zip(COLORS, findings.tables[name].groupby(key), strict=False):
            for end, hollow in (("", False), ("_pairwise", True)):
                y, error = rows[f"relative_viscosity{end}"], rows[f"relative_viscosity{end}_error"]
                text = "" if hollow else label.format(value)
                shown.append(Series(text, rows["volume_fraction"], y, error, color=color, hollow=hollow))
        drawn.append(Panel(title, r"volume fraction $\phi$ (eq. 42)", r"relative viscosity $\eta_r$", shown))
    return drawn
