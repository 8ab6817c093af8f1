"""Schedule: which runs of a study are to be done next, and seeing them through."""

from __future__ import annotations

import math
import queue
import time
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future

from tether.errors import RunError
from tether.study.executors import Crew, OpenCrew, lost
from tether.study.folder import State, StudyFolder
from tether.study.ledger import Asked, Ledger
from tether.study.study import Ensemble, Point
from tether.study.work import Outcome, Task, work

_SECONDS_BETWEEN_LOOKS = 0.5
_SECONDS_TO_STOP = 10.0
"""For runs under way to come to a checkpoint. What is still placing its particles has none to lose."""

_MOST_ATTEMPTS = 3
"""At one run whose worker dies under it."""

_MOST_VAIN_CREWS = 10

Watch = Callable[["Schedule"], None]


class Schedule(Ledger):
    """A study on its way."""

    def __init__(self, study: Asked, folder: StudyFolder, threads: int, until: float | None = None) -> None:
        """threads: of each run. until: when an adaptive study begins nothing more, by time.monotonic."""
        super().__init__(study, folder)
        self.running.clear()  # what others have under way, they may have to let go
        self.threads = threads
        self.until = until
        self._attempts: dict[str, int] = {}
        self._under_way: dict[Future[Outcome], Point] = {}
        self._back: queue.SimpleQueue[Future[Outcome]] = queue.SimpleQueue()

    # --- which ---

    def needed(self) -> list[Point]:
        """Runs to be handed out now, the longest first.

        With a target for the mean over repeats, one repeat of a setting after the other: the second with the first, as
        one run is no mean, each further one when those before it are done and have not reached the target.
        """
        waiting = [p for p in self.study.points if self._is_open(p)]
        if self.study.stop_when is not None:
            waiting = [point for point in waiting if self._is_wanted(point)]
        return sorted(waiting, key=lambda point: -point.cost)

    def _is_open(self, point: Point) -> bool:
        name = point.identity
        return name not in self.summaries and name not in self.running and name not in self.failures

    def _is_wanted(self, point: Point) -> bool:
        if point.repeat < 2:
            return True
        before = self.repeats_of(point.ensemble)[: point.repeat]
        if not all(each.identity in self.summaries for each in before):
            return False
        return self._error_over_target(before) > 1.0

    def _error_over_target(self, repeats: Sequence[Point]) -> float:
        """The relative error of the mean over its target, the worst of them where there are several."""
        assert self.study.stop_when is not None
        return max(self.relative_error(repeats, name) / goal for name, goal in self.study.stop_when.targets.items())

    def worst(self) -> Point | None:
        """The run that would improve most where the error is worst, if there is one that fits into the time left.

        The error is that of the viscosity (of the pressure where nothing is sheared steadily), relative to the value,
        or to the targets of the study; with m runs on the way it is taken to be sqrt(n / (n + m)) of what it is now.
        """
        assert self.until is not None
        left = self.until - time.monotonic()
        ranked = sorted(self.study.all_ensembles, key=self._badness, reverse=True)
        for ensemble in ranked:
            if self._badness(ensemble) <= 0.0:
                return None
            point = self._next_repeat(ensemble)
            if self.seconds_of(point, left=True) <= left:
                return point
        return None

    def _badness(self, ensemble: Ensemble) -> float:
        """The error over its target, or relative to its value; 0 where no more is wanted."""
        repeats = self.repeats_of(ensemble)
        if any(point.identity in self.failures for point in repeats):
            return 0.0  # its next repeat would most likely fail as well
        done = sum(1 for point in repeats if point.identity in self.summaries)
        on_the_way = sum(1 for point in repeats if point.identity in self.running)
        to_come = math.sqrt(done / (done + on_the_way)) if done else 1.0 / (1.0 + on_the_way)
        if self.study.stop_when is not None:
            ratio = min(self._error_over_target(repeats), _UNKNOWN) * to_come
            return ratio if ratio > 1.0 else 0.0
        steady = ensemble.configuration.flow.shear_rate != 0
        return min(self.relative_error(repeats, "viscosity" if steady else "pressure"), _UNKNOWN) * to_come

    def _next_repeat(self, ensemble: Ensemble) -> Point:
        repeats = self.repeats_of(ensemble)
        begun = [point for point in repeats if self._is_open(point)]
        return begun[0] if begun else ensemble.point(repeats[-1].repeat + 1)

    # --- doing it ---

    def run(self, open_crew: OpenCrew, watch: Watch | None = None) -> None:
        """Do all that is to be done. Interrupt it at will: what has been done is kept.

        watch: called about twice a second. A run that fails is noted in `failures`, and the others go on. Raises
        KeyboardInterrupt, after all runs under way are at a checkpoint, where one interrupts it.
        """
        with self.folder.held():
            vain, done = 0, len(self.summaries)
            while self._round(open_crew, watch):
                vain = 0 if len(self.summaries) > done else vain + 1
                done = len(self.summaries)
                if vain == _MOST_VAIN_CREWS:
                    raise RunError(
                        f"{vain} crews of workers have broken down one after the other, and no run was done",
                        "their processes end by themselves or are killed", "look at the machine's memory and its log",
                    )  # fmt: skip

    def _round(self, open_crew: OpenCrew, watch: Watch | None) -> bool:
        """With one crew, to the end or until it breaks down; True if there is more to do then."""
        if not self.needed() and self.until is None:
            return False
        with open_crew() as crew:
            self.workers = crew.size
            try:
                self._hand_out(crew)
                while self._under_way:
                    if self._receive_all(watch):
                        self._hand_out(crew)
            except BrokenExecutor:
                self._lose_all()
                return True
            except KeyboardInterrupt:
                self._stop(watch)
                raise
        return False

    def _hand_out(self, crew: Crew) -> None:
        """Give the executor what is to be done now."""
        for point in self.needed():
            self._submit(crew, point)
        while self.until is not None and len(self._under_way) < crew.size and (added := self.worst()) is not None:
            if added.identity not in self.states:
                self.repeats_of(added.ensemble).append(added)
                self.states[added.identity] = State("waiting")
            self._submit(crew, added)

    def _submit(self, crew: Crew, point: Point) -> None:
        path, stop = self.folder.path(point).absolute(), self.folder.stop_path.absolute()
        future = crew.executor.submit(work, Task(str(path), point.configuration, self.threads, str(stop)))
        self._under_way[future] = point
        self.running[point.identity] = point
        future.add_done_callback(self._back.put)

    def _receive_all(self, watch: Watch | None) -> bool:
        """Wait for runs that come back; whether that makes others to be handed out."""
        until = time.monotonic() + _SECONDS_BETWEEN_LOOKS
        wants_more = False
        while self._under_way and (left := until - time.monotonic()) > 0.0:
            try:
                future = self._back.get(timeout=left)
            except queue.Empty:
                break
            if future in self._under_way:  # not of an executor that has broken down
                again = self._receive(self._under_way[future], future)
                del self._under_way[future]
                if again or self.until is not None or self.study.stop_when is not None:
                    wants_more = True
                    break
        self.look()
        if watch is not None:
            watch(self)
        return wants_more

    def _receive(self, point: Point, future: Future[Outcome]) -> bool:
        """Note how a run has ended; whether it is to be tried again."""
        name = point.identity
        try:
            outcome = future.result()
        except BrokenExecutor:
            raise
        except CancelledError:
            outcome = Outcome("stopped")
        except Exception as error:  # whatever an executor makes of a worker that is gone
            del self.running[name]
            return self._attempted(name, error)
        del self.running[name]
        self.states[name] = self.folder.state(point)
        if outcome.kind == "done":
            self._take(point)
        elif outcome.kind == "failed":
            self.failures[name] = outcome.failure
        elif not self.folder.stop_path.exists():
            self.failures[name] = "it was stopped, by nobody here; start the study again"
        return False

    def _attempted(self, name: str, error: Exception) -> bool:
        """Count an attempt whose worker died; whether there may be another one."""
        self._attempts[name] = self._attempts.get(name, 0) + 1
        if self._attempts[name] >= _MOST_ATTEMPTS:
            self.failures[name] = str(lost(error))
        return name not in self.failures

    def _lose_all(self) -> None:
        """A worker has died and taken its crew along: note which runs may have been under way."""
        self.look()
        for point in self._under_way.values():
            name = point.identity
            self.running.pop(name, None)
            if self.states[name].kind == "running":  # not those that still waited for a worker
                self._attempted(name, RunError("a worker process died"))
            self.states[name] = self.folder.state(point)
        self._under_way.clear()

    def _stop(self, watch: Watch | None) -> None:
        """Let the runs under way come to a checkpoint. A second interrupt does not wait for them."""
        self.folder.ask_to_stop()
        for future, point in self._under_way.items():
            if self.states[point.identity].kind != "running":  # Dask would drop what a worker is at
                future.cancel()
        until = time.monotonic() + _SECONDS_TO_STOP
        try:
            while self._under_way and time.monotonic() < until:
                self._receive_all(watch)
        except BrokenExecutor:
            pass  # its workers are gone, perhaps by the same interrupt


_UNKNOWN = 1e9
"""A relative error for what has none yet: worse than any."""
