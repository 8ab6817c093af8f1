"""Where particles are, and how fast, before the first step."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from tether.bodies import FILLED
from tether.config import Configuration
from tether.engines.cpu import principal_sites
from tether.errors import InputError
from tether.flows import imposed_velocity

Vectors = NDArray[np.float64]

_ROUNDS = 1000
"""Rounds of random places for bodies that did not fit yet, before the box is called full."""


def positions(configuration: Configuration, random: np.random.Generator) -> Vectors:
    """Solvent anywhere, bodies on a lattice or at random in random orientation; shape (n, d), unwrapped.

    No solvent is inside a body that is filled with sites or is one particle of a radius of its own.
    Raises InputError when the bodies' hulls of sites cannot be kept apart.
    """
    size = np.array(configuration.box.size)
    solvent = random.random((configuration.solvent_count, len(size))) * size
    if not configuration.bodies:
        return np.asarray(solvent)
    radii = [bodies.hull_in(configuration.dimension) for bodies in configuration.bodies]
    counts = configuration.body_counts
    if configuration.start.bodies == "lattice":
        centers = _on_lattice(counts, radii, size, random)
    else:
        centers = _at_random(counts, radii, size, random)
    constituents, turns = [], []
    for shape, at in zip(configuration.geometries, centers, strict=True):
        turns.append(_orientations(len(at), len(size), random))
        constituents.append(at[:, None, :] + np.einsum("bkl,pl->bpk", turns[-1], principal_sites(shape)))
    _leave_bodies(solvent, configuration, centers, turns, random)
    return np.concatenate([solvent, *(c.reshape(-1, len(size)) for c in constituents)])


def velocities(
    configuration: Configuration,
    at: Vectors,
    mass: NDArray[np.float64],
    shear_rate: float,
    random: np.random.Generator,
) -> Vectors:
    """Maxwellian velocities about the linear profile of a shear rate, without net momentum against it; shape (n, d).

    at: positions inside the box, shape (n, d). mass: shape (n,).
    """
    v = random.standard_normal(at.shape) * np.sqrt(configuration.fluid.temperature / mass)[:, None]
    v -= (mass[:, None] * v).sum(axis=0) / mass.sum()
    v[:, 0] += imposed_velocity(shear_rate, at[:, 1], configuration.box.size[1])
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
    """All kinds mixed on one lattice; where the largest would not fit there, a lattice for each size."""
    points = lattice(sum(counts), size)
    if len(counts) > 1:
        points = random.permutation(points)
    if _are_apart(points, np.repeat(radii, counts), size):
        return np.split(points, np.cumsum(counts)[:-1])
    if len(set(radii)) == 1:
        nearest = cKDTree(points, boxsize=size).query(points, k=2)[0][:, 1].min()
        raise _too_many(sum(counts), 2 * max(radii), f"on a lattice they stand {nearest:.3g} apart")
    return _on_lattices(counts, radii, size)


def _on_lattices(counts: Sequence[int], radii: Sequence[float], size: Vectors) -> list[Vectors]:
    """The largest bodies on a lattice of their own, then the smaller in the gaps, on the coarsest that has room."""
    centers = [np.empty((0, len(size))) for _ in counts]
    for kind in np.argsort(radii, kind="stable")[::-1]:
        places = counts[kind]
        while True:
            points = lattice(places, size)
            if not _are_apart(points, np.full(places, radii[kind]), size):
                raise _too_many(sum(counts), 2 * radii[kind], "on lattices no more find room")
            points = _free(points, radii[kind], centers, radii, size)
            if len(points) >= counts[kind]:
                break
            places = max(places + 1, int(1.1 * places))
        centers[kind] = points[np.arange(counts[kind]) * len(points) // counts[kind]]
    return centers


def _are_apart(points: Vectors, radii: Vectors, size: Vectors) -> bool:
    """Whether no two spheres of these radii overlap."""
    pairs = cKDTree(points, boxsize=size).query_pairs(2 * radii.max(), output_type="ndarray")
    apart = np.abs(points[pairs[:, 0]] - points[pairs[:, 1]])
    distance = np.linalg.norm(np.minimum(apart, size - apart), axis=1)
    return bool(np.all(distance >= radii[pairs].sum(axis=1)))


def _free(points: Vectors, radius: float, centers: Sequence[Vectors], radii: Sequence[float], size: Vectors) -> Vectors:
    """The points at which a sphere of that radius overlaps none of those about the centers."""
    for there, other in zip(centers, radii, strict=True):
        if len(there) and len(points):
            points = points[cKDTree(there, boxsize=size).query(points)[0] >= radius + other]
    return points


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
            proposed = _free(proposed, radii[kind], centers, radii, size)
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


def _orientations(count: int, dimension: int, random: np.random.Generator) -> Vectors:
    """`count` random rotations, matrices that turn a body's axes into the box's; shape (count, d, d)."""
    if dimension == 3:
        return np.asarray(Rotation.from_quat(random.standard_normal((count, 4))).as_matrix())
    angle = random.random(count) * 2 * math.pi
    return np.moveaxis(np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]), 2, 0)


def _leave_bodies(
    solvent: Vectors,
    configuration: Configuration,
    centers: Sequence[Vectors],
    turns: Sequence[Vectors],
    random: np.random.Generator,
) -> None:
    """Give solvent that is inside a body another place, anywhere outside; in place.

    The sites of a large body close it: what is inside at the start would stay there.
    """
    size = np.array(configuration.box.size)
    closed = [
        (at, turn, np.array(bodies.semiaxes or [bodies.radius] * len(size)))
        for bodies, at, turn in zip(configuration.bodies, centers, turns, strict=True)
        if bodies.model == "single" or bodies.shape in FILLED
    ]
    moved = np.arange(len(solvent))
    for _ in range(_ROUNDS):
        inside = np.zeros(len(moved), dtype=bool)
        for at, turn, semiaxes in closed:
            inside |= _inside(solvent[moved], at, turn, semiaxes, size)
        moved = moved[inside]
        if len(moved) == 0:
            return
        solvent[moved] = random.random((len(moved), len(size))) * size
    widest = 2 * max(semiaxes.max() for _, _, semiaxes in closed)
    raise _too_many(sum(configuration.body_counts), widest, "solvent finds no room between them")


def _inside(points: Vectors, centers: Vectors, turns: Vectors, semiaxes: Vectors, size: Vectors) -> NDArray[np.bool_]:
    """Which points are within one of the turned ellipsoids about the centers; shape (points,)."""
    inside = np.zeros(len(points), dtype=bool)
    near = cKDTree(points, boxsize=size).query_ball_point(centers, semiaxes.max())
    for center, turn, which in zip(centers, turns, near, strict=True):
        apart = points[which] - center
        apart -= size * np.round(apart / size)
        inside[which] |= ((apart @ turn / semiaxes) ** 2).sum(axis=1) < 1
    return inside


def _too_many(count: int, diameter: float, why: str) -> InputError:
    return InputError(
        f"{count} bodies cannot be placed",
        f"their hulls of sites are {diameter:.3g} wide and {why}",
        "ask for fewer bodies or give a larger box",
        key=("bodies",),
    )
