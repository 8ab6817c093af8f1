"""Trajectory: frames in GSD, the HOOMD schema, for OVITO, freud and for another run to start from."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gsd.hoomd
import numpy as np
from numpy.typing import NDArray

from tether.config import Configuration
from tether.errors import InputError
from tether.estimate import estimate
from tether.files.whole import whole
from tether.flows import imposed_velocity

if TYPE_CHECKING:
    from tether.simulation import Simulation

Vectors = NDArray[np.float64]

_SHEAR_RATE = "tether/shear_rate"
"""The log entry of a frame with the rate of the flow that its velocities belong to."""

_UNREADABLE = (OSError, RuntimeError, ValueError, KeyError, TypeError)
"""What the gsd package raises for a damaged or foreign file."""


class Trajectory:
    """A growing GSD file. Positions are centered; the box's tilt is the shear's offset, within half a box."""

    def __init__(self, path: Path) -> None:
        """Open for appending, or begin."""
        self._file: Any = gsd.hoomd.open(str(path), "r+" if path.exists() else "w")

    def append(self, simulation: Simulation) -> None:
        """Write the present state as a frame."""
        self._file.append(_frame(simulation))

    def flush(self) -> None:
        """Hand everything to the file system."""
        self._file.flush()

    def close(self) -> None:
        """Flush and close."""
        self._file.close()

    def __len__(self) -> int:
        return len(self._file)


def cut(path: Path, last_step: int) -> None:
    """Drop frames after `last_step`: what a killed run wrote after the checkpoint that it is resumed from.

    A file that cannot be read is set aside.
    """
    if not path.exists():
        return
    try:
        with gsd.hoomd.open(str(path)) as frames:
            keep = len(frames)
            while keep > 0 and int(frames[keep - 1].configuration.step or 0) > last_step:
                keep -= 1
            if keep < len(frames):
                with whole(path) as temporary, gsd.hoomd.open(str(temporary), "w") as shorter:
                    for index in range(keep):
                        shorter.append(frames[index])
    except _UNREADABLE:
        path.replace(set_aside(path))


def is_readable(path: Path) -> bool:
    """Whether the first and the last frame can be read, if there is a file at all."""
    if not path.exists():
        return True
    try:
        with gsd.hoomd.open(str(path)) as frames:
            for index in {0, len(frames) - 1} if len(frames) else ():
                frames[index]
    except _UNREADABLE:
        return False
    return True


def set_aside(path: Path) -> Path:
    """Where `cut` puts a damaged file."""
    return path.with_name(f"{path.name}.damaged")


@dataclass(frozen=True)
class StartFrame:
    """Where a run starts from."""

    position: Vectors
    """Inside the box, shape (n, d)."""
    peculiar_velocity: Vectors | None
    """Against the flow that the frame was made in, shape (n, d); None if the frame tells neither."""
    offset: float
    """Of the sheared box, length."""


def read_frame(configuration: Configuration) -> StartFrame:
    """The frame that [start] names. Raises InputError unless it holds this configuration's particles and box."""
    start = configuration.start
    assert start.file is not None
    path = Path(start.file)
    try:
        with gsd.hoomd.open(str(path)) as frames:
            if not -len(frames) <= start.frame < len(frames):
                raise _unfit(f"has no frame {start.frame}", f"it has {len(frames)}", "frame")
            frame = frames[start.frame]
    except FileNotFoundError:
        raise _unfit(f"= {path} does not exist", "the particles are to come from it", "file") from None
    except _UNREADABLE:
        raise _unfit(f"= {path} is no readable GSD file", "it is foreign or damaged", "file") from None
    d = configuration.dimension
    counts = [configuration.solvent_count]
    for bodies, count in zip(configuration.bodies, configuration.body_counts, strict=True):
        counts.append(count * len(bodies.geometry.sites))
    species = np.repeat(np.arange(len(counts)), counts)
    found = np.zeros(frame.particles.N) if frame.particles.typeid is None else frame.particles.typeid
    if not np.array_equal(found, species):
        raise _unfit(
            f"= {path} holds other particles",
            f"this run needs {counts[0]} of solvent, then {sum(counts[1:])} constituents, in that order",
            "file",
        )
    size = np.array(configuration.box.size)
    box = np.array(frame.configuration.box, dtype=np.float64)
    if frame.configuration.dimensions != d or np.any(box[4:]):
        raise _unfit(
            f"= {path} has a box of another kind", f"this run's has {d} dimensions, tilted along x only", "file"
        )
    if not np.allclose(box[:d], size, rtol=1e-5):
        sides = " x ".join(f"{side:g}" for side in box[:d])
        raise _unfit(f"= {path} has a box of {sides}", "this run's box has other sides", "file")
    offset = float(box[3] * size[1]) % size[0]
    position = _inside(np.array(frame.particles.position, dtype=np.float64)[:, :d] + size / 2, size, offset)
    if not np.isfinite(position).all():
        raise _unfit(f"= {path} has a position that is not finite", "no force can be taken there", "file")
    if not np.isfinite(frame.particles.velocity).all():
        raise _unfit(f"= {path} has a velocity that is not finite", "no step can be taken from there", "file")
    return StartFrame(position, _peculiar(frame, position, size), offset)


