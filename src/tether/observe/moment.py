"""Moment: the suspension at one step, as observers see it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tether.config import Configuration
from tether.engines import CpuEngine

Vectors = NDArray[np.float64]


@dataclass(frozen=True)
class Moment:
    """The suspension at the end of a step. Axes: x flow, y gradient, z vorticity; d is 2 or 3, reduced units."""

    step: int
    time: float
    size: tuple[float, ...]
    """Sides of the box, length."""
    offset: float
    """By which the image of the box above it in y is displaced along +x, in [0, L_x), length."""
    shear_rate: float
    """Of the imposed profile u_x = shear_rate (y - L_y/2) at this step, 1/time."""
    strain: float
    """Integral of the shear rate over time since step 0, a pure number; may be negative."""
    position: Vectors
    """Of all particles, inside the box, (n, d): solvent first, then constituents body by body."""
    velocity: Vectors
    """Of all particles, in the laboratory frame, (n, d)."""
    mass: Vectors
    """Of all particles, (n,)."""
    solvent: int
    """Number of solvent particles: they are the first rows."""
    center: Vectors
    """Of all bodies, kind by kind, inside the box, (bodies, d)."""
    center_velocity: Vectors
    """Of the bodies' centers, in the laboratory frame, (bodies, d)."""
    rotation: Vectors
    """Of the bodies, (bodies, d, d): a site s, along the shape's principal axes, stands at center + rotation @ s."""
    kind: NDArray[np.intp]
    """Which [[bodies]] table each body is of, from 0, (bodies,)."""
    driving_force: Vectors | None = None
    """In a driven flow: along x on each particle, as it acts, its mean over all taken off; (n,)."""
    local_stress: Vectors | None = None
    """What the core saw of the local stress in this step, where it looked; see `tether.observe.stress_profile`."""


def moment_of(engine: CpuEngine, configuration: Configuration, mass: Vectors) -> Moment:
    """What observers see of an engine at its step. mass: of all particles, (n,)."""
    position = engine.position
    center, center_velocity, rotation = engine.body_frames()
    seen = engine.take_stress()
    timestep = configuration.run.timestep
    return Moment(
        step=engine.step,
        time=engine.step * timestep,
        size=configuration.box.size,
        offset=engine.offset,
        shear_rate=engine.shear_rate,
        strain=float(configuration.flow.strain(engine.step, timestep)),
        position=position,
        velocity=engine.velocity,
        mass=mass,
        solvent=configuration.solvent_count,
        center=center,
        center_velocity=center_velocity,
        rotation=rotation,
        kind=np.repeat(np.arange(len(configuration.bodies)), configuration.body_counts),
        driving_force=_driving_force(configuration, position[:, 1]) if configuration.flow.is_driven else None,
        local_stress=seen[-1] if len(seen) else None,
    )


def _driving_force(configuration: Configuration, y: Vectors) -> Vectors:
    """Along x on particles at heights y, as the engine applies it."""
    force: Vectors = configuration.flow.driving_force(y, configuration.box.size[1])
    force -= force.mean()
    return force
