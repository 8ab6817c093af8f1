r"""Section 4.4: volume fraction, particle fraction and mass fraction.

The paper (eq. 42-45) takes the particle fraction $N_C/(N_C + N_S)$ for the volume fraction, since all particles are
of one kind, and says that the mass fraction is the same if constituents are as heavy as the solvent (eq. 45 with
$\rho_C = \rho_S$).

The fractions are computed from the configurations. What happens when the constituents have another mass, we look at
in shear (2D, kT = 1, box 10 x 10, rate 0.3): the mass fraction then is another number, and only one of the two
fractions can tell the viscosity. The paper does this below $\phi = 0.025$ (fig. 8); here there are more bodies, so
that the two predictions are far apart. They are drawn by Krieger and Dougherty's formula with $\phi_m = 0.91$ (fig.
10), once of the particle and once of the mass fraction. Viscosities are judged both from the pairwise stress, the
paper's eq. 16, and from the total.

The text after eq. 44 gives the mass of the solvent as $(1 - [MF])N_Sm_S$. It is $N_Sm_S$, or $(1 - [MF])m_T$.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, judged, near
from tether.paper.numbers import number
from tether.theory.suspension import krieger_dougherty

MASS, COUNT = "bodies.0.mass", "bodies.0.count"
SOURCE = "section 4.4"
PACKING = 0.91
KINDS = {"relative_viscosity_pairwise": "pairwise", "relative_viscosity": "total"}


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Fractions, and relative viscosities against the mass of a constituent."""
    part = parts[""]
    means = part.results.means
    columns = [COUNT, MASS, "solvent", "particle_fraction", "mass_fraction"]
    table = means[[*columns, *(f"{kind}{of}" for kind in KINDS for of in ("", "_error"))]].rename(
        columns={COUNT: "bodies", MASS: "mass"}
    )
    for of in ("particle", "mass"):
        table[f"formula_{of}"] = krieger_dougherty(table[f"{of}_fraction"].to_numpy(), 2, PACKING)
    claims = [*_of_fractions(table), _solvent_mass(table)]
    for kind, words in KINDS.items():
        claims += [_same(table, kind, words, part.core_hours), _not_mass(table, kind, words, part.core_hours)]
    return Findings({"mass": table}, claims)


def _of_fractions(table: pd.DataFrame) -> list[Claim]:
    """Eq. 42-45, from what the runs had."""
    constituents = 4.0 * table["bodies"]
    particles = constituents / (constituents + table["solvent"])
    masses = constituents * table["mass"] / (constituents * table["mass"] + table["solvent"])
    equal = table["mass"] == 1.0
    rule = "equal within 1e-12"
    return [
        judged(
            "The volume fraction is the particle fraction, eq. 42-43.",
            SOURCE,
            f"{rule}, in every run",
            [
                near(
                    number(float((table["particle_fraction"] - particles).abs().max())),
                    0.0,
                    1e-12,
                    "largest difference",
                )
            ],
        ),
        judged(
            "The mass fraction is eq. 45.",
            SOURCE,
            f"{rule}, in every run",
            [near(number(float((table["mass_fraction"] - masses).abs().max())), 0.0, 1e-12, "largest difference")],
        ),
        judged(
            "The mass fraction is the volume fraction where constituents are as heavy as the solvent.",
            SOURCE,
            rule,
            [
                near(number(value), 0.0, 1e-12, "difference")
                for value in (table["mass_fraction"] - table["particle_fraction"])[equal]
            ],
        ),
    ]


def _solvent_mass(table: pd.DataFrame) -> Claim:
    """The sentence after eq. 44, of solvent of mass 1."""
    written = (1.0 - table["mass_fraction"]) * table["solvent"] / table["solvent"]
    claim = judged(
        "The mass of the solvent is (1 - [MF]) N_S m_S.",
        "section 4.4, after eq. 44",
        "what is written, over N_S m_S, is 1 within 1e-12",
        [
            near(number(float(ratio)), 1.0, 1e-12, f"m_C = {mass:g}")
            for ratio, mass in zip(written, table["mass"], strict=True)
        ],
    )
    return claim.with_remark("a slip: the mass of the solvent is (1 - [MF]) m_T = N_S m_S; eq. 45 is right")


