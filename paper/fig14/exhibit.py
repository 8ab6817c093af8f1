r"""Fig. 14: normal stress differences against the Péclet number, three dimensions, kT = 1

The paper finds $N_1 > 0$ and $N_2 < 0$ at low Pe, where Brownian forces rule, $N_1$ changing its sign at a Pe of the
order of 10, both negative at high Pe, both of comparable magnitude, and both vanishing as Pe goes to 0. They are over
$\eta_s\dot\gamma$, the solvent's viscosity times the shear rate.

Here: the runs of figure 13, three of its ten volume fractions in a box of 10 by 10 by 10 at rates of 0.02 to 10
(`--full`: all volume fractions, the paper's box, rates of 0.01 to 10, and lengths). Over $\eta_s\dot\gamma$ an error
is as one over the rate, so that the lowest rates say little. Normal stresses are given of the total stress and of the
pairs alone (eq. 16), which is what the paper plots; the axes are the paper's, $N_1$ of flow and gradient, $N_2$ of
gradient and vorticity. The solvent alone has a negative $N_1$ in fast flow too (dashed), which is no stress of the
bodies.
"""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from tether.paper import Claim, Findings, Panel, Part
from tether.paper.rheology import normal_stress_panels, normal_stress_table, plain_table, solvents_of
from tether.paper.rheology_claims import of_normal_stresses

SOURCE = "fig. 14, section 4.7"


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Both normal stress differences at each volume fraction and rate."""
    plain = plain_table(parts["plain"])
    tables = {"curves": normal_stress_table(parts["kt1"], solvents_of(parts["plain"]), plain), "solvent": plain}
    hours = sum(part.core_hours for part in parts.values())
    notes = [
        "series of Foss and Brady (2000) and of Pan et al. (2010a): not available (no printed numbers were found); "
        "so what "
        "the paper says of them is not judged"
    ]
    return Findings(tables, claims_of(tables, hours), notes)


def claims_of(tables: Mapping[str, pd.DataFrame], hours: float) -> list[Claim]:
    """What becomes of the paper's statements."""
    return of_normal_stresses(tables["curves"], SOURCE, hours)


def panels(findings: Findings) -> list[Panel]:
    """N1 and N2."""
    return normal_stress_panels(findings.tables["curves"])
