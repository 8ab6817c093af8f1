"""Record: the folder of a run, and driving a simulation while it is written."""

from __future__ import annotations

import json
import math
import os
import shlex
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import xarray as xr

from tether.config import Configuration, Interval, load
from tether.engines import instruction_set
from tether.errors import InputError, RunError, TetherError
from tether.files import trajectory
from tether.files.checkpoint import Checkpoint
from tether.files.lock import locked
from tether.files.whole import part_of, whole
from tether.result import Result
from tether.simulation import Simulation
from tether.version import __version__

_CHUNK_SECONDS = 0.1
"""About how long the engine runs between looks at signals, files and the clock."""


_SERIES_SECONDS = 10.0
"""The least time between two writings of the series so far, which only pictures of a run under way need."""

_MARK = "# tether "
"""How config.toml begins: --force overwrites no folder without it, whatever else is called config.toml."""


class Stopped(KeyboardInterrupt):
    """The run was stopped by a signal, after a checkpoint (if it has a record)."""

    def __init__(self, signal_number: int, step: int, folder: Path | None) -> None:
        self.signal_number = signal_number
        how = f"; go on with: tether resume {shlex.quote(str(folder))}" if folder is not None else ""
        super().__init__(f"stopped at step {step}{how}")


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
            series = simulation.result().series
            with whole(self.series_path) as temporary:
                series.to_netcdf(temporary, engine="h5netcdf")

    def write_summary(self, result: Result) -> None:
        """Write summary.json."""
        with whole(self.summary_path) as temporary:
            temporary.write_text(json.dumps(result.as_dict(), indent=2, allow_nan=False) + "\n", encoding="utf-8")

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
        try:
            return xr.load_dataset(self.series_path, engine="h5netcdf")
        except (OSError, ValueError, KeyError) as error:
            raise InputError(
                f"{self.series_path} is damaged", str(error).splitlines()[0], "run the configuration again"
            ) from None

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
        pictures = [self.folder / f"{name}.{kind}" for name in ("series", "profile") for kind in ("png", "svg")]
        relative = [self.folder / f"relative.{kind}" for kind in ("json", "png", "svg")]
        written = [*files, *pictures, *relative]
        return [*written, *map(part_of, written), trajectory.set_aside(self.trajectory_path)]


def record_of(configuration: Configuration, out: str | Path, force: bool) -> Record:
    """A new record for a run from Python."""
    return Record.create(Path(out), configuration, force)


def resume(folder: Path, threads: int | None = None, more_steps: int = 0) -> tuple[Simulation, Record, list[str]]:
    """The simulation of a folder where its checkpoint left it, and remarks for the user. Nothing is written yet.

    more_steps: measured steps to add to the run's length. Raises InputError for what cannot be resumed.
    """
    record = Record.open(folder)
    checkpoint = None
    configuration = record.configuration()
    if record.checkpoint_path.exists():
        checkpoint = Checkpoint.read(record.checkpoint_path)
        configuration = _lengthened(checkpoint.configuration, configuration, record)
    elif record.summary_path.exists():
        raise InputError(
            f"{folder} has results and no checkpoint",
            "its run has ended and cannot go on without one",
            "see them with tether show, or run the configuration again",
        )  # else stopped before the first one: begin again, in the same bits
    if more_steps > 0:
        steps = configuration.steps + more_steps
        configuration = configuration.resolved()  # the intervals stay those of the shorter run
        configuration = configuration.changed(run=configuration.run.changed(steps=steps, strain=None))
    simulation = Simulation.from_configuration(configuration, threads)
    remarks = []
    if checkpoint is not None:
        simulation.restore(checkpoint)
        if checkpoint.instruction_set != instruction_set():
            remarks.append(
                f"the checkpoint was written on {checkpoint.instruction_set}, this is {instruction_set()} (the run "
                "goes on correctly, but not in the same bits)"
            )
    if not trajectory.is_readable(record.trajectory_path):
        aside = trajectory.set_aside(record.trajectory_path).name
        remarks.append(
            f"{record.trajectory_path} is damaged (it cannot be read as GSD); it is kept as {aside}, and a new one "
            "begins here"
        )
    return simulation, record, remarks


def _lengthened(checkpoint: Configuration, written: Configuration, record: Record) -> Configuration:
    """The checkpoint's configuration, as long as the one in config.toml, which differs in nothing else."""
    checkpoint = checkpoint.resolved()
    run = checkpoint.run.changed(steps=written.run.steps, strain=written.run.strain)
    lengthened = checkpoint.changed(run=run, output=checkpoint.output.changed(checkpoint=written.output.checkpoint))
    if lengthened.to_toml() != written.to_toml() or lengthened.steps < checkpoint.steps:
        raise InputError(
            f"{record.configuration_path} is not what this run was made from",
            "on the way only run.steps may grow and output.checkpoint change",
            "put it back as it was, or copy it and run it into another folder",
        )
    return lengthened


