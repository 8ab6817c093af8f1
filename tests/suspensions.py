"""Small suspensions for the tests of the core, shapes, and the physics written a second time in NumPy.

The second writing is the plain one: every pair is visited, every image is looked at, nothing is sorted. It shares
no code with the core but the noise of a pair, which has tests of its own.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from tether import _core

Array = NDArray[np.float64]
Engine = _core.CpuEngine2 | _core.CpuEngine3

pair_terms = ("conservative", "dissipative", "random")


# Shapes


def principal(sites: Array) -> Array:
    """The sites about their centroid and along the principal axes of their inertia, as the core wants them."""
    arms = np.asarray(sites, dtype=float) - np.mean(sites, axis=0)
    if arms.shape[1] == 2:
        return arms
    _, axes = np.linalg.eigh(arms.T @ arms)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    return arms @ axes


square = 0.125 * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
cube = 0.125 * np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
rod = 0.25 * np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
crooked = principal(  # three different principal moments, no symmetry
    np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.05, 0.2], [0.6, 0.1, 0.1]])
)
crooked_flat = principal(np.array([[0.0, 0.0], [0.5, 0.0], [0.1, 0.3]]))


def turn(generator: np.random.Generator, dimension: int) -> Array:
    """A rotation matrix, uniform over all."""
    q, r = np.linalg.qr(generator.standard_normal((dimension, dimension)))
    q = q * np.sign(np.diag(r))
    if np.linalg.det(q) < 0.0:
        q[:, 0] *= -1.0
    return q


# Places

places = ("anywhere", "clumps", "faces", "points")


def scattered(generator: np.random.Generator, kind: str, count: int, size: Sequence[float], cutoff: float) -> Array:
    """Positions inside the box where a pair loop may stumble: anywhere, in clumps, on the faces of the rows and bins
    that it cuts the box into (and a rounding off), on few points.
    """
    length = np.asarray(size, dtype=float)
    shape = (count, len(length))
    if kind == "anywhere":
        position = generator.random(shape) * length
    elif kind == "clumps":
        centers = generator.random((3, len(length))) * length
        position = centers[generator.integers(0, 3, count)] + 0.3 * cutoff * generator.standard_normal(shape)
    elif kind == "faces":
        rows = length / np.maximum(3, np.floor(length / cutoff))
        bins = length / np.maximum(12, np.floor(4.0 * length / cutoff))
        width = np.where(generator.random(shape) < 0.5, rows, bins)
        position = generator.integers(0, 60, shape) * width
        position = np.nextafter(position, generator.choice([-math.inf, math.inf], shape))
        position = np.where(generator.random(shape) < 0.5, position, generator.random(shape) * length)
    else:
        position = generator.integers(0, 5, shape) / 5.0 * length
    position = np.mod(position, length)
    return np.where(position < length, position, 0.0)


# Engines


@dataclass(frozen=True)
class Kind:
    """Bodies of one shape. Those of base "rigid" have no springs."""

    sites: Array
    count: int
    base: str = "massless"
    stiffness: float = 3000.0
    torque_arms: str = "constituents"


def engine(
    size: Sequence[float],
    species: Sequence[int] | NDArray[np.uint8],
    *,
    kinds: Sequence[Kind] = (),
    timestep: float = 0.01,
    shear_rate: float = 0.0,
    repulsion: float = 18.75,
    temperature: float = 1.0,
    friction: float = 4.5,
    noise: float | None = None,
    cutoff: float = 1.0,
    exponent: float = 0.5,
    random: str = "uniform",
    verlet_lambda: float = 0.5,
    seed: int = 1,
    species_mass: Sequence[float] = (1.0, 1.0),
    pairs: str = "packed",
    precision: str = "double",
    instruction_set: str = "",
    threads: int = 1,
    laws: Array | None = None,
    **flow: object,
) -> Engine:
    """An engine without positions; noise None follows from sigma^2 = 2 gamma kT. laws: of all pairs of species, instead
    of one for all; flow: stages, oscillation, driving with force and periods.
    """
    build = _core.CpuEngine2 if len(size) == 2 else _core.CpuEngine3
    made = build(
        size=list(size),
        shear_rate=shear_rate,
        laws=np.array(
            [[[repulsion, friction, math.sqrt(2.0 * friction * temperature) if noise is None else noise, cutoff, 0.0]]]
        )
        if laws is None
        else laws,
        exponent=exponent,
        random=random,
        timestep=timestep,
        verlet_lambda=verlet_lambda,
        seed=seed,
        species_mass=list(species_mass),
        species=np.asarray(species, dtype=np.uint8),
        pairs=pairs,
        precision=precision,
        instruction_set=instruction_set or os.environ.get("TETHER_INSTRUCTION_SET", ""),
        threads=threads,
        **flow,
    )
    first = int(np.count_nonzero(np.asarray(species) == 0))
    for kind in kinds:
        bodies = {"sites": kind.sites, "count": kind.count, "first": first, "mass": species_mass[1]}
        if kind.base == "rigid":
            made.add_rigid_bodies(**bodies)
        else:
            made.add_tethered_bodies(**bodies, stiffness=kind.stiffness, base=kind.base, torque_arms=kind.torque_arms)
        first += kind.count * len(kind.sites)
    return made


def suspension(
    size: Sequence[float],
    *,
    kinds: Sequence[Kind] = (),
    density: float = 4.0,
    temperature: float = 1.0,
    shear_rate: float = 0.0,
    seed: int = 1,
    species_mass: Sequence[float] = (1.0, 1.0),
    gentle_steps: int = 200,
    **options: object,
) -> Engine:
    """A suspension ready to run: solvent at random, bodies on a lattice in random orientation, gently relaxed,
    with Maxwellian velocities about the imposed profile and no total momentum.
    """
    generator = np.random.default_rng(seed)
    length = np.asarray(size, dtype=float)
    dimension = len(length)
    solvent = round(density * float(np.prod(length)))
    rows = [generator.random((solvent, dimension)) * length]
    bodies = sum(kind.count for kind in kinds)
    side = math.ceil(bodies ** (1.0 / dimension)) if bodies else 0
    lattice = (
        np.stack(np.meshgrid(*[np.arange(side) + 0.5] * dimension), axis=-1).reshape(-1, dimension) / max(side, 1)
    ) * length
    centers = iter(lattice[generator.permutation(len(lattice))])
    for kind in kinds:
        rows += [next(centers) + kind.sites @ turn(generator, dimension).T for _ in range(kind.count)]
    position = np.concatenate(rows)
    species = np.repeat([0, 1], [solvent, len(position) - solvent])
    made = engine(
        size,
        species,
        kinds=kinds,
        temperature=temperature,
        shear_rate=shear_rate,
        seed=seed,
        species_mass=species_mass,
        **options,  # type: ignore[arg-type]
    )
    made.position = np.mod(position, length)
    if gentle_steps:
        made.start_gently(0, gentle_steps, 0.01)
    mass = np.asarray(species_mass)[species][:, None]
    velocity = generator.standard_normal(position.shape) * np.sqrt(temperature / mass)
    velocity -= (mass * velocity).sum(axis=0) / mass.sum()
    velocity[:, 0] += shear_rate * (made.position[:, 1] - 0.5 * length[1])
    made.velocity = velocity
    made.place()
    return made


def measured(made: Engine, samples: Array) -> dict[str, Array]:
    """The rows that run() returned, by name; stresses as (samples, D, D), scalars as (samples,)."""
    dimension = made.position.shape[1]
    named: dict[str, Array] = {}
    start = 0
    for name, width in made.columns:
        values = samples[:, start : start + width]
        named[name] = values.reshape(-1, dimension, dimension) if name.startswith("stress") else values
        if width == 1:
            named[name] = values[:, 0]
        start += width
    assert start == samples.shape[1]
    return named


def total_stress(named: dict[str, Array]) -> Array:
    """(samples, D, D): all but the random term."""
    return sum(named[f"stress_{term}"] for term in ("kinetic", "conservative", "dissipative", "body"))


# Statistics


def mean_and_error(series: Array, blocks: int = 20) -> tuple[float, float]:
    """Mean of a stationary series and its standard error from the means of long blocks."""
    means = np.array([block.mean() for block in np.array_split(series, blocks)])
    return float(series.mean()), float(means.std(ddof=1) / math.sqrt(blocks))


def limit(false_alarm: float, comparisons: int = 1, blocks: int = 20) -> float:
    """How many standard errors (from 20 blocks) off a correct mean is with probability `false_alarm`, at least once
    in so many comparisons (Student's t, both sides, Bonferroni).
    """
    return float(student.isf(0.5 * false_alarm / comparisons, blocks - 1))


# The physics a second time


def images(separation: Array, size: Sequence[float], offset: float) -> list[tuple[Array, int]]:
    """Every image of r_i - r_j that can be the nearest, with the rows that it was moved by; i, j inside the box."""
    length = np.asarray(size, dtype=float)
    found = []
    for row in (-1, 0, 1):
        for x in (-2, -1, 0, 1, 2):
            for z in (-1, 0, 1) if len(length) == 3 else (0,):
                shift = np.array([row * offset + x * length[0], row * length[1], z * length[-1]])[: len(length)]
                found.append((separation - shift, row))
    return found


@dataclass(frozen=True)
class Pairs:
    """Pairs i < j within the cutoff: ids (n,), separations r_i - r_j (n, D), and what the image of j moves faster
    than j (n,).
    """

    i: NDArray[np.intp]
    j: NDArray[np.intp]
    separation: Array
    image_velocity: Array


def every_pair(
    position: Array, size: Sequence[float], *, shear_rate: float = 0.0, offset: float = 0.0, cutoff: float = 1.0
) -> Pairs:
    """By looking at every image of every pair."""
    i, j = np.triu_indices(len(position), 1)
    parts = []
    for separation, row in images(position[i] - position[j], size, offset):
        near = np.einsum("nk,nk->n", separation, separation) < cutoff**2
        velocity = np.full(np.count_nonzero(near), row * shear_rate * size[1])
        parts.append((i[near], j[near], separation[near], velocity))
    i, j, separation, velocity = (np.concatenate(column) for column in zip(*parts, strict=True))
    order = np.lexsort((j, i))
    return Pairs(i[order], j[order], separation[order], velocity[order])


@dataclass(frozen=True)
class Fluid:
    """Parameters of eq. 1-15 of the paper; sigma^2 = 2 gamma kT."""

    repulsion: float = 18.75
    friction: float = 4.5
    temperature: float = 1.0
    cutoff: float = 1.0
    exponent: float = 0.5
    random: str = "uniform"

    @property
    def options(self) -> dict[str, object]:
        return dict(vars(self))


def pair_forces(
    fluid: Fluid,
    position: Array,
    velocity: Array,
    size: Sequence[float],
    *,
    timestep: float,
    seed: int,
    step: int,
    shear_rate: float = 0.0,
    offset: float = 0.0,
) -> tuple[Array, Array]:
    """DPD forces (n, D), and the stress of each of the three terms (3, D, D), by the equations as printed."""
    return species_forces(
        law_table([[(fluid.repulsion, fluid.friction, fluid.cutoff, 0.0)]], fluid.temperature),
        np.zeros(len(position), dtype=np.uint8),
        position,
        velocity,
        size,
        exponent=fluid.exponent,
        random=fluid.random,
        timestep=timestep,
        seed=seed,
        step=step,
        shear_rate=shear_rate,
        offset=offset,
    )


def law_table(rows: Sequence[Sequence[Sequence[float]]], temperature: float = 1.0) -> Array:
    """(species, species, 5) of repulsion, friction, noise, cutoff and steepness, as engines take it, from (repulsion,
    friction, cutoff, steepness) of each pair of species; sigma^2 = 2 gamma kT of each pair.
    """
    repulsion, friction, cutoff, steepness = np.moveaxis(np.array(rows, dtype=float), 2, 0)
    return np.stack([repulsion, friction, np.sqrt(2.0 * friction * temperature), cutoff, steepness], axis=2)


def conservative_force(repulsion: Array, steepness: Array, distance: Array) -> Array:
    """a (1 - r), or a (exp(-b r) - exp(-b)) / (1 - exp(-b)) where b > 0; r in units of the pair's cutoff."""
    b = np.where(steepness > 0.0, steepness, 1.0)
    steep = np.exp(-b * distance) * -np.expm1(-b * (1.0 - distance)) / -np.expm1(-b)
    return repulsion * np.where(steepness > 0.0, steep, 1.0 - distance)


def species_forces(
    laws: Array,
    species: NDArray[np.uint8],
    position: Array,
    velocity: Array,
    size: Sequence[float],
    *,
    timestep: float,
    seed: int,
    step: int,
    exponent: float = 0.5,
    random: str = "uniform",
    shear_rate: float = 0.0,
    offset: float = 0.0,
) -> tuple[Array, Array]:
    """The same where each pair of species has a law of its own, from a table as engines take it."""
    pairs = every_pair(position, size, shear_rate=shear_rate, offset=offset, cutoff=float(laws[:, :, 3].max()))
    distance = np.linalg.norm(pairs.separation, axis=1)
    direction = pairs.separation / distance[:, None]
    relative = velocity[pairs.i] - velocity[pairs.j]
    relative[:, 0] -= pairs.image_velocity
    xi = _core.pair_noise(seed, step, pairs.i.astype(np.uint32), pairs.j.astype(np.uint32), random)
    repulsion, friction, noise, cutoff, steepness = laws[species[pairs.i], species[pairs.j]].T
    inside = distance < cutoff
    w = np.where(inside, 1.0 - distance / cutoff, 0.0)
    magnitude = np.stack(
        [
            conservative_force(repulsion, steepness, 1.0 - w),
            -friction * w**exponent * np.einsum("nk,nk->n", direction, relative),
            noise * w ** (exponent / 2.0) * xi / math.sqrt(timestep),
        ]
    )
    force = np.zeros_like(position)
    pull = magnitude.sum(axis=0)[:, None] * direction
    np.add.at(force, pairs.i, pull)
    np.subtract.at(force, pairs.j, pull)
    stress = -np.einsum("tn,nk,nl->tkl", magnitude, direction, pairs.separation) / float(np.prod(size))
    return force, stress


def kabsch(reference: Array, actual: Array) -> Array:
    """The rotation (D, D) that turns the reference onto the actual points best, by singular value decomposition."""
    u, _, vh = np.linalg.svd(actual.T @ reference)
    flip = np.ones(len(u))
    flip[-1] = np.sign(np.linalg.det(u @ vh))
    return np.asarray(u * flip @ vh)


def gathered(position: Array, size: Sequence[float], offset: float) -> Array:
    """The points of one body as the images nearest to the first."""
    nearest = []
    for arm in position - position[0]:
        choices = [image for image, _ in images(arm[None, :], size, offset)]
        nearest.append(min((choice[0] for choice in choices), key=lambda r: float(r @ r)))
    return position[0] + np.array(nearest)


def spring_forces(sites: Array, position: Array, stiffness: float) -> tuple[Array, Array]:
    """Forces on the points of one massless body (p, D), and the sum of arm times force (D, D)."""
    arms = position - position.mean(axis=0)
    force = -stiffness * (arms - sites @ kabsch(sites, arms).T)
    return force, arms.T @ force


def spring_energy(sites: Array, position: Array, stiffness: float) -> float:
    arms = position - position.mean(axis=0)
    return 0.5 * stiffness * float(np.sum((arms - sites @ kabsch(sites, arms).T) ** 2))


def potential_energy(made: Engine, kinds: Sequence[Kind], size: Sequence[float], repulsion: float) -> float:
    """Repulsion a r_c (1 - r/r_c)^2 / 2 of all pairs (r_c = 1) and the springs of all massless bodies."""
    _, separation, _ = _core.neighbor_pairs(made.position, list(size), 0.0, 0.0, 1.0)
    energy = 0.5 * repulsion * float(np.sum((1.0 - np.linalg.norm(separation, axis=1)) ** 2))
    first = int(np.count_nonzero(made.species == 0))
    position = made.position
    for kind in kinds:
        for _ in range(kind.count):
            body = gathered(position[first : first + len(kind.sites)], size, 0.0)
            energy += spring_energy(kind.sites, body, kind.stiffness)
            first += len(kind.sites)
    return energy
