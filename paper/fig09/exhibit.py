r"""Fig. 9: the pore between three discs, and how small the solvent must be.

The paper (section 4.5): the pore between three equal discs in contact takes a disc of up to $a(2\sqrt3-3)/3$, so
solvent particles should be at least $3/(2\sqrt3-3)\approx 6.46$ times smaller than the bodies, or they interfere with
the densest packing. It explains by this why the maximum packing seems to fall with the temperature.

Nothing is simulated: these are numbers of geometry, and ratios of the sizes that the paper prints in Table 1 and
section 4.5 (what we measure of these sizes is in table1). The pore is found once more without the formula, by
shrinking a disc between three until it touches them all.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.optimize import minimize

from tether.paper import Claim, Findings, Part, exact, judged
from tether.paper.claim import Comparison
from tether.paper.numbers import number
from tether.plot.style import BLUE, GRAY, SKY, VERMILION, save, style

CENTERS = np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, math.sqrt(3.0)]])
PORE = (2.0 * math.sqrt(3.0) - 3.0) / 3.0
NEEDED = 1.0 / PORE
SOURCE = "section 4.5"
TABLE_1 = {
    "2D, kT = 1": (0.3995, 0.005, 80.0, 0.5),
    "2D, kT = 0.5": (0.44, 0.06, 7.3, 0.05),
    "2D, kT = 0.25": (0.465, 0.105, 4.4, 0.05),
    "3D, kT = 1": (0.605, 0.025, 24.2, 0.05),
    "3D, kT = 0.5": (0.64, 0.09, 7.1, 0.05),
    "3D, kT = 0.25": (0.675, 0.125, 5.4, 0.05),
}
"""Effective radii of body and solvent, their ratio as printed (24.2 is section 4.5's, Table 1 has 24), its rounding."""


def evaluate(_: Mapping[str, Part]) -> Findings:
    """Computed: no runs."""
    sizes = pd.DataFrame(
        [(name, body, solvent, body / solvent, NEEDED) for name, (body, solvent, _, _) in TABLE_1.items()],
        columns=["case", "body", "solvent", "ratio", "needed"],
    )
    pore, place = _largest_between()
    discs = pd.DataFrame([(*center, 1.0) for center in CENTERS] + [(*place, pore)], columns=["x", "y", "radius"])
    claims = [
        exact("The largest disc in the pore has the radius a(2 sqrt(3) - 3)/3.", SOURCE, pore, round(PORE, 6), 1e-5),
        exact("The smaller disc has to be 6.46 times smaller.", SOURCE, 1.0 / pore, 6.46, 0.005),
        *_ratios(),
        _condition(),
        exact(
            "Hexagonal packing of equal discs fills pi/sqrt(12) = 0.91.", SOURCE, math.pi / math.sqrt(12.0), 0.91, 0.005
        ),
        exact(
            "Hexagonal packing of equal spheres fills 0.71.", SOURCE, math.pi / math.sqrt(18.0), 0.71, 0.005
        ).with_remark("hexagonal close packing is pi/sqrt(18)"),
    ]
    return Findings({"discs": discs, "sizes": sizes}, claims, ["Computed; sizes are those printed in the paper."])


def _largest_between() -> tuple[float, tuple[float, float]]:
    """Radius and center of the largest disc between three of radius 1: it is as far from the nearest as can be."""
    middle = CENTERS.mean(axis=0)
    found = minimize(
        lambda place: -np.min(np.linalg.norm(CENTERS - place, axis=1)),
        middle + np.array([0.05, -0.03]),
        method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 2000},
    )
    return float(-found.fun) - 1.0, (float(found.x[0]), float(found.x[1]))


def _ratios() -> list[Claim]:
    """Of the printed sizes."""
    claims = [
        exact(
            f"Bodies are {printed:g} times as large as the solvent, {case}.",
            f"Table 1, {SOURCE}",
            body / solvent,
            printed,
            rounding,
        )
        for case, (body, solvent, printed, rounding) in TABLE_1.items()
    ]
    shrink = TABLE_1["2D, kT = 0.25"][1] / TABLE_1["2D, kT = 1"][1]
    return [
        *claims,
        exact("The solvent is 21 times smaller at kT = 1 than at kT = 0.25, 2D.", SOURCE, shrink, 21.0, 0.5),
        exact("Bodies of Pan et al. (2010a), 0.98 and 0.27, have a ratio of 3.6.", SOURCE, 0.98 / 0.27, 3.6, 0.05),
    ]


def _condition() -> Claim:
    """Is it met where the paper finds the usual packing, and does it tell that temperature from the next?"""
    ratios = {case: body / solvent for case, (body, solvent, _, _) in TABLE_1.items()}
    warm = [Comparison(number(ratio), low=NEEDED, name=case) for case, ratio in ratios.items() if case.endswith("= 1")]
    claim = judged(
        "At kT = 1 the solvent is small enough not to interfere with the packing.",
        SOURCE,
        "ratio of sizes above 6.46",
        warm,
    )
    met = [f"{ratio:.1f} in {case}" for case, ratio in ratios.items() if case.endswith("0.5") and ratio > NEEDED]
    if not met:
        return claim
    return claim.with_remark(
        f"it still is at kT = 0.5 ({', '.join(met)}), where the paper finds a lower maximum packing: that the "
        "condition is no longer met cannot be the reason"
    )


def draw(findings: Findings, stem: Path) -> list[Path]:
    """The pore, and the ratios of the paper's Table 1."""
    discs, sizes = findings.tables["discs"], findings.tables["sizes"]
    with style():
        figure = Figure(figsize=(9.4, 4.2), layout="constrained")
        left, right = figure.subplots(1, 2)
        turn = np.linspace(0.0, 2.0 * math.pi, 300)
        for number_, (x, y, radius) in enumerate(discs[["x", "y", "radius"]].to_numpy()):
            body = number_ < len(discs) - 1
            left.fill(
                x + radius * np.cos(turn),
                y + radius * np.sin(turn),
                facecolor=SKY if body else VERMILION,
                edgecolor=BLUE if body else VERMILION,
                alpha=0.6 if body else 0.9,
            )
        *_, (x, y, radius) = discs[["x", "y", "radius"]].to_numpy()
        left.annotate(
            f"{radius:.4f} $a$ = $a$/{1.0 / radius:.2f}",
            (x, y),
            xytext=(30, -6),
            textcoords="offset points",
            fontsize=8.5,
        )
        left.set_aspect("equal")
        left.set_title("Three discs of radius $a$ in contact")
        left.set_xlabel("$x$ ($a$)")
        left.set_ylabel("$y$ ($a$)")
        places = np.arange(len(sizes))
        right.barh(places, sizes["ratio"], color=[BLUE] * 3 + [SKY] * 3, height=0.6)
        right.set_yticks(places, sizes["case"])
        right.invert_yaxis()
        right.set_xscale("log")
        right.set_xlim(1.0, None)
        right.axvline(NEEDED, color=VERMILION, linewidth=1.2)
        right.annotate(
            "6.46",
            (NEEDED, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(3, -2),
            textcoords="offset points",
            fontsize=8.5,
            color=GRAY,
            va="top",
        )
        right.set_title("Body over solvent, the paper's Table 1")
        right.set_xlabel("ratio of effective radii")
        return save(figure, stem)
