"""Record: the folder of a run, and driving a simulation while it is written."""

from __future__ import annotations

import fcntl
import json
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from types import FrameType
from typing import Any

import xarray as xr

from tether.config import Configuration, Interval, load
from tether.errors import InputError, RunError, TetherError
from tether.files import trajectory
from tether.files.checkpoint import Checkpoint
from tether.files.whole import whole
from tether.result import Result
from tether.simulation import Simulation

_CHUNK_SECONDS = 0.1
"""About how long the engine runs between looks at signals, files and the clock."""


class Stopped(Exception):  # noqa: N818  (stopping is no error)
    """The run was stopped by a signal, after a checkpoint (if it has a record)."""

    def __init__(self, signal_number: int, step: int, folder: Path | None) -> None:
        self.signal_number = signal_number
        how = f"; go on with: tether resume {folder}" if folder is not None else ""
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
        if folder.exists() and not folder.is_dir():
            raise InputError(f"{folder} is a file", "a run writes a folder", "choose another with --out")
        if folder.is_dir() and any(folder.iterdir()):
            if not record.configuration_path.is_file():
                raise InputError(
                    f"{folder} exists and is no folder of a run",
                    "what it holds is left alone, with --force too",
                    "choose another with --out",
                )
            if not force:
                raise InputError(
                    f"{folder} exists",
                    "the run in it would be overwritten",
                    f"choose another with --out, go on with tether resume {folder}, or overwrite it with --force",
                )
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with record.locked():
                for path in record._written():
                    path.unlink(missing_ok=True)
                record.write_configuration(configuration)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise InputError(f"{folder} cannot be written", reason, "choose another with --out") from None
        return record

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

    def write_configuration(self, configuration: Configuration) -> None:
        """Write config.toml."""
        with whole(self.configuration_path) as temporary:
            temporary.write_text(configuration.to_toml(), encoding="utf-8")

    def write_checkpoint(self, simulation: Simulation) -> None:
        """Write the checkpoint, and the series measured so far."""
        simulation.checkpoint().write(self.checkpoint_path)
        if len(simulation.measured_samples()):
            self._write_series(simulation.result())

    def write_result(self, result: Result) -> None:
        """Write the series and summary.json."""
        self._write_series(result)
        with whole(self.summary_path) as temporary:
            temporary.write_text(json.dumps(result.as_dict(), indent=2) + "\n", encoding="utf-8")

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

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other processes from writing into the folder. Raises InputError when one does."""
        handle = os.open(self.folder, os.O_RDONLY)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            raise InputError(
                f"{self.folder} is in use", "another tether is running in it", "wait for it, or stop it"
            ) from None
        try:
            yield
        finally:
            os.close(handle)

    def _write_series(self, result: Result) -> None:
        with whole(self.series_path) as temporary:
            result.series.to_netcdf(temporary, engine="h5netcdf")

    def _written(self) -> list[Path]:
        files = [
            self.trajectory_path, self.series_path, self.checkpoint_path, self.summary_path,
            self.trajectory_path.with_name("trajectory.gsd.damaged"),
        ]  # fmt: skip
        return files + [path for kind in ("png", "svg") for path in self.folder.glob(f"*.{kind}")]


def record_of(configuration: Configuration, out: str | Path, force: bool) -> Record:
    """A new record for a run from Python."""
    return Record.create(Path(out), configuration, force)


def resume(folder: Path, threads: int | None = None, more_steps: int = 0) -> tuple[Simulation, Record, list[str]]:
    """The simulation of a folder where its checkpoint left it, and remarks for the user.

    more_steps: measured steps to add to the run's length. Raises InputError for what cannot be resumed.
    """
    record = Record.open(folder)
    if not record.checkpoint_path.exists():  # stopped before the first one: begin again, in the same bits
        checkpoint = None
        configuration = record.configuration()
    else:
        checkpoint = Checkpoint.read(record.checkpoint_path)
        configuration = checkpoint.configuration
    if more_steps > 0:
        steps = configuration.steps + more_steps
        configuration = configuration.resolved()  # the intervals stay those of the shorter run
        configuration = configuration.changed(run=configuration.run.changed(steps=steps, strain=None))
        record.write_configuration(configuration)
    simulation = Simulation.from_configuration(configuration, threads)
    remarks = []
    if checkpoint is not None:
        simulation.restore(checkpoint)
        from tether.engines import instruction_set

        if checkpoint.instruction_set != instruction_set():
            remarks.append(
                f"the checkpoint was written on {checkpoint.instruction_set}, this is {instruction_set()} (the run "
                "goes on correctly, but not in the same bits)"
            )
    trajectory.cut(record.trajectory_path, simulation.step if checkpoint is not None else -1)
    return simulation, record, remarks


def drive(
    simulation: Simulation,
    record: Record | None,
    watch: Callable[[Simulation], None] | None = None,
) -> None:
    """Run the simulation to its end, writing the record as it goes.

    watch: called after every chunk of steps. Raises Stopped (SIGTERM in any case, Ctrl-C with a record) or
    KeyboardInterrupt after a checkpoint, RunError when the run fails; what was measured is written either way.
    """
    lock: AbstractContextManager[None] = record.locked() if record is not None else nullcontext()
    with lock, _stop_signals() as stopped:
        simulation.place()
        writer = _Writer(simulation, record) if record is not None else None
        chunk = 1
        try:
            while not simulation.is_finished:
                most = min(chunk, writer.steps_to_frame()) if writer is not None else chunk
                step, began = simulation.step, time.perf_counter()
                simulation.advance(most)
                spent = time.perf_counter() - began
                # From one measured step to the next: long enough to cost nothing, short enough to stop soon.
                chunk = max(1, min(2 * chunk, round(_CHUNK_SECONDS * (simulation.step - step) / max(spent, 1e-9))))
                if writer is not None:
                    writer.look()
                if watch is not None:
                    watch(simulation)
                if stopped:
                    break
        except TetherError:
            if writer is not None:
                writer.save_series()
            raise
        finally:
            if writer is not None:
                writer.trajectory.close()
        if record is not None:
            record.write_checkpoint(simulation)
            if simulation.is_finished:
                record.write_result(simulation.result())
        if stopped and not simulation.is_finished:
            raise Stopped(stopped[0], simulation.step, record.folder if record is not None else None)


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
        self._frame_step = simulation.step
        if len(self.trajectory) == 0:
            self.trajectory.append(simulation)
        if not record.checkpoint_path.exists():
            self._checkpoint()

    def steps_to_frame(self) -> int:
        """Steps until the next frame that is due by steps."""
        step = self.simulation.step
        if self._frames.steps is None or step < self.simulation.measured_from:
            return 1 << 62
        return self._next_frame_step(step) - step

    def look(self) -> None:
        """Write what is due."""
        step = self.simulation.step
        if step > self.simulation.measured_from and self._frame_is_due(step):
            self.trajectory.append(self.simulation)
            self._last_frame, self._frame_step = time.monotonic(), step
        if _is_due(self._checkpoints, step - self._last_checkpoint_step, self._last_checkpoint):
            self._checkpoint()

    def save_series(self) -> None:
        """Keep what was measured before a failure; the last checkpoint stays as it is."""
        if len(self.simulation.measured_samples()):
            self.record._write_series(self.simulation.result())

    def _frame_is_due(self, step: int) -> bool:
        if self._frames.steps is None:
            return _is_due(self._frames, 0, self._last_frame)
        return step == self._next_frame_step(step - 1) or step == self.simulation.end

    def _next_frame_step(self, step: int) -> int:
        """The first step after `step` that has a frame: a whole number of intervals, each of whole samples."""
        assert self._frames.steps is not None
        sample = self.simulation.configuration.series_interval
        interval = -(-self._frames.steps // sample) * sample
        begin = self.simulation.measured_from
        return begin + ((step - begin) // interval + 1) * interval

    def _checkpoint(self) -> None:
        self.trajectory.flush()
        self.record.write_checkpoint(self.simulation)
        self._last_checkpoint, self._last_checkpoint_step = time.monotonic(), self.simulation.step


def _is_due(interval: Interval, steps: int, last: float) -> bool:
    if interval.steps is not None:
        return steps >= interval.steps
    assert interval.seconds is not None
    return time.monotonic() - last >= interval.seconds


@contextmanager
def _stop_signals() -> Iterator[list[int]]:
    """A list that gets the number of an SIGINT or SIGTERM; a second one interrupts at once."""
    received: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield received
        return

    def note(number: int, _: FrameType | None) -> None:
        if received:
            raise KeyboardInterrupt
        received.append(number)

    former = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield received
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)


__all__ = ["Record", "RunError", "Stopped", "drive", "record_of", "resume"]
