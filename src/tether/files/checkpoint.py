"""Checkpoint: the whole state of a run in full precision, as HDF5."""

from __future__ import annotations

import hashlib
import tomllib
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from tether.config import Configuration
from tether.engines import instruction_set
from tether.errors import InputError
from tether.files.whole import whole
from tether.version import __version__

_FORMAT = "tether checkpoint"
_FORMAT_VERSION = 1
_REMEDY = "resume from another checkpoint, or run the configuration again"


@dataclass(frozen=True)
class Checkpoint:
    """What a run needs to go on as if it had never stopped."""

    configuration: Configuration
    arrays: dict[str, NDArray[np.float64]]
    """position, velocity, force (n, d), bases, samples measured so far, momentum when measuring began."""
    numbers: dict[str, int]
    """step and the step that the run began at."""
    offset: float
    """Offset of the sheared box, length."""
    seconds: float
    """Wall-clock time so far."""
    instruction_set: str = ""

    def write(self, path: Path) -> None:
        """Write to `path`, which holds either the former checkpoint or this one at any moment."""
        with whole(path) as temporary, h5py.File(temporary, "w") as file:
            file.attrs["format"] = _FORMAT
            file.attrs["format_version"] = _FORMAT_VERSION
            file.attrs["version"] = __version__
            file.attrs["instruction_set"] = instruction_set()
            file.attrs["configuration"] = self.configuration.to_toml()
            file.attrs["offset"] = self.offset
            file.attrs["seconds"] = self.seconds
            file.attrs["sha256"] = self._sha256()
            for name, number in self.numbers.items():
                file.attrs[name] = number
            for name, array in self.arrays.items():
                file.create_dataset(name, data=array)

    @classmethod
    def read(cls, path: Path) -> Checkpoint:
        """Read from `path`. Raises InputError when there is none, or it is damaged, foreign or of another version."""
        if not path.is_file():
            raise InputError(
                f"{path} does not exist", "a run is resumed from its checkpoint", "name the folder of a run"
            )
        try:
            with h5py.File(path) as file:
                checkpoint = cls._of(file, path)
                expected = file.attrs["sha256"]
        except (OSError, KeyError, RuntimeError, ValueError) as error:
            raise InputError(f"{path} is damaged or no HDF5 file", str(error).splitlines()[0], _REMEDY) from None
        if checkpoint._sha256() != expected:
            raise InputError(f"{path} is damaged", "its contents do not match their checksum", _REMEDY)
        return checkpoint

    @classmethod
    def _of(cls, file: h5py.File, path: Path) -> Checkpoint:
        if file.attrs.get("format") != _FORMAT:
            raise InputError(f"{path} is no checkpoint of tether", "it lacks the mark of one", _REMEDY)
        if file.attrs["format_version"] != _FORMAT_VERSION or file.attrs["version"] != __version__:
            raise InputError(
                f"{path} was written by tether {file.attrs['version']}",
                f"this is {__version__}, which may not continue it in the same bits",
                f"resume with tether {file.attrs['version']}, or run the configuration again",
            )
        return cls(
            configuration=Configuration(**tomllib.loads(str(file.attrs["configuration"]))),
            arrays={name: file[name][()] for name in file},
            numbers={name: int(file.attrs[name]) for name in ("step", "begin")},
            offset=float(file.attrs["offset"]),
            seconds=float(file.attrs["seconds"]),
            instruction_set=str(file.attrs["instruction_set"]),
        )

    def _sha256(self) -> str:
        digest = hashlib.sha256()
        for name in sorted(self.arrays):
            array = np.ascontiguousarray(self.arrays[name])
            digest.update(f"{name}{array.shape}".encode())
            digest.update(array.tobytes())
        digest.update(repr((sorted(self.numbers.items()), self.offset)).encode())
        return digest.hexdigest()
