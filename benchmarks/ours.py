"""tether, told to run a setup in a manner."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import tether as tt
from benchmarks.setup import TEMPERATURE, Manner, Runner, Setup, as_json, setup_of
from benchmarks.worker import Worker, serve
from tether.engines.cpu import INSTRUCTION_SET_VARIABLE

_EQUILIBRATION = 400
"""Steps that a fluid runs before anything is timed: two units of time, a few times what its structure takes to form."""


_ENDLESS = 10**12
"""Steps of a run that measures: more than any benchmark takes."""


@dataclass(frozen=True)
class State:
    """Where particles are and how they move; both of shape (n, d)."""

    position: NDArray[np.float64]
    """In units of length, inside the box."""
    velocity: NDArray[np.float64]
    """In units of length / time, in the laboratory frame."""
    offset: float
    """Of the sheared box, in units of length."""


class Ours:
    """An engine in this process."""

    def __init__(self, setup: Setup, manner: Manner, state: State | None = None) -> None:
        """state: of the same setup; without one, particles are placed anew and equilibrated."""
        self.setup, self.manner = setup, manner
        self._simulation = simulation = _simulation(setup, manner)
        self.engine = simulation.engine
        self.particles = len(self.engine.species)
        if state is None:
            simulation.place()
            self.engine.run(min(_EQUILIBRATION, max(20, 32_000_000 // self.particles)))
        else:
            self.engine.offset = state.offset
            self.engine.position, self.engine.velocity = state.position, state.velocity
            self.engine.place()
            simulation._is_placed = True  # or it would place them itself when it advances

    @property
    def state(self) -> State:
        """A copy of it."""
        return State(self.engine.position, self.engine.velocity, self.engine.offset)

    def run(self, steps: int) -> float:
        """Go on by `steps`; return the seconds that it took."""
        return self.measure(steps)[1]

    def measure(self, steps: int) -> tuple[NDArray[np.float64], float]:
        """What the engine measured, shape (steps / interval, values), and the seconds that it took."""
        began = time.perf_counter()
        if self.manner.measures is None:
            measured = self.engine.run(steps, self.manner.interval)
        else:
            measured = np.empty((0, 0))
            self._simulation.advance(steps)
        seconds = time.perf_counter() - began
        if self.engine.fault is not None:
            raise RuntimeError(f"a particle ran away: {self.engine.fault}")
        return measured, seconds

    def close(self) -> None:
        """Give back the memory."""
        del self.engine, self._simulation


class OursApart:
    """The same in other processes, which all run at the same time."""

    def __init__(self, setup: Setup, manner: Manner) -> None:
        alone = as_json(setup, replace(manner, processes=0))
        self._workers = [Worker("benchmarks.ours", alone) for _ in range(manner.processes)]
        for worker in self._workers:
            worker.tell("particles")
        self.particles = sum(int(worker.answer()) for worker in self._workers)

    def run(self, steps: int) -> float:
        """Let each go on by `steps`; return the seconds until the last of them was done."""
        began = time.perf_counter()
        for worker in self._workers:
            worker.tell(f"run {steps}")
        for worker in self._workers:
            worker.answer()
        return time.perf_counter() - began

    def close(self) -> None:
        """End the processes."""
        for worker in self._workers:
            worker.close()


def ours(setup: Setup, manner: Manner, state: State | None) -> Runner:
    """Whichever of the two the manner asks for."""
    return OursApart(setup, manner) if manner.processes else Ours(setup, manner, state)


def _simulation(setup: Setup, manner: Manner) -> tt.Simulation:
    with _instruction_set(manner.instruction_set):
        simulation = tt.Simulation(
            box=tt.Box(*setup.box),
            fluid=tt.Fluid(temperature=TEMPERATURE, exponent=setup.exponent, density=setup.density),
            bodies=[tt.Bodies("cube", count=setup.cubes)] if setup.cubes else [],
            flow=tt.Couette(shear_rate=setup.shear_rate) if setup.shear_rate else None,
            timestep=setup.timestep,
            seed=1,
            threads=manner.threads,
            precision=manner.precision,
            measure=tt.Measure(**dict.fromkeys(manner.measures or (), True)),
        )
    if manner.measures is not None:  # as long as it is asked to be, and measuring from the start
        run = simulation.configuration.run.changed(steps=_ENDLESS)
        simulation = tt.Simulation.from_configuration(simulation.configuration.changed(run=run), manner.threads)
    return simulation


@contextmanager
def _instruction_set(name: str | None) -> Iterator[None]:
    before = os.environ.get(INSTRUCTION_SET_VARIABLE)
    if name is not None:
        os.environ[INSTRUCTION_SET_VARIABLE] = name
    try:
        yield
    finally:
        if name is not None:
            del os.environ[INSTRUCTION_SET_VARIABLE]
            if before is not None:
                os.environ[INSTRUCTION_SET_VARIABLE] = before


def main() -> None:
    """Serve: "particles" answers how many there are, "run N" the seconds that N steps took."""
    setup, manner = json.loads(sys.argv[1])
    runner = Ours(setup_of(setup), Manner(**manner))
    serve(lambda word, others: runner.particles if word == "particles" else runner.run(int(others[0])))


if __name__ == "__main__":
    main()
