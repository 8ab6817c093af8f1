r"""Fig. 12: relative viscosity against the Péclet number, discs in two dimensions

The paper finds that the suspensions are shear-thinning, the more so the lower $kT$. It takes shear rates of 0.05 to
10 at $kT = 1$ and 0.01 to 10 at $kT = 0.5$.

Here: the same ranges and all eleven volume fractions, in the box of 10 by 10, one run each, the longer the slower the
flow (`--full`: more rates, ten runs of 200 000 steps each). Pe is the paper's, eq. 18 with its own $a$ and $D_0$. At
rates of 5 and 10 viscous heat warms the fluid far above $kT$, whatever the time step, and so these points, which the
paper plots, are of another fluid: they are drawn, and left out where thinning is judged. At the lowest rates Pe is
below 0.2 for both temperatures; exponents are fitted over a range of Pe that both have.
"""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from tether.paper import Claim, Findings, Panel, Part
from tether.paper.numbers import number
from tether.paper.rheology import against_peclet, exponents_table, plain_table, solvents_of, viscosity_table
from tether.paper.rheology_claims import of_errors, of_plateau, of_temperature, of_thinning

SOURCE = "fig. 12, section 4.6"
RANGE = (0.12, 8.0)
"""Of Pe, that both temperatures have without being heated."""


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """The curves and their exponents."""
    solvents = solvents_of(parts["plain"])
    curves = pd.concat([viscosity_table(parts[name], solvents) for name in ("kt1", "kt05")], ignore_index=True)
    tables = {
        "curves": curves,
        "exponents": exponents_table(curves, *RANGE),
        "timestep": timestep_table(parts["timestep"]),
        "solvent": plain_table(parts["plain"]),
    }
    hours = sum(part.core_hours for part in parts.values())
    notes = [
        "errors hold that of the solvent's viscosity, which all points of one kT share; exponents do not",
        heat_in_words(tables["timestep"]),
    ]
    return Findings(tables, claims_of(tables, hours), notes)


def timestep_table(part: Part) -> pd.DataFrame:
    """The temperature in the fastest flow by the time step."""
    means = part.results.means
    names = ["shear_rate", "volume_fraction", "temperature_all", "temperature_all_error"]
    return pd.concat([means["run.timestep"].rename("timestep"), means[names]], axis=1)


def heat_in_words(table: pd.DataFrame) -> str:
    """Whether it is the time step that heats."""
    found = [
        f"{number(row['temperature_all'], row['temperature_all_error'])} at a time step of {row['timestep']:g}"
        for _, row in table.iterrows()
    ]
    where = f"at rate {table['shear_rate'].iloc[0]:g}, phi = {table['volume_fraction'].iloc[0]:.4f}, kT = 1"
    return f"{where}, the kinetic temperature is {' and '.join(found)}: where these agree the heat is the flow's own"


def claims_of(tables: Mapping[str, pd.DataFrame], hours: float) -> list[Claim]:
    """What becomes of the paper's statements."""
    curves = tables["curves"]
    return [
        *of_thinning(curves, tables["exponents"], *RANGE, SOURCE, hours),
        *of_plateau(curves, "section 4.5", hours),
        of_temperature(curves, SOURCE, hours),
        of_errors(curves, SOURCE, hours),
    ]


def panels(findings: Findings) -> list[Panel]:
    """One for each temperature."""
    return against_peclet(findings.tables["curves"])