def _pairs(table: pd.DataFrame) -> list[tuple[pd.Series, pd.Series]]:
    """Each row of another mass, and that of mass 1 with as many bodies."""
    plain = table[table["mass"] == 1.0].set_index("bodies")
    return [(row, plain.loc[row["bodies"]]) for _, row in table[table["mass"] != 1.0].iterrows()]


def _ratio(row: pd.Series, plain: pd.Series, kind: str) -> tuple[float, float]:
    """Of a viscosity to that at mass 1, with its error; the plain fluid's is in both, and small beside it."""
    ratio = row[kind] / plain[kind]
    return ratio, abs(ratio) * float(np.hypot(row[f"{kind}_error"] / row[kind], plain[f"{kind}_error"] / plain[kind]))


def _same(table: pd.DataFrame, kind: str, words: str, hours: float) -> Claim:
    comparisons = [
        near(
            number(*_ratio(row, plain, kind)), 1.0, 0.05, f"m_C = {row['mass']:g}, phi = {row['particle_fraction']:.4f}"
        )
        for row, plain in _pairs(table)
    ]
    return judged(
        f"At a particle fraction the viscosity is the same whatever the mass of a constituent ({words}).",
        "section 4.4, fig. 8",
        "relative viscosity over that at m_C = 1 within 5 % of 1",
        comparisons,
        hours,
    )


def _not_mass(table: pd.DataFrame, kind: str, words: str, hours: float) -> Claim:
    """Nearer to the formula of the particle fraction than to that of the mass fraction."""
    comparisons = []
    for row, _ in _pairs(table):
        middle, name = 0.5 * (row["formula_particle"] + row["formula_mass"]), f"m_C = {row['mass']:g}"
        viscosity = number(row[kind], row[f"{kind}_error"])
        heavy = row["formula_mass"] > row["formula_particle"]
        comparisons.append(Comparison(viscosity, *((-np.inf, middle) if heavy else (middle, np.inf)), name))
    return judged(
        f"It is the particle fraction that has to be taken, not the mass fraction ({words}).",
        "section 4.5, after eq. 46",
        f"relative viscosity nearer to Krieger-Dougherty (phi_m = {PACKING}) of the particle fraction than of the mass "
        "fraction, at each mass but 1",
        comparisons,
        hours,
    )


def panels(findings: Findings) -> list[Panel]:
    """Against the mass of a constituent, pairwise and total; the two formulas."""
    table = findings.tables["mass"]
    found = []
    for bodies, of in table.sort_values("mass").groupby("bodies"):
        series = [
            Series(
                "pairwise (the paper's eq. 16)",
                of["mass"],
                of["relative_viscosity_pairwise"],
                of["relative_viscosity_pairwise_error"],
                color=COLORS[0],
            ),
            Series(
                "total",
                of["mass"],
                of["relative_viscosity"],
                of["relative_viscosity_error"],
                color=COLORS[1],
                marker="s",
            ),
            Series(
                "Krieger-Dougherty, particle fraction", of["mass"], of["formula_particle"], kind="line", color=COLORS[2]
            ),
            Series("Krieger-Dougherty, mass fraction", of["mass"], of["formula_mass"], kind="dashed", color=COLORS[4]),
        ]
        phi = of["particle_fraction"].iloc[0]
        found.append(
            Panel(
                f"{bodies} discs, $\\phi$ = {phi:.4f}",
                "mass of a constituent $m_C$ (mass)",
                r"relative viscosity $\eta_r$",
                series,
            )
        )
    return found
