r"""Fig. 11: relative viscosity against volume fraction, spheres in three dimensions

The paper finds that its viscosities agree with Krieger and Dougherty's law with $\phi_m = 0.65$ at $kT = 1$ (shear
rate 0.01) and fit a smaller $\phi_m$ at $kT = 0.5$ (shear rate 0.0075).

Here: all ten volume fractions in a box of 10 by 10 by 10. An error of the viscosity grows as one over the rate, and
few spheres do not thin, so each volume fraction has a rate of its own, low where it thins and higher where it does
not: at $kT = 1$ from 0.2 for $\phi$ below 0.15 down to 0.02 for the two greatest, half of that at $kT = 0.5$ (column
shear_rate of the table; `--full`: the paper's rates, lengths and box). Two figures are given for each suspension:
from the total stress, and from the pairs alone (eq. 16), which is what the paper plots. Where a suspension still
thins at the rate that we can afford, its viscosity is below that of the paper's rate; the claims say at which rate
they were judged.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from tether.paper import COLORS, Claim, Findings, Panel, Part, Series
from tether.paper.rheology import QUANTITIES, fits_table, lowest, plain_table, solvents_of, viscosity_table
from tether.paper.rheology_claims import of_exponent, of_law, of_packing
from tether.theory import suspension

SOURCE = "fig. 11, section 4.5"
GREATEST = 0.5
TOLERANCE = 0.10


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """The curves and the laws fitted to them."""
    solvents = solvents_of(parts["plain"])
    curves = pd.concat([lowest(viscosity_table(parts[name], solvents)) for name in ("kt1", "kt05")])
    tables = {"curves": curves, "fits": fits_table(curves, solvents, 3), "solvent": plain_table(parts["plain"])}
    hours = sum(part.core_hours for part in parts.values())
    notes = [
        "series of van der Werff and de Kruif (1989): not available (no printed numbers were found); so the "
        "agreement with "
        "it is not judged",
        "errors hold that of the solvent's viscosity, which all points of one kT share",
        *(rates_in_words(kt, rows) for kt, rows in curves.groupby("kT", sort=False)),
    ]
    return Findings(tables, claims_of(tables, hours), notes)


def rates_in_words(kt: float, rows: pd.DataFrame) -> str:
    """Which rates were used for which volume fractions."""
    parts = [
        f"{rate:g} for phi from {of['volume_fraction'].min():.4f} to {of['volume_fraction'].max():.4f}"
        for rate, of in rows.groupby("shear_rate", sort=False)
    ]
    return f"shear rates at kT = {kt:g}: " + ", ".join(parts)


def claims_of(tables: Mapping[str, pd.DataFrame], hours: float) -> list[Claim]:
    """What becomes of the paper's statements."""
    fits = tables["fits"]
    return [
        *of_law(tables["curves"], 1.0, 3, TOLERANCE, GREATEST, SOURCE, hours),
        *of_packing(fits, 3, SOURCE, hours),
        *of_exponent(fits, 1.0, SOURCE, hours),
    ]


def panels(findings: Findings) -> list[Panel]:
    """One for each temperature."""
    drawn = []
    packing = suspension.MAXIMUM_PACKING[3]
    phi = np.linspace(0.0, 0.5, 101)
    for kt, rows in findings.tables["curves"].groupby("kT", sort=False):
        shown = [
            Series(r"Krieger-Dougherty, $\phi_m$ = 0.65", phi / packing, suspension.krieger_dougherty(phi, 3, packing),
                   kind="line", color="#6E6E6E"),
            Series(r"Quemada, $\phi_m$ = 0.65", phi / packing, suspension.quemada(phi, packing), kind="dashed",
                   color="#6E6E6E"),
        ]  # fmt: skip
        for place, (end, words) in enumerate(QUANTITIES.items()):
            name = f"relative_viscosity{end}"
            x, y, error = rows["volume_fraction"] / packing, rows[name], rows[f"{name}_error"]
            shown.append(Series(words, x, y, error, color=COLORS[place], hollow=bool(end)))
        low, high = rows["shear_rate"].min(), rows["shear_rate"].max()
        rates = f"{low:g}" if low == high else f"{low:g} to {high:g}"
        drawn.append(Panel(f"kT = {kt:g}, shear rate {rates}", r"$\phi/0.65$", r"relative viscosity $\eta_r$", shown))
    return drawn
