"""Fig. 1: the shapes of the bodies.

The paper (section 4.1) makes a disc of 3 or 4 DPD particles (triangle, square) and a sphere of 6 or 8 (octahedron,
cube), with nearest sites 0.25 apart, and asks for sites that stand axisymmetrically. Nothing is simulated: what a
solvent particle feels is computed with the constituents at their sites.

How round a body is, is a number here: the difference between the greatest and the least radial force over all
directions, in % of its mean, at the distance where solvent begins (0.40 in 2D and 0.63 in 3D, the paper's Table 1 at
kT = 1). That a body turns like a disc or a sphere is another: its moment of inertia has to be the same about every
axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tether.paper import Findings, Part, judged, near
from tether.paper.claim import Comparison
from tether.paper.numbers import number
from tether.plot.style import BLUE, DASHES, GRAY, SKY, VERMILION, save, style
from tether.shapes import Shape, cube, octahedron, square, triangle
from tether.theory.superposition import anisotropy

SHAPES = {"triangle": triangle(0.25), "square": square(0.25), "octahedron": octahedron(0.25), "cube": cube(0.25)}
SIZE = {2: 0.40, 3: 0.63}  # the paper's Table 1: where solvent begins, kT = 1


def evaluate(_: Mapping[str, Part]) -> Findings:
    """Computed: no runs."""
    sites = pd.concat([_sites(name, shape) for name, shape in SHAPES.items()])
    rows = []
    for name, shape in SHAPES.items():
        rows.append(
            {
                "shape": name,
                "constituents": len(shape.sites),
                "radius_of_sites": shape.radius,
                "nearest_sites": _nearest(shape),
                "solvent_begins": SIZE[shape.dimension],
                "anisotropy_per_cent": 100.0 * float(anisotropy(SIZE[shape.dimension], shape.sites, directions=20000)),
                "inertia_spread": _inertia_spread(shape),
            }
        )
    table = pd.DataFrame(rows)
    roundness = [Comparison(number(row["anisotropy_per_cent"]), high=5.0, name=str(row["shape"])) for row in rows]
    inertia = [near(number(row["inertia_spread"]), 0.0, 1e-9, str(row["shape"])) for row in rows]
    nearest = [near(number(row["nearest_sites"]), 0.25, 1e-9, str(row["shape"])) for row in rows]
    claims = [
        judged(
            "3 or 4 particles make a circular disc, 6 or 8 a sphere.",
            "fig. 1, section 4.1",
            "radial force differs between directions by less than 5 % of its mean where solvent begins",
            roundness,
        ),
        judged(
            "Sites stand axisymmetrically.",
            "section 4.1",
            "principal moments of inertia (2D: second moments) differ by less than 1e-9 of their mean",
            inertia,
        ),
        judged("Nearest sites are 0.25 apart.", "section 4.1", "0.25 within 1e-9", nearest),
    ]
    return Findings({"shapes": table, "sites": sites}, claims, ["Computed with constituents at their sites."])


def _sites(name: str, shape: Shape) -> pd.DataFrame:
    padded = np.zeros((len(shape.sites), 3))
    padded[:, : shape.dimension] = shape.sites
    return pd.DataFrame(padded, columns=["x", "y", "z"]).assign(shape=name, dimension=shape.dimension)


def _distances(sites: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.norm(sites[:, None] - sites, axis=-1) + 1e9 * np.eye(len(sites)))


def _nearest(shape: Shape) -> float:
    return float(_distances(shape.sites).min())


def _inertia_spread(shape: Shape) -> float:
    """(greatest - least)/mean of the second moments' eigenvalues: 0 where inertia is the same about every axis."""
    moments = np.linalg.eigvalsh(shape.sites.T @ shape.sites)
    return float(np.ptp(moments) / moments.mean())


def draw(findings: Findings, stem: Path) -> list[Path]:
    """Sites, the edges between nearest ones, and where solvent begins; three-dimensional ones seen from aside."""
    sites, shapes = findings.tables["sites"], findings.tables["shapes"].set_index("shape")
    with style():
        figure = Figure(figsize=(8.0, 8.2), layout="constrained")
        for axes, name in zip(figure.subplots(2, 2).ravel(), shapes.index, strict=True):
            of = sites[sites["shape"] == name]
            places = of[["x", "y", "z"]].to_numpy()
            seen = places if of["dimension"].iloc[0] == 2 else places @ _view()
            near_ones = np.argwhere(np.triu(_distances(places) < 1.01 * _distances(places).min()))
            for i, j in near_ones:
                axes.plot(*seen[[i, j], :2].T, color=GRAY, linewidth=0.9, zorder=1)
            order = np.argsort(seen[:, 2])
            axes.scatter(
                *seen[order, :2].T,
                s=160,
                c=[BLUE if z >= -1e-9 else SKY for z in seen[order, 2]],
                edgecolors="white",
                zorder=2,
            )
            turn, size = np.linspace(0.0, 2.0 * np.pi, 200), shapes.loc[name, "solvent_begins"]
            axes.plot(size * np.cos(turn), size * np.sin(turn), color=VERMILION, linewidth=1.0, linestyle=DASHES)
            axes.set_title(f"{str(name).capitalize()}: {len(of)} constituents, {int(of['dimension'].iloc[0])}D")
            axes.set_aspect("equal")
            axes.set_xlim(-0.72, 0.72)
            axes.set_ylim(-0.72, 0.72)
            axes.set_xlabel("length" if of["dimension"].iloc[0] == 3 else "$x$ (length)")
            axes.set_ylabel("length" if of["dimension"].iloc[0] == 3 else "$y$ (length)")
        figure.supxlabel("dashed: where solvent begins (the paper's Table 1, $kT$ = 1)", fontsize=8.5)
        return save(figure, stem)


def _view() -> NDArray[np.float64]:
    """Columns: to the right, upward and toward the viewer."""
    turn, tilt = np.radians(25.0), np.radians(20.0)
    about_y = np.array([[np.cos(turn), 0.0, np.sin(turn)], [0.0, 1.0, 0.0], [-np.sin(turn), 0.0, np.cos(turn)]])
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(tilt), -np.sin(tilt)], [0.0, np.sin(tilt), np.cos(tilt)]])
    return np.asarray((about_x @ about_y).T)
