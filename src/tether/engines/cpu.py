"""The CPU engine, made from a configuration."""

from __future__ import annotations

import math
import os
import platform
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from tether import _core
from tether.bodies import Bodies
from tether.config import Configuration
from tether.errors import InputError
from tether.flows import Kolmogorov, Oscillatory, Poiseuille, Stages
from tether.interactions import PairParameters
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
    """What the bits of pow, log, cos, sin, exp depend on: the C library and which of its versions of them it chooses.

    They are taken for exponents other than 1/2 and 2, for Gaussian noise, to turn Newton-Euler bases and rigid bodies,
    and, with expm1 and exp, for steep laws. All else has the same bits on every processor.
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
    fluid, run = configuration.fluid, configuration.run
    counts = configuration.body_counts
    sites = [principal_sites(shape) for shape in configuration.geometries]
    particles = [configuration.solvent_count]
    particles += [count * len(of_body) for count, of_body in zip(counts, sites, strict=True)]
    engine_class = _core.CpuEngine2 if configuration.dimension == 2 else _core.CpuEngine3
    engine: CpuEngine = engine_class(
        size=list(configuration.box.size),
        laws=_laws(configuration.pair_parameters()),
        exponent=fluid.exponent,
        random=fluid.random,
        timestep=run.timestep,
        verlet_lambda=run.verlet_lambda,
        seed=configuration.seed,
        species_mass=[fluid.mass, *configuration.body_masses],
        species=np.repeat(np.arange(len(particles), dtype=np.uint8), particles),
        pairs="reference" if run.engine == "reference" else "packed",
        precision=run.pair_precision,
        instruction_set="" if run.engine == "reference" else instruction_set(),
        threads=threads,
        **_flow(configuration),
    )
    if run.pair_precision == "mixed":
        _check_rounding(engine, configuration)
    first = configuration.solvent_count
    for bodies, count, of_body, mass in zip(
        configuration.bodies, counts, sites, configuration.body_masses, strict=True
    ):
        _add_bodies(engine, bodies, of_body, count, first, mass)
        first += count * len(of_body)
    return engine


_COARSE = 1e-3
"""Rounding of forces, as a part of what kicks the weakest pairs, noise or repulsion, that would be seen."""


def _check_rounding(engine: CpuEngine, configuration: Configuration) -> None:
    """Raise InputError where one steep force leaves too few digits to the others."""
    pairs = configuration.pair_parameters()
    kicks = np.maximum(pairs.noise / math.sqrt(configuration.run.timestep), pairs.repulsion)
    weakest = kicks[kicks > 0].min(initial=math.inf)
    quantum = engine.force_quantum("mixed")
    if quantum > _COARSE * weakest:
        raise InputError(
            'run.precision = "mixed" is too coarse for these interactions',
            f"the strongest repulsion, {pairs.repulsion.max():g}, leaves forces rounded to {quantum:.2g}, and the "
            f"weakest are about {weakest:.2g}",
            'use run.precision = "double"',
            key=("run", "precision"),
        )


def _laws(pairs: PairParameters) -> NDArray[np.float64]:
    """The table of laws that the core takes, (species, species, 5); one species if all pairs have one law."""
    columns = (pairs.repulsion, pairs.friction, pairs.noise, pairs.cutoff, pairs.steepness)
    table = np.stack(columns, axis=2)
    return np.ascontiguousarray(table[:1, :1] if pairs.is_uniform else table)


def _flow(configuration: Configuration) -> dict[str, Any]:
    """What the core is told of the flow."""
    flow = configuration.flow
    if isinstance(flow, Oscillatory):
        return {"oscillation": (flow.strain_amplitude, flow.angular_frequency)}
    if isinstance(flow, Stages):
        timestep = configuration.run.timestep
        return {"stages": [(stage.steps(timestep), stage.shear_rate) for stage in flow.stages]}
    if isinstance(flow, Poiseuille):
        return {"driving": "poiseuille", "force": flow.force}
    if isinstance(flow, Kolmogorov):
        return {"driving": "kolmogorov", "force": flow.force, "periods": flow.periods}
    return {"shear_rate": flow.shear_rate}


def _add_bodies(
    engine: CpuEngine, bodies: Bodies, sites: NDArray[np.float64], count: int, first: int, mass: float
) -> None:
    if bodies.model == "rigid":
        engine.add_rigid_bodies(sites=sites, count=count, first=first, mass=mass)
        return
    # A body of a single particle is tethered to itself: no spring ever stretches.
    engine.add_tethered_bodies(
        sites=sites,
        count=count,
        first=first,
        stiffness=bodies.stiffness or 0.0,
        mass=mass,
        base=bodies.base or "massless",
        torque_arms=bodies.torque_arms or "constituents",
    )
