r"""Fig. 3: superposed repulsions of the constituents of a disc, 2D.

The paper (section 4.1) draws the sum $\sum_i a\,(1 - r_i/r_c)$ over the constituents of a disc of 3 and of 4
particles whose sites are 0.25 apart, and says that it has the shape of a cone, which is why so few particles make a
disc.

Nothing is simulated: the sum is computed with the constituents at their sites. Below the contours stands the range of
the field over all directions, at each distance from the center. The circle is where the solvent begins: the distance
0.40 of the paper's Table 1 at kT = 1 (of the disc of 4). The field is a sum of magnitudes: no component of a force
(fig. 4 is) and no energy.

"Round" and "cone" are made numbers. Round: the greatest and least value over all directions differ by less than 5 %
of the greatest value anywhere. Cone: the mean over directions is within 5 % of that value of a straight line, from
the distance 0.25 to the rim.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from tether.paper import Claim, Findings, Part, judged
from tether.paper.claim import Comparison
from tether.paper.contours import Landscape, draw_landscapes, plane
from tether.paper.numbers import number
from tether.shapes import square, triangle
from tether.theory.superposition import summed_repulsion

SHAPES = {"triangle": triangle(0.25), "square": square(0.25)}
REPULSION = 18.75
SIZE = 0.40  # the paper's Table 1: where solvent begins about a disc of 4, 2D, kT = 1
TOLERANCE = 5.0  # per cent


def evaluate(_: Mapping[str, Part]) -> Findings:
    """Computed: no runs."""
    profile, round_ones, straight = [], [], []
    for name, shape in SHAPES.items():
        radius = np.linspace(0.0, 1.2, 61)
        angle = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
        circle = np.column_stack([np.cos(angle), np.sin(angle)])
        around = summed_repulsion(np.multiply.outer(radius, circle), shape.sites, repulsion=REPULSION)
        least, mean, greatest = around.min(axis=1), around.mean(axis=1), around.max(axis=1)
        columns = {"shape": name, "radius": radius, "least": least, "mean": mean, "greatest": greatest}
        profile.append(pd.DataFrame(columns))
        rim = 1.0 - shape.radius  # all sites reach as far as this
        height = float(greatest.max())
        round_ones.append(
            Comparison(number(100.0 * float(np.max(greatest - least)) / height), high=TOLERANCE, name=name)
        )
        side = (radius >= 0.25) & (radius <= rim)
        line = np.polynomial.Polynomial.fit(radius[side], mean[side], 1)
        off = float(np.max(np.abs(mean[side] - line(radius[side]))))
        straight.append(Comparison(number(100.0 * off / height), high=TOLERANCE, name=name))
    claims: list[Claim] = [
        judged(
            "A conical repulsion is obtained with 3 constituents and with 4.",
            "fig. 3, section 4.1",
            "largest distance from a straight line, in % of the summit, below 5",
            straight,
        ),
        judged(
            "The repulsion of a few constituents is that of a round disc.",
            "fig. 3, section 4.1",
            "largest difference between directions at one distance, in % of the summit, below 5",
            round_ones,
        ),
    ]
    return Findings({"profile": pd.concat(profile)}, claims, ["Computed with constituents at their sites."])


def draw(findings: Findings, stem: Path) -> list[Path]:
    """Contours, and the range over directions."""
    profile = findings.tables["profile"]
    landscapes = []
    for name, shape in SHAPES.items():
        of = profile[profile["shape"] == name]
        radius, least, mean, greatest = (of[column].to_numpy() for column in ("radius", "least", "mean", "greatest"))
        field = np.asarray(summed_repulsion(plane(), shape.sites, repulsion=REPULSION))
        title = f"{len(shape.sites)} constituents"
        landscapes.append(Landscape(title, shape.sites, field, radius, least, mean, greatest))
    return draw_landscapes(landscapes, r"$\Sigma\, a(1 - r_i/r_c)$ (force)", SIZE, stem)
