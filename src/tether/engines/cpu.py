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
from tether.shapes import Shape

CpuEngine: TypeAlias = _core.CpuEngine2 | _core.CpuEngine3

_PARTICLES_PER_THREAD = 4000
"""A thread with fewer waits for the others longer than it works."""


def default_threads(particles: int) -> int:
    """A thread for each 4000 particles, up to the processors that this process may use."""
    return max(1, min(len(os.sched_getaffinity(0)), particles // _PARTICLES_PER_THREAD))


def instruction_set() -> str:
    """What equal bits are promised on: what the engine was compiled for, and the C library's mathematics.

    pow, log, cos and sin (exponents other than 1/2 and 2, Gaussian noise, turning Newton-Euler bases) are the C
    library's, which chooses among its versions of them by whether the processor has fused multiply-add.
    """
    return f"{platform.machine()} baseline, {' '.join(platform.libc_ver())}{', fma' if _has_fma() else ''}"


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
