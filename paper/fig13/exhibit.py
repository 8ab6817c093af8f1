r"""Fig. 13: relative viscosity against the Péclet number, spheres in three dimensions

The paper finds that the suspensions are shear-thinning, the more so the lower $kT$, and that at $kT = 0.5$ and $\phi
= 0.4949$ the relative viscosity goes with $\mathrm{Pe}^{-0.32}$ at low Pe. It takes shear rates of 0.01 to 10 at $kT
= 1$ and 0.0075 to 10 at $kT = 0.5$.

Here: three of its ten volume fractions, 0.3333, 0.4635 and 0.4949, in a box of 10 by 10 by 10, at rates of 0.02 to 10
and 0.01 to 10, one run each, the longer the slower the flow (`--full`: all volume fractions, the paper's box, rates
and lengths). Pe is the paper's, eq. 18 with the $a$ and $D_0$ of its Tables 1 and 2. At rates of 5 and 10 viscous
heat warms the fluid far above $kT$, whatever the time step: these points are drawn, and left out where thinning is
judged.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import pandas as pd

from tether.paper import Claim, Findings, Panel, Part, exact
from tether.paper.numbers import number
from tether.paper.rheology import (
    QUANTITIES,
    against_peclet,
    exponents_table,
    is_held,
    plain_table,
    power_law,
    solvents_of,
    viscosity_table,
)
from tether.paper.rheology_claims import of_errors, of_plateau, of_power_law, of_temperature, of_thinning

SOURCE = "fig. 13, section 4.6"
RANGE = (0.3, 20.0)
"""Of Pe, that both temperatures have without being heated."""

LOW = 10.0
"""Pe up to which it is low, for the exponent that the paper prints."""

PRINTED = -0.32


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """The curves and their exponents."""
    solvents = solvents_of(parts["plain"])
    curves = pd.concat([viscosity_table(parts[name], solvents) for name in ("kt1", "kt05")], ignore_index=True)
    tables = {
        "curves": curves,
        "exponents": exponents_table(curves, *RANGE),
        "low": exponents_table(curves, 0.0, LOW),
        "solvent": plain_table(parts["plain"]),
    }
    hours = sum(part.core_hours for part in parts.values())
    notes = ["errors hold that of the solvent's viscosity, which all points of one kT share; exponents do not"]
    return Findings(tables, claims_of(tables, hours), notes)


def claims_of(tables: Mapping[str, pd.DataFrame], hours: float) -> list[Claim]:
    """What becomes of the paper's statements."""
    curves = tables["curves"]
    greatest = curves["volume_fraction"].max()
    cold = curves[(curves["kT"] == 0.5) & (curves["volume_fraction"] == greatest) & is_held(curves)]
    slopes = {end: power_law(cold, end, 0.0, LOW) if len(cold) else number(math.nan, math.nan) for end in QUANTITIES}
    return [
        *of_thinning(curves, tables["exponents"], *RANGE, SOURCE, hours),
        *of_power_law(
            slopes, PRINTED, "At kT = 0.5 and phi = 0.4949 the relative viscosity goes with Pe^-0.32 at low Pe",
            "fig. 13", f"exponent fitted over Pe <= {LOW:g}, within 0.05 of it", hours,
        ),
        exact("Pe^-0.32 corresponds to a power-law index of 0.68", "fig. 13", 1.0 + PRINTED, 0.68, 0.005),
        *of_plateau(curves, "section 4.5", hours),
        of_temperature(curves, SOURCE, hours),
        of_errors(curves, SOURCE, hours),
    ]  # fmt: skip


def panels(findings: Findings) -> list[Panel]:
    """One for each temperature."""
    return against_peclet(findings.tables["curves"])
