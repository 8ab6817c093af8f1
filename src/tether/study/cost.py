"""Cost: how long runs take, in proportion to one another and in seconds."""

from __future__ import annotations

import heapq
import math
import time
from collections.abc import Sequence
from typing import Any

from tether.config import Configuration
from tether.simulation import Simulation

_BESIDE_PAIRS = 3.0
"""What a particle costs beside its pairs, in pairs."""

_TRIAL_SECONDS = 0.5


def cost(configuration: Configuration, steps: int | None = None) -> float:
    """The pairs, and what is done beside them, of so many steps; all steps of the run where it is not told."""
    return cost_of_step(configuration) * (total_steps(configuration) if steps is None else steps)


def total_steps(configuration: Configuration) -> int:
    """Steps of a run, equilibration included."""
    return configuration.run.equilibration + configuration.steps


def cost_of_step(configuration: Configuration) -> float:
    """Particles, each with half the particles within the longest cutoff of it."""
    particles = configuration.solvent_count + configuration.constituent_count
    cutoff = configuration.pair_parameters().largest_cutoff
    ball = math.pi * cutoff**2 if configuration.dimension == 2 else 4 / 3 * math.pi * cutoff**3
    return particles * (_BESIDE_PAIRS + 0.5 * particles / configuration.box.volume * ball)


def speed_of(configuration: Configuration, summary: dict[str, Any]) -> tuple[float, float]:
    """What a finished run has cost, and the seconds that it took."""
    performance = summary["performance"]
    particles = configuration.solvent_count + configuration.constituent_count
    steps = performance["particle_steps_per_second"] * performance["seconds"] / particles
    return cost_of_step(configuration) * steps, performance["seconds"]


def trial(configuration: Configuration, threads: int) -> float:
    """Cost per second on this machine, from the first steps of a run: half a second of them."""
    simulation = Simulation.from_configuration(configuration, threads)
    simulation.place()
    began, portion, first = time.perf_counter(), 10, simulation.step
    while time.perf_counter() - began < _TRIAL_SECONDS and not simulation.is_finished:
        simulation.advance(portion)
    return cost(configuration, simulation.step - first) / (time.perf_counter() - began)


def makespan(seconds: Sequence[float], workers: int) -> float:
    """How long runs of so many seconds take together on so many workers, the longest first."""
    free = [0.0] * max(1, min(workers, len(seconds)))
    for each in sorted(seconds, reverse=True):
        heapq.heappush(free, heapq.heappop(free) + each)
    return max(free)
