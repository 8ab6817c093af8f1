"""The CPU engine, made from a configuration."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from tether import _core
from tether.config import Configuration
from tether.errors import InputError
from tether.shapes import Shape

CpuEngine: TypeAlias = _core.CpuEngine2 | _core.CpuEngine3

_PARTICLES_PER_THREAD = 4000
"""A thread with fewer waits for the others longer than it works."""

INSTRUCTION_SET_VARIABLE = "TETHER_INSTRUCTION_SET"
"""The environment variable that names the instruction set to use; the widest that the processor has, without it."""


def default_threads(particles: int) -> int:
    """A thread for each 4000 particles, up to the processors that this process may use."""
    return max(1, min(len(os.sched_getaffinity(0)), particles // _PARTICLES_PER_THREAD))


def instruction_sets() -> dict[str, bool]:
    """The instruction sets that the CPU engine was built for, the widest first, and whether this processor has them."""
    return dict(_core.instruction_sets())


def instruction_set() -> str:
    """The instruction set that the CPU engine uses. Raises InputError when there is none, or not the one asked for."""
    here = [name for name, is_here in instruction_sets().items() if is_here]
    asked = os.environ.get(INSTRUCTION_SET_VARIABLE) or None  # empty is unset
    if asked is not None and asked not in here:
        raise InputError(
            f"{INSTRUCTION_SET_VARIABLE} = {asked} cannot be used",
            f"this build on this processor has {', '.join(here) or 'none'}",
            "unset it to use the widest" if here else "unset it",
        )
    if not here:
        raise InputError(
            "the CPU engine cannot run on this processor",
            f"it was built for {', '.join(instruction_sets())}",
            'use run.engine = "reference"',
        )
    return asked or here[0]


def mathematics() -> str:
    """What the bits of pow, log, cos and sin depend on: the C library and which of its versions of them it chooses.

    They are taken for exponents other than 1/2 and 2, for Gaussian noise, and to turn Newton-Euler bases. All else has
    the same bits on every processor.
    """
    return f"{' '.join(platform.libc_ver())}{', fma' if _has_fma() else ''}"


def _has_fma() -> bool:
    try:
        return " fma " in Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    except OSError:
        return False


def principal_sites(shape: Shape) -> NDArray[np.float64]:
    """The shape's sites about their centroid, along the principal axes of their inertia; shape (p, d)."""
    sites = np.array(shape.sites)
    if shape.dimension == 2:
        return sites
    spread = sites.T @ sites  # has the same axes as the inertia
    off_diagonal = spread - np.diag(np.diag(spread))
    if np.abs(off_diagonal).max() <= 1e-14 * np.trace(spread):
        return sites
    axes = np.linalg.eigh(spread)[1]
    axes[:, 0] *= np.sign(np.linalg.det(axes))  # a rotation, no reflection
    return np.ascontiguousarray(sites @ axes)


def cpu_engine(configuration: Configuration, threads: int) -> CpuEngine:
    """An engine for the configuration's particles, none of them placed yet.

    Ids: solvent first, then table by table of bodies, body by body, site by site. Species 0 is the solvent,
    k the constituents of table k.
    """
    fluid = configuration.fluid
    counts = configuration.body_counts
    sites = [principal_sites(bodies.geometry) for bodies in configuration.bodies]
    particles = [configuration.solvent_count]
    particles += [count * len(of_body) for count, of_body in zip(counts, sites, strict=True)]
    engine_class = _core.CpuEngine2 if configuration.dimension == 2 else _core.CpuEngine3
    engine: CpuEngine = engine_class(
        size=list(configuration.box.size),
        shear_rate=configuration.flow.shear_rate,
        repulsion=fluid.repulsion,
        friction=fluid.gamma,
        noise=fluid.sigma,
        cutoff=fluid.cutoff,
        exponent=fluid.exponent,
        random=fluid.random,
        timestep=configuration.run.timestep,
        verlet_lambda=configuration.run.verlet_lambda,
        seed=configuration.seed,
        species_mass=[fluid.mass, *(bodies.mass for bodies in configuration.bodies)],
        species=np.repeat(np.arange(len(particles), dtype=np.uint8), particles),
        pairs="reference" if configuration.run.engine == "reference" else "packed",
        precision=configuration.run.pair_precision,
        instruction_set="" if configuration.run.engine == "reference" else instruction_set(),
        threads=threads,
    )
    first = configuration.solvent_count
    for bodies, count, of_body in zip(configuration.bodies, counts, sites, strict=True):
        engine.add_bodies(
            sites=of_body,
            count=count,
            first=first,
            stiffness=bodies.stiffness,
            mass=bodies.mass,
            base=bodies.base,
            torque_arms=bodies.torque_arms or "constituents",
        )
        first += count * len(of_body)
    return engine
