r"""Fig. 10: relative viscosity against volume fraction, discs in two dimensions

The paper finds that its viscosities agree with Krieger and Dougherty's law with $\phi_m = 0.91$ at $kT = 1$, and rise
more steeply at $kT = 0.5$, where solvent particles are larger: as if $\phi_m$ were smaller. They are taken at shear
rates of 0.05 ($kT = 1$) and 0.01 ($kT = 0.5$).

Here: the same rates and all eleven volume fractions, in the box of 10 by 10, one long run each (`--full`: ten runs of
200 000 steps, and the box of 20 by 20 too). All viscosities are over one viscosity of the solvent for each
temperature, measured at rates up to 1, where it is known well. Two figures are given for each suspension: from the
total stress, and from the pairs alone (eq. 16), which is what the paper plots; it leaves out the stress that the
bodies carry.

The slope at small $\phi$ is measured at a shear rate of 0.5, where errors are a tenth of those at 0.05 and few discs
do not thin yet. Both bases (massless, and Newton and Euler's of section 3) are compared at a rate of 0.2.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from tether.analysis.packing import Fit, fit
from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, judged, near
from tether.paper.numbers import number
from tether.paper.rheology import (
    QUANTITIES,
    Solvents,
    fits_table,
    lowest,
    plain_table,
    solvents_of,
    viscosity_table,
)
from tether.paper.rheology_claims import of_exponent, of_law, of_packing
from tether.theory import suspension

SOURCE = "fig. 10, section 4.5"
GREATEST = 0.51
TOLERANCE = 0.05


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Fits, slopes and bases."""
    solvents = solvents_of(parts["plain"])
    curves = pd.concat([lowest(viscosity_table(parts[name], solvents)) for name in ("kt1", "kt05")])
    dilute = pd.concat([viscosity_table(parts[f"dilute-{name}"], solvents) for name in ("kt1", "kt05")])
    tables = {
        "curves": curves,
        "fits": fits_table(curves, solvents, 2),
        "slopes": slopes_table(dilute, solvents),
        "bases": bases_table(parts["bases"], solvents),
        "solvent": plain_table(parts["plain"]),
    }
    if "large-kt1" in parts:
        tables["large"] = viscosity_table(parts["large-kt1"], solvents)
    hours = sum(part.core_hours for part in parts.values())
    notes = [
        "series of Hwang et al. (J. Comput. Phys. 194, 742, 2004) and of Bian and Ellero (2014): not available (no "
        "printed "
        "numbers were found); so what the paper says of them is not judged",
        "errors hold that of the solvent's viscosity, which all points of one kT share",
    ]
    return Findings(tables, claims_of(tables, hours), notes)


def slopes_table(dilute: pd.DataFrame, solvents: Solvents) -> pd.DataFrame:
    """[eta] of 1 + [eta] phi + k phi^2 for each kT, total and pairwise."""
    rows = []
    for kt, part in dilute.groupby("kT", sort=False):
        for end in QUANTITIES:
            found = fit(
                "second_order",
                np.append(part["volume_fraction"], 0.0),
                np.append(part[f"viscosity{end}"], solvents[kt].value),
                np.append(part[f"viscosity{end}_error"], solvents[kt].error),
                2,
            )
            slope = found.parameters["intrinsic_viscosity"] if isinstance(found, Fit) else number(np.nan, np.nan)
            rows.append([kt, end.strip("_") or "total", slope.value, slope.error])
    return pd.DataFrame(rows, columns=["kT", "quantity", "slope", "slope_error"])


def bases_table(part: Part, solvents: Solvents) -> pd.DataFrame:
    """The viscosities with both bases."""
    means = part.results.means
    table = pd.DataFrame({"base": means["bodies.0.base"], "volume_fraction": means["volume_fraction"]})
    for end in QUANTITIES:
        name = f"viscosity{end}"
        table[f"relative_{name}"] = means[name] / solvents[1.0].value
        table[f"relative_{name}_error"] = means[f"{name}_error"] / solvents[1.0].value
    table["temperature"] = means["temperature_all"]
    return table


