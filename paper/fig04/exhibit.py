r"""Fig. 4: radial force of the constituents of a disc, 2D.

The paper (section 4.1) draws the radial component of the total conservative force, $\sum_i a\,(1 - r_i/r_c)\,\mathbf
e_i\cdot\mathbf e_o$, for discs of 3 and of 4 particles whose sites are 0.25 apart. It says that here too a cone is
obtained, that the size of the body grows with the distance of its sites, and that this distance must not be too
large, or solvent would get into the core.

Nothing is simulated. A solvent particle has the energy $\sum_i \frac{1}{2} a r_c (1 - r_i/r_c)^2$; what it is at the
center is the barrier of the core. By Boltzmann's factor alone g would be 0.01 where the energy is $kT\ln 100$; the
mean of that distance over all directions stands for the size when the distance of the sites is varied. It leaves out
the pressure of the solvent, which pushes particles further in, so it is no estimate of the size itself.

The radial force is zero at the very center, so it has a crater there that the sum of fig. 3 does not have. "Round"
and "cone" are the same numbers as in fig. 3, from 0.40 on, where solvent begins (Table 1, kT = 1).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tether.paper import Claim, Findings, Part, judged
from tether.paper.claim import Comparison
from tether.paper.contours import Landscape, draw_landscapes, plane
from tether.paper.numbers import number
from tether.shapes import Shape, square, triangle
from tether.theory.superposition import radial_repulsion

SHAPES = {"triangle": triangle(0.25), "square": square(0.25)}
SPACINGS = (0.15, 0.20, 0.25, 0.30, 0.40, 0.50, 0.60, 0.80)
REPULSION = 18.75
SIZE = 0.40  # the paper's Table 1: where solvent begins about a disc of 4, 2D, kT = 1
TOLERANCE = 5.0  # per cent


def evaluate(_: Mapping[str, Part]) -> Findings:
    """Computed: no runs."""
    profile = pd.concat([_profile(name, shape) for name, shape in SHAPES.items()])
    made = {"triangle": triangle, "square": square}
    spacing = pd.DataFrame([_of_spacing(name, d, make(d)) for name, make in made.items() for d in SPACINGS])
    straight, around, grows, barrier = [], [], [], []
    for name, shape in SHAPES.items():
        of = profile[profile["shape"] == name]
        height = float(of["greatest"].max())
        side = of[of["radius"].between(SIZE, 1.0 - shape.radius)]
        line = np.polynomial.Polynomial.fit(side["radius"], side["mean"], 1)
        off = float(np.max(np.abs(side["mean"] - line(side["radius"].to_numpy()))))
        straight.append(Comparison(number(100.0 * off / height), high=TOLERANCE, name=name))
        outside = of[of["radius"] >= SIZE]
        difference = float((outside["greatest"] - outside["least"]).max())
        around.append(Comparison(number(100.0 * difference / height), high=TOLERANCE, name=name))
        sizes = spacing[spacing["shape"] == name]["size"].to_numpy()
        grows.append(Comparison(number(np.diff(sizes).min()), low=0.0, name=f"least growth of size, {name}"))
        core = spacing[spacing["shape"] == name].set_index("spacing")["barrier"]
        steps = np.diff(core.to_numpy())
        barrier.append(Comparison(number(steps.max()), high=0.0, name=f"least fall of the barrier, {name}"))
        barrier.append(Comparison(number(core[0.25]), low=math.log(100.0), name=f"barrier at 0.25, {name}"))
    crater = ", ".join(f"{name}: summit at {_summit(profile, name):.2f}" for name in SHAPES)
    claims: list[Claim] = [
        judged(
            "A conical repulsion is obtained with 3 constituents and with 4.",
            "fig. 4, section 4.1",
            "largest distance of the mean force from a straight line, 0.40 to the rim, in % of the summit, below 5",
            straight,
        ).with_remark(f"a cone with a crater: the force falls to 0 at the center ({crater})"),
        judged(
            "The radial force is that of a round disc.",
            "fig. 4, section 4.1",
            "largest difference between directions at one distance from 0.40 on, in % of the summit, below 5",
            around,
        ),
        judged(
            "A larger distance between sites makes the particle larger.",
            "section 4.1",
            "the distance at which the energy is kT ln 100 (kT = 1) grows from spacing to spacing",
            grows,
        ),
        judged(
            "The distance between sites must not be large, or solvent gets into the core; 0.25 is not.",
            "section 4.1",
            "the energy at the center (kT = 1) falls from spacing to spacing, and is above ln 100 = 4.6 at 0.25",
            barrier,
        ),
    ]
    return Findings({"profile": profile, "spacing": spacing}, claims, ["Computed with constituents at their sites."])


def _profile(name: str, shape: Shape) -> pd.DataFrame:
    radius = np.linspace(0.02, 1.2, 60)
    force = np.asarray(radial_repulsion(np.multiply.outer(radius, _circle()), shape.sites, repulsion=REPULSION))
    least, mean, greatest = force.min(axis=1), force.mean(axis=1), force.max(axis=1)
    return pd.DataFrame({"shape": name, "radius": radius, "least": least, "mean": mean, "greatest": greatest})


def _summit(profile: pd.DataFrame, name: str) -> float:
    of = profile[profile["shape"] == name]
    return float(of["radius"].iloc[int(of["mean"].argmax())])


def _of_spacing(name: str, spacing: float, shape: Shape) -> dict[str, object]:
    """Energy at the center, and the mean distance over directions at which it is kT ln 100 for the last time."""
    radius = np.linspace(0.0, 1.5, 1501)
    energy = _energy(_circle()[::24, None, :] * radius[:, None], shape)  # direction, radius
    last = np.array([_last_crossing(radius, each - math.log(100.0)) for each in energy])
    return {
        "shape": name,
        "spacing": spacing,
        "barrier": float(_energy(np.zeros(2), shape)),
        "size": float(last.mean()),
    }


def _last_crossing(radius: NDArray[np.float64], above: NDArray[np.float64]) -> float:
    """Where a function on a grid falls through 0 for the last time, between two points by a straight line."""
    k = int(np.flatnonzero(above > 0.0)[-1])
    return float(radius[k] + (radius[k + 1] - radius[k]) * above[k] / (above[k] - above[k + 1]))


def _energy(points: NDArray[np.float64], shape: Shape) -> NDArray[np.float64]:
    """Of a solvent particle, shape (...)."""
    distance = np.linalg.norm(points[..., None, :] - shape.sites, axis=-1)
    return 0.5 * REPULSION * (np.maximum(1.0 - distance, 0.0) ** 2).sum(axis=-1)


def _circle() -> NDArray[np.float64]:
    angle = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    return np.column_stack([np.cos(angle), np.sin(angle)])


def draw(findings: Findings, stem: Path) -> list[Path]:
    """Contours, and the range over directions."""
    profile = findings.tables["profile"]
    landscapes = []
    for name, shape in SHAPES.items():
        of = profile[profile["shape"] == name]
        radius, least, mean, greatest = (of[column].to_numpy() for column in ("radius", "least", "mean", "greatest"))
        field = np.asarray(radial_repulsion(plane(), shape.sites, repulsion=REPULSION))
        title = f"{len(shape.sites)} constituents"
        landscapes.append(Landscape(title, shape.sites, field, radius, least, mean, greatest))
    return draw_landscapes(landscapes, r"$\Sigma\, a(1 - r_i/r_c)\,e_i\cdot e_o$ (force)", SIZE, stem)
