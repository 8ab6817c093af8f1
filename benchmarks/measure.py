"""Speeds of a group of cases, measured in turns."""

from __future__ import annotations

import statistics
from dataclasses import asdict, dataclass

from benchmarks.cases import Case, Group, Lammps
from benchmarks.lammps_peer import Peer, lammps_version
from benchmarks.ours import Ours, State, ours
from benchmarks.setup import Manner, Runner

_WARM_UP_SECONDS = 0.1
"""A case first runs about twice this long: its particles get their order in memory, and its speed is known."""


@dataclass(frozen=True)
class Row:
    """What was measured of a case. Speeds are in million particle-steps per second, medians over turns."""

    case: Case
    instruction_set: str
    particles: int
    speed: float
    baseline: str | None
    """What it is compared with: LAMMPS, or another case of ours."""
    baseline_speed: float | None
    ratio: float | None
    """Median over turns of our speed over the baseline's in the same turn."""
    spread: tuple[float, float] | None
    """Least and most of that ratio."""
    skin: float | None
    """LAMMPS's neighbor skin, in units of length."""

    @property
    def detail(self) -> str:
        """Precision and instruction set."""
        return f"{self.case.manner.precision} / {self.instruction_set.removeprefix('x86-64-')}"

    @property
    def aim(self) -> str:
        """What we aim at, and whether it was met."""
        aim, got = self.case.least_ratio, self.ratio
        if aim is None:
            aim, got = self.case.least_speed, self.speed
        if aim is None or got is None:
            return ""
        unit = "x" if self.case.least_ratio is not None else " M/s"
        return f">= {aim:g}{unit} {'met' if got >= aim else 'missed'}"

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {
            "case": self.case.name,
            "detail": self.detail,
            "setup": asdict(self.case.setup),
            "manner": asdict(self.case.manner),
            "instruction_set": self.instruction_set,
            "particles": self.particles,
            "speed": self.speed,
            "baseline": self.baseline,
            "baseline_speed": self.baseline_speed,
            "ratio": self.ratio,
            "spread": self.spread,
            "least_ratio": self.case.least_ratio,
            "least_speed": self.case.least_speed,
            "lammps_skin": self.skin,
        }


def measure(group: Group, turns: int, seconds: float, widest_set: str) -> list[Row]:
    """Rows of the group's cases, each run for about `seconds` in each turn."""
    state = _state(group)
    baseline = _baseline(group, state)
    runners = [ours(case.setup, case.manner, state) for case in group.cases]
    everyone = [*([baseline] if baseline else []), *runners]
    try:
        steps = {runner: _steps(runner, seconds) for runner in everyone}
        speeds: dict[Runner, list[float]] = {runner: [] for runner in everyone}
        for turn in range(turns):
            for runner in everyone if turn % 2 == 0 else everyone[::-1]:
                speeds[runner].append(runner.particles * steps[runner] / runner.run(steps[runner]) / 1e6)
        rows = []
        for case, runner in zip(group.cases, runners, strict=True):
            ratios = [a / b for a, b in zip(speeds[runner], speeds[baseline], strict=True)] if baseline else []
            rows.append(
                Row(
                    case=case,
                    instruction_set=case.manner.instruction_set or widest_set,
                    particles=runner.particles,
                    speed=statistics.median(speeds[runner]),
                    baseline=_name(group) if baseline else None,
                    baseline_speed=statistics.median(speeds[baseline]) if baseline else None,
                    ratio=statistics.median(ratios) if ratios else None,
                    spread=(min(ratios), max(ratios)) if ratios else None,
                    skin=baseline.skin if isinstance(baseline, Peer) else None,
                )
            )
        return rows
    finally:
        for runner in everyone:
            runner.close()


def _state(group: Group) -> State | None:
    """A state that all start from, when all have the same setup."""
    setups = {case.setup for case in group.cases}
    setups |= {group.baseline.setup} if group.baseline else set()
    if len(setups) > 1 or any(case.manner.processes for case in group.cases):
        return None
    first = Ours(setups.pop(), Manner())
    state = first.state
    first.close()
    return state


def _baseline(group: Group, state: State | None) -> Runner | None:
    if isinstance(group.baseline, Case):
        return ours(group.baseline.setup, group.baseline.manner, state)
    if group.baseline is None or lammps_version() is None:
        return None
    assert state is not None
    return Peer(group.baseline.setup, state)


def _name(group: Group) -> str:
    return "LAMMPS" if isinstance(group.baseline, Lammps) else group.baseline.name if group.baseline else ""


def _steps(runner: Runner, seconds: float) -> int:
    """How many steps take about that long, by running more and more of them."""
    steps = 1
    while (took := runner.run(steps)) < _WARM_UP_SECONDS:
        steps = max(2 * steps, round(_WARM_UP_SECONDS / max(took, 1e-6) * steps * 0.5))
    return max(1, round(steps * seconds / took))
