"""Speed of the plain 3D fluid, in million particle-steps per second: the median of several turns of each case.

The cases take turns, so that a machine whose speed drifts is the same for all of them.
"""

from __future__ import annotations

import argparse
import statistics
import time

import tether as tt
from tether.engines import CpuEngine


def _engine(particles: int, threads: int) -> CpuEngine:
    side = (particles / 4) ** (1 / 3)
    simulation = tt.Simulation(
        box=tt.Box(side, side, side), fluid=tt.Fluid(temperature=1.0), timestep=0.005, seed=1, threads=threads
    )
    simulation.place()
    return simulation.engine


def _speed(engine: CpuEngine, steps: int, interval: int) -> float:
    began = time.perf_counter()
    engine.run(steps, interval)
    return len(engine.species) * steps / (time.perf_counter() - began) / 1e6


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--turns", type=int, default=5, help="times that each case is measured")
    turns = parser.parse_args().turns
    cases = [(particles, threads) for particles in (16_000, 256_000) for threads in (1, 2)]
    engines = {case: _engine(*case) for case in cases}
    speeds: dict[tuple[int, int, int], list[float]] = {}
    for _ in range(turns):
        for (particles, threads), engine in engines.items():
            for interval in (0, 1):
                steps = max(1, 1_600_000 // particles)
                speeds.setdefault((particles, threads, interval), []).append(_speed(engine, steps, interval))
    print("3D plain fluid, n = 4, s = 1/2, double precision: million particle-steps per second, median (least-most)")
    print(f"{'particles':>10} {'threads':>8} {'plain':>20} {'stress every step':>20}")
    for particles, threads in cases:
        row = [speeds[particles, threads, interval] for interval in (0, 1)]
        shown = [f"{statistics.median(s):.2f} ({min(s):.2f}-{max(s):.2f})" for s in row]
        print(f"{particles:>10} {threads:>8} {shown[0]:>20} {shown[1]:>20}")


if __name__ == "__main__":
    main()
