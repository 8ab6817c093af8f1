"""Spring forces on the constituents of tethered bodies in 2D, from what a run's folder holds."""

from __future__ import annotations

from dataclasses import dataclass

import gsd.hoomd
import numpy as np
from numpy.typing import NDArray

from tether.config import Configuration
from tether.files.checkpoint import Checkpoint
from tether.record import Record

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Springs:
    """Forces -H (r_i - site i), and where the constituents are from the center of their base."""

    time: Array
    """Shape (times,)."""
    force: Array
    """Shape (times, bodies, p, 2)."""
    arm: Array
    """r_i - X, shape (times, bodies, p, 2)."""
    outward: Array
    """Unit vectors from the center to the sites, shape (times, bodies, p, 2)."""

    @property
    def magnitude(self) -> Array:
        """Of each force, shape (times, bodies, p)."""
        return np.asarray(np.linalg.norm(self.force, axis=-1))

    @property
    def radial(self) -> Array:
        """Component of each force outward from the center of the body, shape (times, bodies, p)."""
        return np.asarray(np.sum(self.force * self.outward, axis=-1))

    @property
    def sum(self) -> Array:
        """Over the constituents of a body, shape (times, bodies, 2)."""
        return np.asarray(self.force.sum(axis=-2))


def springs_of_frames(record: Record) -> Springs:
    """Of the trajectory of a run with a massless base, at every frame after the equilibration.

    The base is fitted to the constituents. Frames are in single precision: good to 1e-4 of a force, no use for the sum.
    """
    configuration = record.configuration()
    first = configuration.run.equilibration
    with gsd.hoomd.open(str(record.trajectory_path)) as frames:
        kept = [frame for frame in frames if int(frame.configuration.step or 0) > first]
        steps = np.array([int(frame.configuration.step) for frame in kept], dtype=np.float64)
        position = np.array([frame.particles.position[:, :2] for frame in kept], dtype=np.float64)
    constituents = _by_body(position, configuration)
    arm = constituents - constituents.mean(axis=-2, keepdims=True)
    sites = configuration.geometries[0].sites
    angle = np.arctan2(
        (sites[:, 0] * arm[..., 1] - sites[:, 1] * arm[..., 0]).sum(axis=-1), (sites * arm).sum(axis=(-2, -1))
    )
    return _springs(steps * configuration.run.timestep, arm, np.cos(angle), np.sin(angle), configuration)


def springs_at_the_end(record: Record) -> Springs:
    """Of the last state of a run, in double precision, with the base as it is."""
    checkpoint = Checkpoint.read(record.checkpoint_path)
    configuration = checkpoint.configuration
    bases = checkpoint.arrays["bases"]
    constituents = _by_body(checkpoint.arrays["position"][None], configuration)
    arm = _nearest(constituents - bases[None, :, None, :2], configuration)
    time = np.array([checkpoint.numbers["step"] * configuration.run.timestep])
    return _springs(time, arm, bases[None, :, 2], bases[None, :, 3], configuration)


def _by_body(position: Array, configuration: Configuration) -> Array:
    """Constituents, (times, n, 2) to (times, bodies, p, 2), each beside the first of its body."""
    p = len(configuration.geometries[0].sites)
    constituents = position[:, configuration.solvent_count :].reshape(len(position), -1, p, 2)
    return constituents[..., :1, :] + _nearest(constituents - constituents[..., :1, :], configuration)


def _nearest(separation: Array, configuration: Configuration) -> Array:
    """Nearest images, at rest."""
    size = np.asarray(configuration.box.size)
    return np.asarray(separation - size * np.round(separation / size))


def _springs(time: Array, arm: Array, cosine: Array, sine: Array, configuration: Configuration) -> Springs:
    sites = configuration.geometries[0].sites
    x, y = sites[:, 0], sites[:, 1]
    c, s = cosine[..., None], sine[..., None]
    turned = np.stack([c * x - s * y, s * x + c * y], axis=-1)
    stiffness = configuration.bodies[0].stiffness
    assert stiffness is not None
    outward = turned / np.linalg.norm(turned, axis=-1, keepdims=True)
    return Springs(time, -stiffness * (arm - turned), arm, outward)