def drive(
    simulation: Simulation,
    record: Record | None,
    watch: Callable[[Simulation], None] | None = None,
) -> None:
    """Run the simulation to its end, writing the record as it goes.

    watch: called after every chunk of steps. Raises Stopped, a KeyboardInterrupt, after Ctrl-C or SIGTERM (and a
    checkpoint), RunError when the run fails or the record cannot be written; what was measured is kept either way.
    """
    if record is None:
        with _stop_signals() as stopped:
            _advance(simulation, None, watch, stopped)
    else:
        try:
            with locked(record.folder), _stop_signals() as stopped:
                _recorded(simulation, record, watch, stopped)
        except BrokenPipeError:
            raise  # from `watch`: the terminal has gone
        except OSError as error:
            remedy = f"see to the disk, then tether resume {shlex.quote(str(record.folder))}"
            raise RunError(f"{record.folder} cannot be written", _reason(error), remedy) from error
    if stopped and not simulation.is_finished:
        raise Stopped(stopped[0], simulation.step, record.folder if record is not None else None)


def _recorded(
    simulation: Simulation, record: Record, watch: Callable[[Simulation], None] | None, stopped: list[int]
) -> None:
    simulation.place()
    record.take_over(simulation)
    writer = _Writer(simulation, record)
    try:
        _advance(simulation, writer, watch, stopped)
    except TetherError:
        record.write_series(simulation)  # what was measured before a failure; the last checkpoint stays as it is
        raise
    finally:
        writer.trajectory.close()
    record.write_checkpoint(simulation)
    record.write_series(simulation)
    if simulation.is_finished:
        record.write_summary(simulation.result())


def _advance(
    simulation: Simulation,
    writer: _Writer | None,
    watch: Callable[[Simulation], None] | None,
    stopped: list[int],
) -> None:
    """Advance to the end, or until a signal."""
    chunk = 1
    while not simulation.is_finished and not stopped:
        most = chunk if writer is None else min(chunk, writer.steps_until_due())
        step, began = simulation.step, time.perf_counter()
        simulation.advance(most)
        spent = time.perf_counter() - began
        # From one measured step to the next: long enough to cost nothing, short enough to stop soon.
        chunk = max(1, min(2 * chunk, round(_CHUNK_SECONDS * (simulation.step - step) / max(spent, 1e-9))))
        if writer is not None:
            writer.look()
        if watch is not None:
            watch(simulation)


class _Writer:
    """Writes frames and checkpoints when they are due."""

    def __init__(self, simulation: Simulation, record: Record) -> None:
        self.simulation = simulation
        self.record = record
        self.trajectory = trajectory.Trajectory(record.trajectory_path)
        self._frames = simulation.configuration.frame_interval
        self._checkpoints = simulation.configuration.output.checkpoint
        self._last_frame = self._last_checkpoint = time.monotonic()
        self._last_checkpoint_step = simulation.step
        self._last_series = -math.inf
        if len(self.trajectory) == 0:
            self.trajectory.append(simulation)
        if not record.checkpoint_path.exists():
            self._checkpoint()

    def steps_until_due(self) -> int:
        """Steps until the next frame or checkpoint of those that are due by steps; at least 1."""
        step = self.simulation.step
        until = [1 << 62]
        if self._frames.steps is not None and step >= self.simulation.measured_from:
            until.append(self._next_frame_step(step) - step)
        if self._checkpoints.steps is not None:
            until.append(self._last_checkpoint_step + self._checkpoints.steps - step)
        return max(1, min(until))

    def look(self) -> None:
        """Write what is due."""
        step = self.simulation.step
        if step > self.simulation.measured_from and self._frame_is_due(step):
            self.trajectory.append(self.simulation)
            self._last_frame = time.monotonic()
        if _is_due(self._checkpoints, step - self._last_checkpoint_step, self._last_checkpoint):
            self._checkpoint()

    def _frame_is_due(self, step: int) -> bool:
        if self._frames.steps is None:
            return _is_due(self._frames, 0, self._last_frame)
        return step == self._next_frame_step(step - 1) or step == self.simulation.end

    def _next_frame_step(self, step: int) -> int:
        """The first step after `step` that has a frame."""
        assert self._frames.steps is not None
        begin = self.simulation.measured_from
        return begin + ((step - begin) // self._frames.steps + 1) * self._frames.steps

    def _checkpoint(self) -> None:
        self.trajectory.flush()
        self.record.write_checkpoint(self.simulation)
        now = time.monotonic()
        if len(self.simulation.measured_samples()) and now - self._last_series >= _SERIES_SECONDS:
            self.record.write_series(self.simulation)
            self._last_series = now
        self._last_checkpoint, self._last_checkpoint_step = now, self.simulation.step


def _is_due(interval: Interval, steps: int, last: float) -> bool:
    if interval.steps is not None:
        return steps >= interval.steps
    assert interval.seconds is not None
    return time.monotonic() - last >= interval.seconds


def _unwritable(folder: Path, error: OSError) -> InputError:
    return InputError(f"{folder} cannot be written", _reason(error), "choose another with --out")


def _reason(error: OSError) -> str:
    """Why the operating system refused, in its own short words (HDF5 puts a paragraph around them)."""
    return (os.strerror(error.errno) if error.errno else str(error).splitlines()[0]).lower()


@contextmanager
def _stop_signals() -> Iterator[list[int]]:
    """A list that gets the number of an SIGINT or SIGTERM; a second one interrupts at once.

    One that the process was started to ignore, as a shell does for background jobs of a script, stays ignored.
    """
    received: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield received
        return

    def note(number: int, _: FrameType | None) -> None:
        if received:
            raise KeyboardInterrupt
        received.append(number)

    heard = [number for number in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(number) != signal.SIG_IGN]
    former = {number: signal.signal(number, note) for number in heard}
    try:
        yield received
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)


__all__ = ["Record", "RunError", "Stopped", "drive", "record_of", "resume"]
