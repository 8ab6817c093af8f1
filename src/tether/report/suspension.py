"""The suspension for the 3D view of a page: frames of a trajectory, small enough to stand in it as text."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import gsd.hoomd
import numpy as np
from numpy.typing import NDArray

from tether.config import Configuration
from tether.errors import InputError
from tether.flows import imposed_velocity
from tether.record import Record

MOST_FRAMES = 50
FEWEST_FRAMES = 12
"""Bodies are left out only where so many frames of them would still be too large."""

MOST_SOLVENT = 8000
"""Dots beyond which the view shows a cloud and a phone is slow."""

_DOT = 0.13  # radius of a dot of solvent, over its mean distance n^(-1/d)
_TOUCHING = 0.56  # radius of a constituent, over the distance of neighbors
_BRIGHTEST = 0.998  # quantile of a velocity at which its scale ends: a few fast particles would take it all

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Suspension:
    """What the view needs, as it is written into the page, and what was left out."""

    description: dict[str, Any]
    """For tools/viewer/source/trajectory.js; arrays are base64."""
    left_out: str
    """A sentence on frames and particles that are not shown; empty if all are."""

    @property
    def shades(self) -> list[str]:
        """The velocities that particles can be colored by."""
        return list(self.description["shades"])

    @property
    def has_bodies(self) -> bool:
        """Whether there is anything but solvent."""
        return len(self.description["species"]) > 1

    @property
    def is_sheared(self) -> bool:
        """Whether the box is tilted in any frame."""
        return any(abs(tilt) > 1e-6 for tilt in self.description["tilts"])


def suspension(record: Record, most_bytes: int) -> Suspension | None:
    """The frames of a run, at most about `most_bytes` before base64; None without a frame.

    Frames are taken evenly. Positions are in the box's own coordinates, along its tilted edges, as uint16 over twice
    the box: bodies are put together, so that those across a face stick out of it. Velocities are a byte each. Solvent
    that is too much is left out, evenly, then frames, and bodies last. Raises InputError when the trajectory is damaged
    or has other particles than the configuration.
    """
    path, configuration = record.trajectory_path, record.configuration()
    if not path.is_file():
        return None
    try:
        with gsd.hoomd.open(str(path)) as frames:
            return _gathered(frames, configuration, most_bytes) if len(frames) else None
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, IndexError):
        why = "it cannot be read, or has other particles than config.toml"
        raise InputError(f"{path} is damaged", why, "run the configuration again") from None


@dataclass(frozen=True)
class _Choice:
    """Which particles and frames are shown."""

    particles: NDArray[np.intp]
    frames: NDArray[np.intp]
    kind: NDArray[np.uint8]
    """0 solvent, k the k-th species of bodies."""
    body: NDArray[np.int32]
    """Counted over all species; -1 for solvent."""


def _gathered(frames: Any, configuration: Configuration, most_bytes: int) -> Suspension:
    chosen = _chosen(configuration, len(frames), most_bytes)
    places, velocities, tilts, steps = [], [], [], []
    for number in chosen.frames:
        frame = frames[int(number)]
        place, velocity = _of_frame(frame, configuration, chosen)
        places.append(place)
        velocities.append(velocity)
        tilts.append(float(frame.configuration.box[3]))
        steps.append(int(frame.configuration.step or 0))
    d, size = configuration.dimension, configuration.box.size
    description = {
        "dimension": d,
        "size": [*size, 0.0] if d == 2 else list(size),
        "species": list(configuration.species_names),
        "radii": _radii(configuration),
        "tilts": tilts,
        "times": [step * configuration.run.timestep for step in steps],
        "kind": _text(chosen.kind),
        "body": _text(chosen.body),
        "place": _text(np.stack(places)),
        "shades": _shades(np.stack(velocities), configuration) if any(map(np.any, velocities)) else {},
    }
    return Suspension(description, _left_out(configuration, chosen, len(frames)))


def _chosen(configuration: Configuration, frames: int, most_bytes: int) -> _Choice:
    counts = configuration.body_counts
    sites = [len(shape.sites) for shape in configuration.geometries]
    kind = np.repeat(np.arange(len(counts) + 1, dtype=np.uint8), [configuration.solvent_count, *_times(counts, sites)])
    of_kinds = [np.repeat(np.arange(count), size) for count, size in zip(counts, sites, strict=True)]
    first = np.cumsum([0, *counts])
    body = np.concatenate([
        np.full(configuration.solvent_count, -1), *(own + begin for own, begin in zip(of_kinds, first, strict=False))
    ])  # fmt: skip
    constituents = np.flatnonzero(kind)
    solvent = np.flatnonzero(kind == 0)
    each = 2 * configuration.dimension + 2  # bytes of a particle in a frame
    shown = min(frames, MOST_FRAMES)
    if len(constituents) * each * shown > most_bytes:
        shown = max(min(frames, FEWEST_FRAMES), most_bytes // (len(constituents) * each))
        most = most_bytes // (each * shown)
        constituents = constituents[body[constituents] < _whole_bodies(body[constituents], most)]
    room = max(0, most_bytes // (each * shown) - len(constituents))
    solvent = solvent[_evenly(len(solvent), min(room, MOST_SOLVENT))]
    particles = np.concatenate([solvent, constituents])
    return _Choice(particles, _evenly(frames, shown), kind[particles], body[particles].astype(np.int32))


def _times(counts: Sequence[int], sites: Sequence[int]) -> list[int]:
    return [count * size for count, size in zip(counts, sites, strict=True)]


def _whole_bodies(body: NDArray[np.intp], most: int) -> int:
    """So many bodies, from the first on, have no more constituents than `most`."""
    return int(body[most]) if most < len(body) else int(body[-1]) + 1


def _evenly(count: int, most: int) -> NDArray[np.intp]:
    """At most so many of 0 ... count - 1, the first and the last among them."""
    if count <= most:
        return np.arange(count)
    return np.linspace(0, count - 1, most).round().astype(np.intp)


def _of_frame(frame: Any, configuration: Configuration, chosen: _Choice) -> tuple[NDArray[np.uint16], Array]:
    """Quantized places, shape (n, d), and for each particle its speed and its velocity along x, shape (n, 2)."""
    d, size = configuration.dimension, np.array(configuration.box.size)
    tilt = float(frame.configuration.box[3])
    position = np.asarray(frame.particles.position, dtype=np.float64)[chosen.particles, :d]
    velocity = np.asarray(frame.particles.velocity, dtype=np.float64)[chosen.particles, :d]
    along = position.copy()
    along[:, 0] -= tilt * position[:, 1]
    along /= size
    whole = _put_together(along, chosen.body)
    place = np.rint((np.clip(whole, -1.0, 1.0) + 1.0) * 0.5 * 65535).astype(np.uint16)
    peculiar = velocity.copy()
    rate = float(np.ravel(frame.log.get("tether/shear_rate", [0.0]))[0])
    peculiar[:, 0] -= imposed_velocity(rate, position[:, 1] + 0.5 * size[1], size[1])
    return place, np.column_stack([np.linalg.norm(peculiar, axis=1), velocity[:, 0]])


def _put_together(along: Array, body: NDArray[np.int32]) -> Array:
    """Constituents as the images nearest to the first of their body, whose middle is inside the box."""
    is_solvent = body < 0
    own = along[~is_solvent]
    if len(own) == 0:
        return along
    number, first, index, count = np.unique(
        body[~is_solvent], return_index=True, return_inverse=True, return_counts=True
    )
    away = own - own[first][index]
    own = own - np.rint(away)
    middle = np.stack([np.bincount(index, axis, len(number)) for axis in own.T], axis=1) / count[:, None]
    own -= np.rint(middle)[index]
    return np.concatenate([along[is_solvent], own])


def _radii(configuration: Configuration) -> list[float]:
    """Of a dot of solvent, and of the constituents of each species of bodies."""
    d = configuration.dimension
    radii = [_DOT * configuration.fluid.density ** (-1.0 / d)]
    for bodies, shape in zip(configuration.bodies, configuration.geometries, strict=True):
        radii.append(_TOUCHING * shape.spacing if len(shape.sites) > 1 else bodies.hull_in(d))
    return radii


def _shades(velocities: Array, configuration: Configuration) -> dict[str, Any]:
    """Speed and velocity along x of shape (frames, particles, 2), as bytes between the ends of their scales."""
    against = " against the imposed profile" if configuration.flow.is_sheared else ""
    speed, along = velocities[..., 0], velocities[..., 1]
    fastest = float(np.quantile(speed, _BRIGHTEST)) or 1.0
    most = float(np.quantile(np.abs(along), _BRIGHTEST)) or 1.0
    return {
        "speed": _shade(speed, 0.0, fastest, f"speed{against} (DPD units)"),
        "velocity": _shade(along, -most, most, "velocity along the flow (DPD units)"),
    }


def _shade(values: Array, low: float, high: float, words: str) -> dict[str, Any]:
    byte = np.rint(np.clip((values - low) / (high - low), 0.0, 1.0) * 255).astype(np.uint8)
    return {"low": low, "high": high, "words": words, "value": _text(byte)}


def _text(array: NDArray[Any]) -> str:
    """Little-endian bytes in base64: what typed arrays of every processor that has a browser read."""
    return base64.b64encode(array.astype(array.dtype.newbyteorder("<")).tobytes()).decode("ascii")


def _left_out(configuration: Configuration, chosen: _Choice, frames: int) -> str:
    bodies = len(np.unique(chosen.body[chosen.body >= 0]))
    parts = [
        f"{shown} of {there} {words}"
        for shown, there, words in (
            (len(chosen.frames), frames, "frames"),
            (int((chosen.kind == 0).sum()), configuration.solvent_count, "solvent particles"),
            (bodies, sum(configuration.body_counts), "bodies"),
        )
        if shown < there
    ]
    return f"To keep the page small the view shows {', '.join(parts)}." if parts else ""
