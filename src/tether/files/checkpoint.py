"""Checkpoint: the whole state of a run in full precision, as HDF5."""

from __future__ import annotations

import hashlib
import io
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from tether.config import Configuration
from tether.engines import mathematics
from tether.errors import InputError
from tether.files.whole import whole
from tether.observe.observer import part, under
from tether.version import __version__

_MARK = b"tether checkpoint, HDF5 from byte 512, sha256 of that: "
_OBSERVED = "observed"
_USER_BLOCK = 512  # HDF5's smallest
_FORMAT_VERSION = 4
_REMEDY = "resume from another checkpoint, or run the configuration again"


@dataclass(frozen=True)
class Checkpoint:
    """What a run needs to go on as if it had never stopped."""

    configuration: Configuration
    arrays: dict[str, NDArray[np.float64]]
    """position, velocity, force (n, d), bases, samples measured so far and the begun one, momentum when measuring
    began."""
    numbers: dict[str, int]
    """step, the step that the run began at, how many steps of the next sample have been measured, and the step at which
    the means were good enough, or 0."""
    offset: float
    """Offset of the sheared box, length."""
    seconds: float
    """Wall-clock time so far."""
    order: NDArray[np.uint32]
    """Ids in the order that particles have in memory, which sums depend on."""
    observed: dict[str, NDArray[np.generic]]
    """What observers have seen so far."""
    mathematics: str = ""

    def write(self, path: Path) -> None:
        """Write to `path`, which holds either the former checkpoint or this one at any moment. Raises OSError."""
        attributes = {
            "format_version": _FORMAT_VERSION,
            "version": __version__,
            "mathematics": mathematics(),
            "configuration": self.configuration.to_toml(),
            "offset": self.offset,
            "seconds": self.seconds,
            **self.numbers,
        }
        # Made in memory: when HDF5 itself runs into a full disk, it cannot even close its file.
        made = io.BytesIO()
        with h5py.File(made, "w", userblock_size=_USER_BLOCK) as file:
            file.attrs.update(attributes)
            observed = under(_OBSERVED, self.observed)
            for name, array in {**self.arrays, **observed, "order": self.order}.items():
                file.create_dataset(name, data=array)
        contents = made.getbuffer()[_USER_BLOCK:]
        with whole(path) as temporary, temporary.open("wb") as plain:
            plain.write(_seal(contents))
            plain.write(contents)

    @classmethod
    def read(cls, path: Path) -> Checkpoint:
        """Read from `path`. Raises InputError when there is none, or it is damaged, foreign or of another version."""
        if not path.is_file():
            raise InputError(
                f"{path} does not exist", "a run is resumed from its checkpoint", "name the folder of a run"
            )
        bits = path.read_bytes()
        # Checked before HDF5 sees it, which may crash on a damaged file.
        if bits[:_USER_BLOCK] != _seal(memoryview(bits)[_USER_BLOCK:]):
            problem = "is damaged" if bits.startswith(_MARK) else "is damaged or no checkpoint of tether"
            raise InputError(f"{path} {problem}", "its contents do not match their checksum", _REMEDY)
        with h5py.File(io.BytesIO(bits)) as file:
            attributes = {name: _plain(value) for name, value in file.attrs.items()}
            arrays = {name: file[name][()] for name in file}
        version = attributes["version"]
        order = arrays.pop("order", np.empty(0, dtype=np.uint32))
        if version != __version__ or attributes["format_version"] != _FORMAT_VERSION:
            raise InputError(
                f"{path} was written by tether {version}, in format {attributes['format_version']}",
                f"this is {__version__}, which writes format {_FORMAT_VERSION} and may not go on in the same bits",
                f"resume with tether {version}, or run the configuration again",
            )
        return cls(
            configuration=Configuration(**tomllib.loads(attributes["configuration"])),
            arrays={name: array for name, array in arrays.items() if not name.startswith(f"{_OBSERVED}.")},
            observed=part(_OBSERVED, arrays),
            numbers={name: attributes[name] for name in ("step", "begin", "open_steps", "stopped")},
            offset=attributes["offset"],
            seconds=attributes["seconds"],
            order=order,
            mathematics=attributes["mathematics"],
        )


def _seal(contents: memoryview) -> bytes:
    """What stands before the HDF5 file proper, in its user block: the checksum of all that follows."""
    return (_MARK + hashlib.sha256(contents).hexdigest().encode() + b"\n").ljust(_USER_BLOCK, b"\0")


def _plain(value: Any) -> Any:
    """A number of HDF5 as Python's, so that it is written alike."""
    return value.item() if isinstance(value, np.generic) else value
