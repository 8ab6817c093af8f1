"""Driving a simulation to its end while its record is written."""

from __future__ import annotations

import math
import shlex
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from tether.config import Interval
from tether.errors import RunError, TetherError
from tether.files import trajectory
from tether.files.lock import locked
from tether.record import Record, reason

if TYPE_CHECKING:
    from tether.simulation import Simulation

_CHUNK_SECONDS = 0.1
"""About how long the engine runs between looks at signals, files and the clock."""

_SERIES_SECONDS = 10.0
"""The least time between two writings of the series so far, which only pictures of a run under way need."""


Watch = Callable[["Simulation"], bool | None]
"""What is called after every chunk of steps; True stops the run after a checkpoint."""


class Stopped(KeyboardInterrupt):
    """The run was stopped by a signal, after a checkpoint (if it has a record)."""

    def __init__(self, signal_number: int, step: int, folder: Path | None) -> None:
        self.signal_number = signal_number
        how = f"; go on with: tether resume {shlex.quote(str(folder))}" if folder is not None else ""
        super().__init__(f"stopped at step {step}{how}")


def drive(
    simulation: Simulation,
    record: Record | None,
    watch: Watch | None = None,
) -> None:
    """Run the simulation to its end, writing the record as it goes.

    watch: called after every chunk of steps; where it returns True the run stops as if by SIGTERM. Raises Stopped, a
    KeyboardInterrupt, after Ctrl-C or SIGTERM (and a checkpoint), RunError when the run fails or the record cannot be
    written; what was measured is kept either way.
    """
    simulation.place()  # nothing is to be saved yet: a signal ends this at once
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
            raise RunError(f"{record.folder} cannot be written", reason(error), remedy) from error
    if stopped and not simulation.is_finished:
        raise Stopped(stopped[0], simulation.step, record.folder if record is not None else None)


def _recorded(simulation: Simulation, record: Record, watch: Watch | None, stopped: list[int]) -> None:
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
        result = simulation.result()
        record.write_datasets(result)
        record.write_summary(result)


def _advance(
    simulation: Simulation,
    writer: _Writer | None,
    watch: Watch | None,
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
        if watch is not None and watch(simulation):
            stopped.append(signal.SIGTERM)


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
