"""Ledger: where the runs of a study stand, what they have found so far, and how long the rest takes."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, Protocol

from tether.config import StopWhen
from tether.study.cost import cost, makespan, speed_of
from tether.study.folder import Progress, State, StudyFolder
from tether.study.means import Mean, mean_of
from tether.study.study import Ensemble, Point


class Asked(Protocol):
    """What asks for runs: a study, or several together."""

    @property
    def points(self) -> list[Point]:
        """Every run that is asked for, in the order of their numbers."""

    @property
    def all_ensembles(self) -> list[Ensemble]:
        """What the runs are of."""

    @property
    def repeats(self) -> int:
        """How many runs of each there are at most."""

    @property
    def stop_when(self) -> StopWhen | None:
        """Relative errors of means at which no more repeats are begun."""


class Ledger:
    """The runs of a study, as its folder has them."""

    def __init__(self, study: Asked, folder: StudyFolder) -> None:
        self.study = study
        self.folder = folder
        self.states: dict[str, State] = {}
        """Of all runs that are asked for or were added, by their identities."""
        self.summaries: dict[str, dict[str, Any]] = {}
        """Of the runs that are done."""
        self.running: dict[str, Point] = {}
        """Under way, as far as is known here."""
        self.failures: dict[str, str] = {}
        self.workers = 1
        self._cost = self._seconds = 0.0
        self._repeats: dict[int, list[Point]] = {}  # of each ensemble, by its id
        for point in [*study.points, *extra_repeats(study, folder)]:
            self._repeats.setdefault(id(point.ensemble), []).append(point)
        self.states = folder.states(self.points)
        for point in self.points:
            self._enter(point)

    def _enter(self, point: Point) -> None:
        match self.states[point.identity].kind:
            case "done":
                self._take(point)
            case "running":
                self.running[point.identity] = point

    @property
    def points(self) -> list[Point]:
        """The runs that are asked for, and those that an adaptive study has added."""
        return [point for repeats in self._repeats.values() for point in repeats]

    def repeats_of(self, ensemble: Ensemble) -> list[Point]:
        """All runs of a setting that are asked for or were added."""
        return self._repeats[id(ensemble)]

    # --- what has been found ---

    def relative_error(self, repeats: Iterable[Point], quantity: str) -> float:
        """Of the mean over runs that are done; infinite where it is not known."""
        mean = self.mean(repeats, quantity)
        known = mean.repeats > 0 and math.isfinite(mean.error) and mean.value != 0
        return mean.error / abs(mean.value) if known else math.inf

    def mean(self, repeats: Iterable[Point], quantity: str) -> Mean:
        """The mean of a quantity over those of the runs that are done."""
        done = [self.summaries[point.identity] for point in repeats if point.identity in self.summaries]
        entries = [summary.get(quantity) or {"value": None, "error": None} for summary in done]
        values, errors = ([math.nan if e[k] is None else e[k] for e in entries] for k in ("value", "error"))
        return mean_of(values, errors, [summary["steps"] for summary in done])

    def _take(self, point: Point) -> None:
        """Note what a finished run has found, and how long it took."""
        summary = self.folder.summary(point)
        self.summaries[point.identity] = summary
        spent, seconds = speed_of(point.configuration, summary)
        self._cost += spent
        self._seconds += seconds

    def look(self) -> None:
        """See how far the runs under way have come."""
        for name, point in self.running.items():
            progress = Progress.read(self.folder.path(point))
            if progress is not None and progress != self.states[name].progress:
                self.states[name] = State("running", progress)

    # --- time ---

    def seconds_of(self, point: Point, *, left: bool = False) -> float:
        """About how long a run takes, or what is left of it; nan before any has been done."""
        return self._seconds_at(self.speed, point, left)

    def _seconds_at(self, speed: float, point: Point, left: bool) -> float:
        state = self.states.get(point.identity)
        done = state.progress.fraction if left and state is not None and state.progress is not None else 0.0
        return (1.0 - done) * point.cost / speed if speed else math.nan

    @property
    def speed(self) -> float:
        """Cost per second of one worker: of the runs that are done and of those under way; 0 before any is known."""
        total, seconds = self._cost, self._seconds
        for name, point in self.running.items():
            progress = self.states[name].progress
            if progress is not None and progress.seconds > 0 and self.states[name].kind == "running":
                total += cost(point.configuration, progress.done)
                seconds += progress.seconds
        return total / seconds if seconds > 0 else 0.0

    def assume(self, speed: float) -> None:
        """Take a speed that was found in another way, for as long as no run tells one."""
        self._cost, self._seconds = speed, 1.0

    @property
    def seconds_left(self) -> float:
        """About how long what is asked for still takes; nan before anything is known."""
        to_do = [p for p in self.points if self.states[p.identity].kind != "done" and p.identity not in self.failures]
        speed = self.speed
        return makespan([self._seconds_at(speed, point, True) for point in to_do], self.workers) if to_do else 0.0

    @property
    def fraction(self) -> float:
        """Part of all steps that is done, each weighted with its cost, from 0 to 1."""
        total = done = 0.0
        for point in self.points:
            each = point.cost
            state = self.states[point.identity]
            part = 1.0 if state.kind == "done" else state.progress.fraction if state.progress is not None else 0.0
            total, done = total + each, done + each * part
        return done / total if total else 1.0


def extra_repeats(study: Asked, folder: StudyFolder) -> list[Point]:
    """Runs beyond those that the study asks for, which are there because an adaptive one has added them."""
    found = []
    for ensemble in study.all_ensembles:
        repeat = study.repeats
        while folder.path(point := ensemble.point(repeat)).is_dir():
            found.append(point)
            repeat += 1
    return found
