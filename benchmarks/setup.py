"""What is simulated, and in which manner; both in reduced (DPD) units."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from typing import Protocol

DENSITY = 4.0
"""Number density of the plain fluid, in particles per volume (per area in 2D)."""

REPULSION = 18.75
"""Repulsion a, in units of energy / length."""

FRICTION = 4.5
"""Friction gamma, in units of mass / time; with kT = 1 the noise is sigma = 3."""

TEMPERATURE = 1.0
"""Thermal energy kT."""


@dataclass(frozen=True)
class Setup:
    """What is simulated: all that physics can tell."""

    box: tuple[float, ...]
    """Sides, in units of length; two of them make a 2D fluid."""
    density: float = DENSITY
    """Number density of the solvent, in particles per volume (per area in 2D)."""
    exponent: float = 0.5
    """Exponent s of the dissipative weight."""
    timestep: float = 0.005
    """In units of time."""
    shear_rate: float = 0.0
    """In units of 1 / time; 0 is no flow."""
    cubes: int = 0
    """Bodies of eight constituents each, in a 3D box."""


@dataclass(frozen=True)
class Manner:
    """How tether runs it."""

    precision: str = "mixed"
    """Of the pair loop: mixed or double."""
    instruction_set: str | None = None
    """As compilers call it; the widest that the processor has, when None."""
    threads: int = 1
    interval: int = 0
    """Steps between measurements of the stress; 0 measures nothing."""
    measures: tuple[str, ...] | None = None
    """Tables of [measure] that are on, beside the stress of every step, as in a run; None is the engine alone."""
    processes: int = 0
    """Separate processes that each run all of it at the same time; 0 runs it in this one."""


class Runner(Protocol):
    """What can be told to go on for some steps."""

    particles: int

    def run(self, steps: int) -> float:
        """Go on by `steps`; return the seconds that it took."""

    def close(self) -> None:
        """Give back memory and processes."""


def cubic(particles: int, exponent: float, **changes: float) -> Setup:
    """The plain 3D fluid of that many particles in a cubic box."""
    side = (particles / DENSITY) ** (1 / 3)
    return replace(Setup((side, side, side), exponent=exponent), **changes)


def as_json(*parts: Setup | Manner) -> str:
    """On one line, for the command line of another process."""
    return json.dumps([asdict(part) for part in parts])


def setup_of(values: dict) -> Setup:
    """The setup that `as_json` wrote."""
    return Setup(**{**values, "box": tuple(values["box"])})
