"""Work: one run of a study, wherever it is done; begun, or gone on with from its checkpoint."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from tether.config import Configuration
from tether.drive import Stopped, drive
from tether.errors import TetherError
from tether.files.lock import is_locked
from tether.record import Record, reason
from tether.resume import resume
from tether.simulation import Simulation
from tether.study.folder import Progress

_SECONDS_BETWEEN_LOOKS = 1.0
"""At the clock, whether to stop, and for what is written of the progress."""

_COST = 0.02
"""Running means take a moment to compute: at most this part of the time."""

_PATIENCE = 20.0
"""Seconds to wait for another worker to let a run go, since it was last seen to get on with it: one that has been told
to stop lets go in a moment, and one of a study that was killed on a cluster may first come to the run's end."""


@dataclass(frozen=True)
class Task:
    """What a worker has to know. Everything else is in the folders, which every worker sees."""

    folder: str
    """The run's."""
    configuration: Configuration
    threads: int
    stop: str
    """A file that tells all workers to stop once it is there; empty for none."""


@dataclass(frozen=True)
class Outcome:
    """How a run ended."""

    kind: Literal["done", "failed", "stopped"]
    failure: str = ""
    seconds: float = 0.0
    """Wall-clock time that this took."""


def work(task: Task) -> Outcome:
    """Do a run, or what is left of it. A run that has been done is left alone.

    Whoever is killed on the way loses what came after the last checkpoint, and only until the same bits have been
    computed again.
    """
    began = time.monotonic()
    folder = Path(task.folder)
    try:
        _wait_until_free(folder, task)
        if _is_to_stop(task):
            return Outcome("stopped")
        if (folder / "summary.json").is_file():
            return Outcome("done")
        simulation, record = _begun(folder, task)
        drive(simulation, record, _Watch(simulation, folder, task.stop))
    except Stopped:
        return Outcome("stopped", seconds=time.monotonic() - began)
    except (TetherError, OSError) as error:
        failure = str(error) if isinstance(error, TetherError) else f"{folder} cannot be written ({reason(error)})"
        _note_failure(folder, failure)
        return Outcome("failed", failure, time.monotonic() - began)
    return Outcome("done", seconds=time.monotonic() - began)


def _begun(folder: Path, task: Task) -> tuple[Simulation, Record]:
    """The run where it stands: from its folder if it is there, else from its beginning."""
    if (folder / "config.toml").is_file():
        simulation, record, _ = resume(folder, task.threads)
        return simulation, record
    simulation = Simulation.from_configuration(task.configuration, task.threads)
    Progress.forget(folder)  # of an attempt that failed before it made this a run's folder
    return simulation, Record.create(folder, task.configuration, force=True)


class _Watch:
    """Called after every chunk of steps: notes the progress, and stops the run when all are to stop."""

    def __init__(self, simulation: Simulation, folder: Path, stop: str) -> None:
        self._folder, self._stop = folder, Path(stop) if stop else None
        self._first = simulation.step
        self._began = self._last = time.monotonic()
        self._mean, self._mean_wait, self._mean_last = "", 0.0, self._began
        self._note(simulation)

    def __call__(self, simulation: Simulation) -> bool:
        now = time.monotonic()
        if now - self._last < _SECONDS_BETWEEN_LOOKS:
            return False
        self._last = now
        if now - self._mean_last >= self._mean_wait:
            self._mean = _mean(simulation)
            self._mean_last = time.monotonic()
            self._mean_wait = max(_SECONDS_BETWEEN_LOOKS, (self._mean_last - now) / _COST)
        self._note(simulation)
        return self._stop is not None and self._stop.exists()

    def _note(self, simulation: Simulation) -> None:
        seconds = time.monotonic() - self._began
        done = simulation.step - self._first
        Progress(simulation.step, simulation.end, seconds, done, self._mean).write(self._folder)


def _mean(simulation: Simulation) -> str:
    if not len(simulation.measured_samples()):
        return ""
    result = simulation.result()
    return f"eta {result.viscosity}" if result.viscosity is not None else f"p {result.pressure}"


def _is_to_stop(task: Task) -> bool:
    return bool(task.stop) and Path(task.stop).exists()


def _wait_until_free(folder: Path, task: Task) -> None:
    seen, until = Progress.read(folder), time.monotonic() + _PATIENCE
    while is_locked(folder) and time.monotonic() < until and not _is_to_stop(task):
        time.sleep(_SECONDS_BETWEEN_LOOKS / 10)
        if (progress := Progress.read(folder)) != seen:
            seen, until = progress, time.monotonic() + _PATIENCE


def _note_failure(folder: Path, failure: str) -> None:
    before = Progress.read(folder)
    step, end = (before.step, before.end) if before is not None else (0, 0)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        Progress(step, end, 0.0, failure=failure).write(folder)
    except OSError:
        pass  # the disk is what failed
