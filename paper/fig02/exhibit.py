r"""Fig. 2: the spring model.

The paper (section 3) ties the constituents of a body, DPD particles like all others, by stiff springs to the
reference sites of a rigid base, which moves by Newton's and Euler's equations (eq. 23-35). The sketch shows a disc of
4.

Here the statements of section 3 are tested that can be computed without a simulation. What springs do in a simulation
is in section4.3, which base holds the temperature in fig19.

- Spring and constraint forces drop out of the net force and torque (eq. 31-32). For the springs' torque about the
  center this is so where the constituent's spring pulls at its site, along the line between the two, as it does.
- Eq. 34 has a gyroscopic term, $\mathbf I\,d\boldsymbol\omega/dt = \mathbf T + \boldsymbol\omega\times(\mathbf
  I\boldsymbol\omega)$. Its sign is that of no frame: a free body keeps its angular momentum only with a minus. We
  turn a free body of three different moments of inertia by both. The term vanishes in 2D, and where inertia is the
  same about every axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from tether.paper import Claim, Findings, Part, judged, near
from tether.paper.numbers import number
from tether.plot.style import BLUE, GRAY, SKY, VERMILION, save, style
from tether.shapes import Shape, cube, octahedron, square

SOURCE = "section 3"
STIFFNESS = 3000.0
INERTIA = np.array([1.0, 2.0, 3.0])  # of the free body
SPIN = np.array([1.0, 0.5, 0.3])  # at the start


def evaluate(_: Mapping[str, Part]) -> Findings:
    """Computed: no runs."""
    sketch = _sketch(square(0.25))
    turning = pd.concat([_free_body(sign) for sign in (+1.0, -1.0)])
    return Findings({"sketch": sketch, "free_body": turning}, [_pairwise(sketch), _gyroscopic(turning)], [])


def _sketch(shape: Shape) -> pd.DataFrame:
    """A base that is turned and moved, and constituents beside their sites, more than in a simulation."""
    turn = 0.3
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    sites = shape.sites @ rotation.T
    constituents = sites + np.array([[-0.06, -0.05], [0.05, 0.06], [-0.06, 0.03], [0.07, -0.04]])
    return pd.DataFrame(np.hstack([sites, constituents]), columns=["site_x", "site_y", "x", "y"])


def _pairwise(sketch: pd.DataFrame) -> Claim:
    """Forces on constituents and sites together, and their torque about the body's center."""
    sites, constituents = sketch[["site_x", "site_y"]].to_numpy(), sketch[["x", "y"]].to_numpy()
    on_constituents = -STIFFNESS * (constituents - sites)
    center = constituents.mean(axis=0)
    torque = _cross(constituents - center, on_constituents) + _cross(sites - center, -on_constituents)
    size = float(np.abs(on_constituents).max())
    return judged(
        "Spring forces are absent from the net force and torque of a body.",
        f"{SOURCE}, eq. 29-32",
        "their torque on constituents and sites together, over the largest force, is 0 within 1e-12",
        [near(number(float(abs(torque.sum())) / size), 0.0, 1e-12, "torque")],
    )


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _free_body(sign: float) -> pd.DataFrame:
    """Angular momentum in the laboratory of a body without torque, by I dw/dt = sign w x (I w).

    The axes of the body turn with the spin; the equation is taken in them, where its inertia is constant.
    """

    def slope(_: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        spin, axes = state[:3], state[3:].reshape(3, 3)  # axes: columns, the body's axes in the laboratory
        change = sign * np.cross(spin, INERTIA * spin) / INERTIA
        cross = np.array([[0.0, -spin[2], spin[1]], [spin[2], 0.0, -spin[0]], [-spin[1], spin[0], 0.0]])
        return np.concatenate([change, (axes @ cross).ravel()])

    start = np.concatenate([SPIN, np.eye(3).ravel()])
    times = np.linspace(0.0, 20.0, 201)
    found = solve_ivp(slope, (0.0, 20.0), start, t_eval=times, rtol=1e-11, atol=1e-12)
    momentum = np.array([state[3:].reshape(3, 3) @ (INERTIA * state[:3]) for state in found.y.T])
    change = np.linalg.norm(momentum - momentum[0], axis=1) / np.linalg.norm(momentum[0])
    return pd.DataFrame({"sign": int(sign), "time": times, "change": change})


def _gyroscopic(turning: pd.DataFrame) -> Claim:
    greatest = turning.groupby("sign")["change"].max()
    largest = max(_term(shape) for shape in (octahedron(0.25), cube(0.25)))
    claim = judged(
        "The base turns by I dw/dt = T + w x (I w).",
        f"{SOURCE}, eq. 34",
        "without torque the angular momentum in the laboratory changes by less than 1e-6 of itself in 20 units of time",
        [near(number(greatest[+1]), 0.0, 1e-6, "largest change")],
    )
    remark = f"the sign has to be a minus (largest change then {greatest[-1]:.0e})"
    if largest < 1e-12:
        remark += (
            "; no result of the paper changes, since the term is 0 in 2D and, by rounding, for octahedron and cube"
        )
    return claim.with_remark(remark)


def _term(shape: Shape) -> float:
    """The largest of the gyroscopic term over I w^2, over some directions of the spin."""
    sites = shape.sites
    inertia = (sites**2).sum() * np.eye(3) - sites.T @ sites
    spins = np.random.default_rng(1).normal(size=(100, 3))
    spins /= np.linalg.norm(spins, axis=1, keepdims=True)
    terms = np.linalg.norm(np.cross(spins, spins @ inertia), axis=1)
    return float(terms.max() / np.trace(inertia) * 3.0)


def draw(findings: Findings, stem: Path) -> list[Path]:
    """The sketch; and what the sign in eq. 34 does."""
    sketch, turning = findings.tables["sketch"], findings.tables["free_body"]
    with style():
        figure = Figure(figsize=(9.4, 4.4), layout="constrained")
        left, right = figure.subplots(1, 2)
        corners = sketch[["site_x", "site_y"]].to_numpy()
        center = corners.mean(axis=0)
        around = corners[np.argsort(np.arctan2(*(corners - center).T[::-1]))]
        left.fill(*around.T, facecolor=SKY, alpha=0.25, edgecolor=GRAY, linewidth=1.0, label="rigid base")
        for row in sketch.itertuples():
            left.plot(*_spring((row.site_x, row.site_y), (row.x, row.y)), color=GRAY, linewidth=0.8)
        left.plot(sketch["site_x"], sketch["site_y"], "s", color=VERMILION, markersize=7, label="reference sites")
        left.plot(
            sketch["x"], sketch["y"], "o", color=BLUE, markersize=11, alpha=0.85, label="constituents, DPD particles"
        )
        left.plot([], [], color=GRAY, linewidth=0.8, label="springs")
        left.set_aspect("equal")
        left.margins(0.25)
        left.set_title("A disc of 4 (displacements enlarged)")
        left.set_xlabel("$x$ (length)")
        left.set_ylabel("$y$ (length)")
        left.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=2)
        for sign, color, words in ((1, VERMILION, "plus, as in eq. 34"), (-1, BLUE, "minus")):
            of = turning[turning["sign"] == sign]
            right.plot(of["time"], of["change"], color=color, label=words)
        right.set_title("A free body of inertia 1, 2, 3")
        right.set_xlabel("time")
        right.set_ylabel("change of its angular momentum / itself")
        right.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=2)
        return save(figure, stem)


def _spring(start: tuple[float, float], end: tuple[float, float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A zigzag from one point to another."""
    a, b = np.array(start), np.array(end)
    along = np.linspace(0.0, 1.0, 13)
    aside = np.zeros(13)
    aside[2:-2] = 0.006 * np.where(np.arange(9) % 2, 1.0, -1.0)
    normal = np.array([-(b - a)[1], (b - a)[0]]) / np.linalg.norm(b - a)
    line = a + along[:, None] * (b - a) + aside[:, None] * normal
    return line[:, 0], line[:, 1]
