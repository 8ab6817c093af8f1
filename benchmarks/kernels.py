"""Where the time of a step goes, in nanoseconds per particle-step: phases of the engine, then noise and law alone."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path

from benchmarks.ours import Ours
from benchmarks.setup import DENSITY, Manner, Setup, cubic

PAIRS_PER_PARTICLE = 2 / 3 * pi * DENSITY
"""Pairs within the cutoff 1 for each particle of an ideal gas at the fluid's density: 8.4."""

_FLAGS = ("-std=c++20", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math", "-Wno-psabi")
_WIDE = {"x86-64-v4": ("-mprefer-vector-width=512",)}
_CORE = Path(__file__).parent.parent / "core"


@dataclass(frozen=True)
class Phases:
    """Nanoseconds per particle-step in each phase of the engine, mixed precision, one thread."""

    name: str
    nanoseconds: dict[str, float]
    total: float
    """By the clock outside the engine."""


def phases(seconds: float) -> list[Phases]:
    """Of the plain fluid, without and with stress, and of a suspension, each run for about `seconds`."""
    plain, suspension = cubic(16_000, 0.5), Setup((10.0, 10.0, 10.0), shear_rate=0.2, cubes=250)
    return [
        _phases("plain, 16000, s = 1/2", plain, Manner(), seconds),
        _phases("the same, stress every step", plain, Manner(interval=1), seconds),
        _phases("plain, 16000, s = 2", cubic(16_000, 2.0), Manner(), seconds),
        _phases("250 cubes in 4000 solvent", suspension, Manner(), seconds),
        _phases("the same, stress every step", suspension, Manner(interval=1), seconds),
    ]


def _phases(name: str, setup: Setup, manner: Manner, seconds: float) -> Phases:
    runner = Ours(setup, manner)
    steps = max(1, round(seconds * 50 / runner.run(50)))
    before = dict(runner.engine.seconds)
    runner.engine.is_timed = True
    took = runner.run(steps)
    per_step = 1e9 / (runner.particles * steps)
    spent = {phase: (after - before[phase]) * per_step for phase, after in runner.engine.seconds}
    runner.close()
    return Phases(name, spent, took * per_step)


def alone(instruction_sets: Sequence[str]) -> dict[str, dict[str, float]]:
    """Nanoseconds a pair of noise and law, by instruction set; empty without a compiler."""
    made = {}
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "kernels"
        for name in instruction_sets:
            command = ["g++", *_FLAGS, f"-march={name}", *_WIDE.get(name, ()), f"-I{_CORE}"]
            source = Path(__file__).with_suffix(".cpp")
            try:
                subprocess.run([*command, str(source), "-o", str(program)], check=True)
            except FileNotFoundError:
                return {}
            printed = subprocess.run([str(program)], check=True, capture_output=True, text=True).stdout
            made[name] = {word: float(number) for word, number in map(str.split, printed.splitlines())}
    return made


def shown(all_phases: Sequence[Phases], parts: dict[str, dict[str, float]]) -> str:
    """Two tables, as text."""
    names = list(all_phases[0].nanoseconds)
    lines = ["Nanoseconds per particle-step in each phase, mixed precision, one thread", ""]
    lines.append(f"{'':<28}{''.join(f'{name:>12}' for name in (*names, 'rest', 'total'))}")
    for of in all_phases:
        spent = [of.nanoseconds[name] for name in names]
        numbers = (*spent, of.total - sum(spent), of.total)
        lines.append(f"{of.name:<28}{''.join(f'{number:>12.2f}' for number in numbers)}")
    lines += ["", f"Alone: nanoseconds per pair, and per particle-step of {PAIRS_PER_PARTICLE:.1f} pairs", ""]
    if not parts:
        lines.append("no g++ was found to compile them")
        return "\n".join(lines)
    lines.append(f"{'':<28}{''.join(f'{name:>24}' for name in parts)}")
    for kernel in next(iter(parts.values())):
        cells = [f"{of[kernel]:.3f} / {of[kernel] * PAIRS_PER_PARTICLE:.2f}" for of in parts.values()]
        lines.append(f"{kernel.replace('_', ' '):<28}{''.join(f'{cell:>24}' for cell in cells)}")
    return "\n".join(lines)
