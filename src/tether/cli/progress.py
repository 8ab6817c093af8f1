"""What is shown while a run goes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from tether.simulation import Simulation

_SECONDS_BETWEEN_MEANS = 1.0
"""Means and their errors take a moment to compute, so they are shown once a second."""


@contextmanager
def progress(simulation: Simulation, quiet: bool) -> Iterator[Callable[[Simulation], None] | None]:
    """A bar with rate, time left, running viscosity and temperature; gives what to call after each chunk."""
    if quiet:
        yield None
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(bar_width=24),
        TextColumn("{task.percentage:>3.0f}%"),
        TimeRemainingColumn(compact=True),
        TextColumn("{task.fields[rate]}{task.fields[means]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        begin = simulation.measured_from - simulation.configuration.run.equilibration
        task = bar.add_task(
            "starting", total=simulation.end - begin, completed=simulation.step - begin, rate="", means=""
        )
        particles = len(simulation.species)
        shown = [0.0, time.monotonic(), float(simulation.step)]

        def watch(running: Simulation) -> None:
            now = time.monotonic()
            measuring = running.step > running.measured_from
            bar.update(
                task,
                completed=running.step - begin,
                description="measuring" if measuring else "equilibrating",
            )
            if now - shown[0] >= _SECONDS_BETWEEN_MEANS:
                speed = particles * (running.step - shown[2]) / (now - shown[1]) / 1e6
                bar.update(task, rate=f"{speed:.2f} M particle-steps/s", means=_means(running))
                shown[:] = [now, now, float(running.step)]

        yield watch


def _means(simulation: Simulation) -> str:
    if not len(simulation.measured_samples()):
        return f"  kT {simulation.kinetic_temperature():.3f}"
    result = simulation.result()
    viscosity = f"  eta {result.viscosity}" if result.viscosity is not None else f"  p {result.pressure}"
    return f"{viscosity}  kT {result.temperature['all']}"
