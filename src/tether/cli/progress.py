"""What is shown while a run goes: a bar in a terminal, a line now and then in a log."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from tether.simulation import Simulation

_SECONDS_BETWEEN_MEANS = 1.0
_SECONDS_BETWEEN_LINES = 60.0
_COST = 0.05
"""Means and their errors take a moment to compute: at most this part of the time."""

Watch = Callable[[Simulation], None]


@contextmanager
def progress(simulation: Simulation, quiet: bool) -> Iterator[Watch | None]:
    """Phase, part done, rate, running viscosity and temperature; gives what to call after each chunk."""
    if quiet:
        yield None
    elif not sys.stderr.isatty():
        yield _lines(simulation)
    else:
        with _bar() as bar:
            yield _moving(bar, simulation)


def _bar() -> Progress:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(bar_width=24),
        TextColumn("{task.percentage:>3.0f}%"),
        TimeRemainingColumn(compact=True),
        TextColumn("{task.fields[means]}"),
    )
    return Progress(*columns, console=Console(stderr=True), transient=True)


def _moving(bar: Progress, simulation: Simulation) -> Watch:
    begin = _begin(simulation)
    task = bar.add_task("starting", total=simulation.end - begin, completed=simulation.step - begin, means="")
    means = _Means(simulation, _SECONDS_BETWEEN_MEANS)

    def watch(running: Simulation) -> None:
        bar.update(task, completed=running.step - begin, description=_phase(running))
        if means.are_due():
            bar.update(task, means=means.now(running))

    return watch


def _lines(simulation: Simulation) -> Watch:
    begin = _begin(simulation)
    means = _Means(simulation, _SECONDS_BETWEEN_LINES)

    def watch(running: Simulation) -> None:
        if means.are_due():
            done = (running.step - begin) / (running.end - begin)
            print(f"{_phase(running)}, {done:.0%} done: {means.now(running)}", file=sys.stderr, flush=True)

    return watch


def _begin(simulation: Simulation) -> int:
    return simulation.measured_from - simulation.configuration.run.equilibration


def _phase(simulation: Simulation) -> str:
    return "measuring" if simulation.step > simulation.measured_from else "equilibrating"


class _Means:
    """Rate and running means as a line, so many seconds after the last one."""

    def __init__(self, simulation: Simulation, seconds: float) -> None:
        self._particles = len(simulation.species)
        self._seconds = self._wait = seconds
        self._last, self._last_step = time.monotonic(), simulation.step

    def are_due(self) -> bool:
        return time.monotonic() - self._last >= self._wait

    def now(self, simulation: Simulation) -> str:
        now = time.monotonic()
        rate = self._particles * (simulation.step - self._last_step) / (now - self._last) / 1e6
        line = f"{rate:.2f} M particle-steps/s{_means(simulation)}"
        self._last, self._last_step = time.monotonic(), simulation.step
        self._wait = max(self._seconds, (self._last - now) / _COST)
        return line


def _means(simulation: Simulation) -> str:
    if not len(simulation.measured_samples()):
        return f"  kT {simulation.kinetic_temperature():.3f}"
    result = simulation.result()
    viscosity = f"  eta {result.viscosity}" if result.viscosity is not None else f"  p {result.pressure}"
    return f"{viscosity}  kT {result.temperature['all']}"