def _peculiar(frame: Any, position: Vectors, size: Vectors) -> Vectors | None:
    if _SHEAR_RATE not in frame.log or not np.any(frame.particles.velocity):
        return None
    velocity = np.array(frame.particles.velocity, dtype=np.float64)[:, : len(size)]
    velocity[:, 0] -= imposed_velocity(float(frame.log[_SHEAR_RATE][0]), position[:, 1], float(size[1]))
    return velocity


def velocity_profile(
    path: Path, configuration: Configuration, first_step: int
) -> tuple[Vectors, Vectors, Vectors] | None:
    """Mean velocity along x in bins of y over the frames from `first_step` on: y, mean, standard error.

    There are twenty bins, fewer in a low box, none thinner than half a cutoff. Neighboring frames are correlated
    (momentum takes L^2/(4 pi^2 nu) to diffuse), which the error takes into account by the statistical inefficiency of
    each bin; so are neighboring bins. None without two frames with velocities.
    """
    height = configuration.box.size[1]
    bins = min(20, int(2 * height / configuration.fluid.cutoff))
    try:
        with gsd.hoomd.open(str(path)) as frames:
            rows = _slips(frames, configuration, first_step, bins)
    except _UNREADABLE:
        raise InputError(f"{path} is damaged", "it cannot be read as GSD", "run the configuration again") from None
    if len(rows) < 2:
        return None
    middle = (np.arange(bins) + 0.5) / bins * height
    mean, error = np.full(bins, np.nan), np.full(bins, np.nan)
    for of_bin, slips in enumerate(np.array(rows).T):
        known = slips[np.isfinite(slips)]  # a bin may be empty in some frames
        if len(known) > 1:
            mean[of_bin] = known.mean()
            error[of_bin] = known.std(ddof=1) * math.sqrt(estimate(known).inefficiency / len(known))
    return middle, imposed_velocity(configuration.flow.shear_rate, middle, height) + mean, error


def _slips(frames: Any, configuration: Configuration, first_step: int, bins: int) -> list[Vectors]:
    """Mean velocity along x against the imposed profile in each bin of y (nan in an empty one), a row a frame."""
    height = configuration.box.size[1]
    rows = []
    for frame in frames:
        if (frame.configuration.step or 0) < first_step or not np.any(frame.particles.velocity):
            continue
        y = np.asarray(frame.particles.position, dtype=np.float64)[:, 1] / height + 0.5
        bin_of = np.clip((y * bins).astype(int), 0, bins - 1)
        # Against the profile at each particle's own place; the bin's own middle is put back by the caller.
        slip = frame.particles.velocity[:, 0] - imposed_velocity(configuration.flow.shear_rate, y * height, height)
        total, count = np.bincount(bin_of, weights=slip, minlength=bins), np.bincount(bin_of, minlength=bins)
        rows.append(np.divide(total, count, out=np.full(bins, np.nan), where=count > 0))
    return rows


def _frame(simulation: Simulation) -> Any:
    configuration = simulation.configuration
    size = np.array(configuration.box.size)
    d = len(size)
    at = simulation.engine.position - size / 2
    offset = simulation.engine.offset
    if offset > size[0] / 2:
        offset -= size[0]
    tilt = offset / size[1]
    slanted = at[:, 0] - tilt * at[:, 1]  # HOOMD's box is a parallelepiped: x is wrapped along the tilt
    at[:, 0] -= size[0] * np.floor(slanted / size[0] + 0.5)
    frame = gsd.hoomd.Frame()
    frame.configuration.step = simulation.step
    frame.configuration.dimensions = d
    frame.configuration.box = [size[0], size[1], size[2] if d == 3 else 0.0, tilt, 0.0, 0.0]
    frame.log[_SHEAR_RATE] = np.array([simulation.engine.shear_rate])
    frame.particles.N = len(at)
    frame.particles.types = list(configuration.species_names)
    frame.particles.typeid = simulation.species.astype(np.uint32)
    frame.particles.position = _in_space(at)
    if "velocity" in configuration.output.fields:
        frame.particles.velocity = _in_space(simulation.engine.velocity)
    if "mass" in configuration.output.fields:
        frame.particles.mass = simulation.masses.astype(np.float32)
    if "body" in configuration.output.fields:
        frame.particles.body = simulation.body_index
    return frame


def _in_space(vectors: Vectors) -> NDArray[np.float32]:
    padded = np.zeros((len(vectors), 3), dtype=np.float32)
    padded[:, : vectors.shape[1]] = vectors
    return padded


def _inside(position: Vectors, size: Vectors, offset: float) -> Vectors:
    """Into the rectangular box, through the sheared boundary; velocities are those of the images there.

    A frame's particles have y inside the box but for rounding, so no velocity changes.
    """
    position = position.copy()
    rows = np.floor(position[:, 1] / size[1])
    position[:, 0] -= rows * offset
    position[:, 1] -= rows * size[1]
    position = np.mod(position, size)
    position[position >= np.broadcast_to(size, position.shape)] = 0.0
    return position


def _unfit(problem: str, why: str, key: str) -> InputError:
    return InputError(
        f"start.{key} {problem}",
        why,
        "name a frame of a run of the same particles and box",
        key=("start", key),
    )
