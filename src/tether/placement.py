"""Where particles are, and how fast, before the first step."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from tether.config import Configuration
from tether.engines.cpu import principal_sites
from tether.errors import InputError

Vectors = NDArray[np.float64]

_ROUNDS = 1000
"""Rounds of random places for bodies that did not fit yet, before the box is called full."""


def positions(configuration: Configuration, random: np.random.Generator) -> Vectors:
    """Solvent anywhere, bodies on a lattice or at random in random orientation; shape (n, d), unwrapped.

    Raises InputError when the bodies' hulls of sites cannot be kept apart.
    """
    size = np.array(configuration.box.size)
    solvent = random.random((configuration.solvent_count, len(size))) * size
    if not configuration.bodies:
        return np.asarray(solvent)
    radii = [bodies.geometry.radius for bodies in configuration.bodies]
    counts = configuration.body_counts
    if configuration.start.bodies == "lattice":
        centers = _on_lattice(counts, radii, size, random)
    else:
        centers = _at_random(counts, radii, size, random)
    constituents = []
    for bodies, at in zip(configuration.bodies, centers, strict=True):
        sites = principal_sites(bodies.geometry)
        constituents.append(at[:, None, :] + _turned(sites, len(at), random))
    return np.concatenate([solvent, *(c.reshape(-1, len(size)) for c in constituents)])


def velocities(
    configuration: Configuration, at: Vectors, mass: NDArray[np.float64], random: np.random.Generator
) -> Vectors:
    """Maxwellian velocities about the flow's linear profile, without net momentum against it; shape (n, d).

    at: positions inside the box, shape (n, d). mass: shape (n,).
    """
    v = random.standard_normal(at.shape) * np.sqrt(configuration.fluid.temperature / mass)[:, None]
    v -= (mass[:, None] * v).sum(axis=0) / mass.sum()
    v[:, 0] += configuration.flow.velocity(at[:, 1], configuration.box.size[1])
    return v


def lattice(count: int, size: Sequence[float] | NDArray[np.float64]) -> Vectors:
    """`count` points on the coarsest near-cubic lattice that has room for them, vacancies spread evenly.

    Shape (count, d), inside the box.
    """
    sides = np.asarray(size, dtype=np.float64)
    cells = np.maximum(1, np.floor(sides * (count / sides.prod()) ** (1 / len(sides)) * (1 + 1e-9)))
    while cells.prod() < count:
        cells[np.argmax(sides / cells)] += 1
    places = int(cells.prod())
    chosen = np.arange(count) * places // count
    index = np.stack(np.unravel_index(chosen, tuple(int(n) for n in cells)), axis=1)
    at: Vectors = (index + 0.5) * sides / cells
    return at


def _on_lattice(
    counts: Sequence[int], radii: Sequence[float], size: Vectors, random: np.random.Generator
) -> list[Vectors]:
    points = lattice(sum(counts), size)
    if len(points) > 1:
        nearest = cKDTree(points, boxsize=size).query(points, k=2)[0][:, 1].min()
        if nearest < 2 * max(radii):
            raise _too_many(sum(counts), 2 * max(radii), f"on a lattice they stand {nearest:.3g} apart")
    if len(counts) > 1:
        points = random.permutation(points)
    return np.split(points, np.cumsum(counts)[:-1])


def _at_random(
    counts: Sequence[int], radii: Sequence[float], size: Vectors, random: np.random.Generator
) -> list[Vectors]:
    """Random sequential addition, the largest bodies first: spheres about the sites never overlap."""
    centers = [np.empty((0, len(size))) for _ in counts]
    for kind in np.argsort(radii)[::-1]:
        for _ in range(_ROUNDS):
            wanted = counts[kind] - len(centers[kind])
            if wanted == 0:
                break
            proposed = random.random((wanted, len(size))) * size
            for other, there in enumerate(centers):
                if len(there) and len(proposed):
                    distance = cKDTree(there, boxsize=size).query(proposed)[0]
                    proposed = proposed[distance >= radii[kind] + radii[other]]
            centers[kind] = np.concatenate([centers[kind], _thinned(proposed, 2 * radii[kind], size)])
        else:
            raise _too_many(sum(counts), 2 * radii[kind], "at random no more find room")
    return centers


def _thinned(points: Vectors, apart: float, size: Vectors) -> Vectors:
    """The points of which none is nearer than `apart` to an earlier one that was kept."""
    kept = np.ones(len(points), dtype=bool)
    pairs = cKDTree(points, boxsize=size).query_pairs(apart, output_type="ndarray") if len(points) else []
    for first, second in sorted(map(tuple, np.sort(pairs, axis=1))) if len(pairs) else []:
        if kept[first]:
            kept[second] = False
    return points[kept]


def _turned(sites: Vectors, count: int, random: np.random.Generator) -> Vectors:
    """The sites in `count` random orientations; shape (count, p, d)."""
    if sites.shape[1] == 3:
        matrices = Rotation.from_quat(random.standard_normal((count, 4))).as_matrix()
    else:
        angle = random.random(count) * 2 * math.pi
        matrices = np.moveaxis(np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]), 2, 0)
    turned: Vectors = np.einsum("bkl,pl->bpk", matrices, sites)
    return turned


def _too_many(count: int, diameter: float, why: str) -> InputError:
    return InputError(
        f"{count} bodies cannot be placed",
        f"their hulls of sites are {diameter:.3g} wide and {why}",
        "ask for fewer bodies or give a larger box",
        key=("bodies",),
    )
