"""Record: the folder of a run."""

from __future__ import annotations

import json
import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from tether.config import Configuration, load
from tether.errors import InputError
from tether.files import trajectory
from tether.files.lock import locked
from tether.files.whole import part_of, whole
from tether.result import Result
from tether.version import __version__

if TYPE_CHECKING:
    from tether.simulation import Simulation

_MARK = "# tether "
"""How config.toml begins: --force overwrites no folder without it, whatever else is called config.toml."""


DATASETS = (
    "profiles",
    "stress_profile",
    "radial_distribution",
    "displacement",
    "lissajous",
    "start_up",
    "green_kubo",
    "green_kubo_integral",
)
"""Names of the files, without .nc, of what is measured as a function of something else than time."""


class Record:
    """A folder that holds config.toml, trajectory.gsd, series.nc, checkpoint.h5, summary.json and pictures."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.configuration_path = folder / "config.toml"
        self.trajectory_path = folder / "trajectory.gsd"
        self.series_path = folder / "series.nc"
        self.checkpoint_path = folder / "checkpoint.h5"
        self.summary_path = folder / "summary.json"

    @classmethod
    def create(cls, folder: Path, configuration: Configuration, force: bool = False) -> Record:
        """A new folder for a run. Raises InputError when it exists (unless `force`) or cannot be written."""
        record = cls(folder)
        record.check_free(force)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with locked(folder):
                for path in record._written():
                    path.unlink(missing_ok=True)
                record._write_configuration(configuration)
        except OSError as error:
            raise _unwritable(folder, error) from None
        return record

    def check_free(self, force: bool = False) -> None:
        """Raise InputError when a new run may not be written here."""
        folder = self.folder
        try:
            if folder.exists() and not folder.is_dir():
                raise InputError(f"{folder} is a file", "a run writes a folder", "choose another with --out")
            if not folder.is_dir() or not any(path for path in folder.iterdir() if path.name[0] != "."):
                return
            is_run = self.configuration_path.is_file() and self.configuration_path.read_bytes().startswith(
                _MARK.encode()
            )
        except OSError as error:
            raise _unwritable(folder, error) from None
        if not is_run:
            raise InputError(
                f"{folder} exists and is no folder of a run",
                "what it holds is left alone, with --force too",
                "choose another with --out",
            )
        if not force:
            raise InputError(
                f"{folder} exists",
                "the run in it would be overwritten",
                f"choose another with --out, go on with tether resume {shlex.quote(str(folder))}, or overwrite it "
                "with --force",
            )

    @classmethod
    def open(cls, folder: Path) -> Record:
        """The folder of an earlier run. Raises InputError when it is none."""
        record = cls(folder)
        if not record.configuration_path.is_file():
            raise InputError(
                f"{folder} is no folder of a run",
                "it has no config.toml",
                "name a folder that tether run wrote",
            )
        return record

    def configuration(self) -> Configuration:
        """The configuration as resolved."""
        return load(self.configuration_path)

    def take_over(self, simulation: Simulation) -> None:
        """Make the folder stand where the simulation stands: its configuration, and no frame after its step."""
        if not self._holds(simulation.configuration):
            self._write_configuration(simulation.configuration)
        trajectory.cut(self.trajectory_path, simulation.step)

    def write_checkpoint(self, simulation: Simulation) -> None:
        """Write the checkpoint."""
        simulation.checkpoint().write(self.checkpoint_path)

    def write_series(self, simulation: Simulation) -> None:
        """Write the series measured so far, if anything is."""
        if len(simulation.measured_samples()):
            series = simulation.series()
            with whole(self.series_path) as temporary:
                series.to_netcdf(temporary, engine="h5netcdf")

    def write_summary(self, result: Result) -> None:
        """Write summary.json."""
        with whole(self.summary_path) as temporary:
            temporary.write_text(json.dumps(result.as_dict(), indent=2, allow_nan=False) + "\n", encoding="utf-8")

    def write_datasets(self, result: Result) -> None:
        """Write what was measured as a function of something else than time: a file for each."""
        for name, dataset in result.datasets.items():
            with whole(self.dataset_path(name)) as temporary:
                dataset.to_netcdf(temporary, engine="h5netcdf")

    def dataset_path(self, name: str) -> Path:
        """The file of a dataset, of DATASETS."""
        return self.folder / f"{name}.nc"

    def datasets(self) -> dict[str, xr.Dataset]:
        """What write_datasets wrote, by name. Raises InputError when a file is damaged."""
        paths = {name: self.dataset_path(name) for name in DATASETS}
        return {name: _loaded(path) for name, path in paths.items() if path.is_file()}

    def summary(self) -> dict[str, Any]:
        """What summary.json holds. Raises InputError when the run has not ended."""
        if not self.summary_path.is_file():
            raise InputError(
                f"{self.folder} has no results",
                "its run has not ended",
                f"go on with tether resume {self.folder}",
            )
        try:
            summary: dict[str, Any] = json.loads(self.summary_path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise InputError(f"{self.summary_path} is damaged", str(error), "run the configuration again") from None
        return summary

    def series(self) -> xr.Dataset:
        """The series measured so far. Raises InputError when there is none."""
        if not self.series_path.is_file():
            raise InputError(
                f"{self.folder} has no series",
                "nothing has been measured yet",
                f"go on with tether resume {self.folder}",
            )
        return _loaded(self.series_path)

    def _write_configuration(self, configuration: Configuration) -> None:
        with whole(self.configuration_path) as temporary:
            temporary.write_text(
                f"{_MARK}{__version__} wrote this: the configuration of the run in this folder, as resolved.\n"
                f"{configuration.to_toml()}",
                encoding="utf-8",
            )

    def _holds(self, configuration: Configuration) -> bool:
        try:
            return self.configuration().to_toml() == configuration.to_toml()
        except InputError:
            return False

    def _written(self) -> list[Path]:
        files = [self.trajectory_path, self.series_path, self.checkpoint_path, self.summary_path]
        files += [self.dataset_path(name) for name in DATASETS]
        drawn = ("series", "profile", *DATASETS)
        pictures = [self.folder / f"{name}.{kind}" for name in drawn for kind in ("png", "svg")]
        relative = [self.folder / f"relative.{kind}" for kind in ("json", "png", "svg")]
        written = [*files, *pictures, *relative]
        return [*written, *map(part_of, written), trajectory.set_aside(self.trajectory_path)]


def _loaded(path: Path) -> xr.Dataset:
    try:
        return xr.load_dataset(path, engine="h5netcdf")
    except (OSError, ValueError, KeyError) as error:
        raise InputError(f"{path} is damaged", str(error).splitlines()[0], "run the configuration again") from None


def _unwritable(folder: Path, error: OSError) -> InputError:
    return InputError(f"{folder} cannot be written", reason(error), "choose another with --out")


def reason(error: OSError) -> str:
    """Why the operating system refused, in its own short words (HDF5 puts a paragraph around them)."""
    return (os.strerror(error.errno) if error.errno else str(error).splitlines()[0]).lower()