def claims_of(tables: Mapping[str, pd.DataFrame], hours: float) -> list[Claim]:
    """What becomes of the paper's statements."""
    curves, fits = tables["curves"], tables["fits"]
    return [
        *of_law(curves, 1.0, 2, TOLERANCE, GREATEST, SOURCE, hours),
        *of_packing(fits, 2, SOURCE, hours),
        *of_exponent(fits, 1.0, SOURCE, hours),
        *_slopes(tables["slopes"], hours),
        *_bases(tables["bases"], hours),
    ]


def _slopes(slopes: pd.DataFrame, hours: float) -> list[Claim]:
    return [
        judged(
            f"At small phi the viscosity is Einstein's, with the slope 2, whatever kT ({words})", "section 4.5",
            "slope b of 1 + b phi + k phi^2, fitted up to phi = 0.083, within 0.2 of 2 at both temperatures",
            [
                near(number(row["slope"], row["slope_error"]), 2.0, 0.2, f"slope at kT = {row['kT']:g}")
                for _, row in slopes[slopes["quantity"] == (end.strip("_") or "total")].iterrows()
            ], hours,
        )
        for end, words in reversed(QUANTITIES.items())
    ]  # fmt: skip


def _bases(bases: pd.DataFrame, hours: float) -> list[Claim]:
    claims = []
    for end, words in reversed(QUANTITIES.items()):
        name = f"relative_viscosity{end}"
        ratios: list[Comparison] = []
        for fraction, rows in bases.groupby("volume_fraction"):
            by_base = {row["base"]: number(row[name], row[f"{name}_error"]) for _, row in rows.iterrows()}
            ratio = by_base["newton-euler"] / by_base["massless"]
            ratios.append(near(ratio, 1.0, 0.05, f"ratio at phi = {fraction:.4f}"))
        claims.append(
            judged(
                "The viscosity does not hang on how the base is moved: Newton and Euler's, or massless as in eq. 24-30 "
                f"({words})", "section 3", "the ratio of both is within 5 % of 1", ratios, hours,
            )
        )  # fmt: skip
    return claims


def panels(findings: Findings) -> list[Panel]:
    """One for each temperature."""
    curves, bases = findings.tables["curves"], findings.tables["bases"]
    drawn = []
    for kt, rows in curves.groupby("kT", sort=False):
        packing = suspension.MAXIMUM_PACKING[2]
        phi = np.linspace(0.0, 0.56, 113)
        shown = [
            Series(r"Krieger-Dougherty, $\phi_m$ = 0.91", phi / packing, suspension.krieger_dougherty(phi, 2, packing),
                   kind="line", color="#6E6E6E"),
            Series(r"Quemada, $\phi_m$ = 0.91", phi / packing, suspension.quemada(phi, packing), kind="dashed",
                   color="#6E6E6E"),
        ]  # fmt: skip
        for place, (end, words) in enumerate(QUANTITIES.items()):
            name = f"relative_viscosity{end}"
            x, y, error = rows["volume_fraction"] / packing, rows[name], rows[f"{name}_error"]
            shown.append(Series(words, x, y, error, color=COLORS[place], hollow=bool(end)))
        if kt == 1.0:
            other = bases[bases["base"] == "newton-euler"]
            shown.append(
                Series("Newton-Euler base, total, rate 0.2", other["volume_fraction"] / packing,
                       other["relative_viscosity"], other["relative_viscosity_error"], color=COLORS[2], marker="^")
            )  # fmt: skip
        rate = rows["shear_rate"].min()
        title = f"kT = {kt:g}, shear rate {rate:g}, Pe = {rows['peclet'].min():.2g}"
        drawn.append(Panel(title, r"$\phi/0.91$", r"relative viscosity $\eta_r$", shown))
    return drawn
