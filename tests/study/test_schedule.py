"""Which runs of a study are begun, in which order, and what becomes of those that fail."""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import threading
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from pathlib import Path

import pytest
from small_studies import LONG, InThisThread, assert_same_study, crew_of, study

from tether.errors import RunError
from tether.files.lock import locked
from tether.study import results_of, run_study
from tether.study.executors import processes
from tether.study.folder import Progress, StudyFolder
from tether.study.schedule import Schedule


def schedule_of(tmp_path: Path, text: str, until: float | None = None) -> Schedule:
    asked = study(tmp_path, text)
    return Schedule(asked, StudyFolder.create(tmp_path / "study", asked), 1, until)


def done(schedule: Schedule) -> dict[str, int]:
    """How many runs of each setting are done, and that these are its first ones."""
    found = {}
    for ensemble in schedule.study.all_ensembles:
        repeats = [point.repeat for point in schedule.repeats_of(ensemble) if point.identity in schedule.summaries]
        assert repeats == list(range(len(repeats)))
        found[ensemble.label] = len(repeats)
    return found


# The order


def test_the_longest_runs_are_begun_first(tmp_path) -> None:
    text = (
        'base = "couette.toml"\nrepeats = 2\n[sweep]\nrun.steps = [20, 400, 100]\nbox.size = [[4.0, 4.0], [5.0, 5.0]]'
    )
    schedule, executor = schedule_of(tmp_path, text), InThisThread()
    schedule.run(crew_of(executor))
    begun = [(task.configuration.box.volume, task.configuration.run.steps) for task in executor.tasks]
    # A particle has about six neighbors in both boxes, so that volume times steps is what a run costs.
    costs = [volume * (steps + 40) for volume, steps in begun]
    assert len(costs) == 12
    assert costs == sorted(costs, reverse=True)


def test_what_is_done_is_not_done_again_and_more_repeats_are_added_to_it(tmp_path) -> None:
    text = 'base = "couette.toml"\nrepeats = 2\n[sweep]\nflow.shear_rate = [0.5, 1.0]\n'
    schedule_of(tmp_path, text).run(crew_of(InThisThread()))
    times = {path: path.stat().st_mtime_ns for path in (tmp_path / "study" / "points").glob("*/summary.json")}
    assert len(times) == 4
    more = text.replace("repeats = 2", "repeats = 3").replace("1.0]", "1.0, 2.0]")
    schedule, executor = schedule_of(tmp_path, more), InThisThread()
    schedule.run(crew_of(executor))
    assert len(executor.tasks) == 9 - 4
    assert {path: path.stat().st_mtime_ns for path in times} == times
    assert set(done(schedule).values()) == {3}


# stop_when

# Without errors of their own, which runs as short as these have not, it takes three repeats to know the pressure's.
GOAL = 0.008
UNTIL = f"""\
base = "couette.toml"
repeats = 8
stop_when = {{pressure = {GOAL}}}

[sweep]
run.steps = [50, 400]
"""


def test_repeats_are_begun_one_after_the_other_until_the_mean_is_known_well_enough(tmp_path) -> None:
    schedule = schedule_of(tmp_path, UNTIL)
    schedule.run(crew_of(InThisThread()))
    counts = done(schedule)
    assert len(set(counts.values())) > 1, "the settings differ in how many they need"
    for ensemble in schedule.study.ensembles:
        number, repeats = counts[ensemble.label], schedule.repeats_of(ensemble)
        errors = [schedule.relative_error(repeats[:few], "pressure") for few in range(2, number + 1)]
        assert all(error > GOAL for error in errors[:-1])
        assert errors[-1] <= GOAL or number == 8
    assert not schedule.needed()


def test_the_same_repeats_are_done_with_interruptions_and_on_several_workers(tmp_path) -> None:
    at_once = schedule_of(tmp_path / "once", UNTIL)
    at_once.run(crew_of(InThisThread()))

    def interrupt(_: Schedule) -> None:
        raise KeyboardInterrupt

    interruptions = 0
    for _ in range(10):
        schedule = schedule_of(tmp_path / "often", UNTIL)
        try:
            schedule.run(crew_of(InThisThread()), interrupt if interruptions < 2 else None)
        except KeyboardInterrupt:
            interruptions += 1
        else:
            break
    assert interruptions == 2
    with ThreadPoolExecutor(3) as threads:
        together = schedule_of(tmp_path / "threads", UNTIL)
        together.run(crew_of(threads, 3))
    for other in (schedule, together):
        assert done(other) == done(at_once)
        results_of(other.study, other.folder).write(other.folder.folder)
    results_of(at_once.study, at_once.folder).write(at_once.folder.folder)
    assert_same_study(schedule.folder.folder, at_once.folder.folder)
    assert_same_study(together.folder.folder, at_once.folder.folder)


# Failures

# A force of 400 throws particles out within a hundred steps of 0.05; bodies in such a number find no place.
RUNAWAY = """\
base = "couette.toml"

[set]
bodies = []
fluid.repulsion = 400.0

[sweep]
run.timestep = [0.001, 0.05]
"""


def test_a_run_that_fails_is_noted_and_the_others_go_on(tmp_path) -> None:
    asked = study(tmp_path, RUNAWAY)
    with pytest.raises(RunError, match=r"1 of 2 runs failed.*timestep = 0\.05, repeat 0: .* ran away at step .*; try"):
        run_study(asked, tmp_path / "study", InThisThread())
    assert (tmp_path / "study" / "results.csv").read_text().count("\n") == 2
    failed = StudyFolder(tmp_path / "study").states(asked.points)[asked.points[1].identity]
    assert failed.kind == "failed"
    assert failed.progress is not None
    assert "ran away" in failed.progress.failure
    schedule, executor = Schedule(asked, StudyFolder(tmp_path / "study"), 1), InThisThread()
    schedule.run(crew_of(executor))
    assert len(executor.tasks) == 1, "it is tried again"
    assert list(schedule.failures) == [asked.points[1].identity]


def test_a_run_that_failed_before_it_had_a_folder_is_done_once_it_can_be(tmp_path, monkeypatch) -> None:
    """A disk that is full when the run's folder is to be made, and is not full later."""

    def refuse(*_):
        raise OSError(28, "No space left on device")

    asked = study(tmp_path, 'base = "couette.toml"\n')
    with monkeypatch.context() as full:
        full.setattr("tether.record.Record._write_configuration", refuse)
        with pytest.raises(RunError, match=r"1 of 1 runs failed.*cannot be written \(no space left on device\)"):
            run_study(asked, tmp_path / "study", InThisThread())
    assert StudyFolder(tmp_path / "study").state(asked.points[0]).kind == "failed"
    assert len(run_study(asked, tmp_path / "study", InThisThread()).runs) == 1


def test_with_a_target_no_more_repeats_of_what_fails_are_begun(tmp_path) -> None:
    text = 'base = "couette.toml"\nrepeats = 5\nstop_when = {pressure = 1e-6}\n[sweep]\nbodies.0.count = [3, 5000]\n'
    schedule = schedule_of(tmp_path, text)
    schedule.run(crew_of(InThisThread()))
    assert list(done(schedule).values()) == [5, 0]
    assert len(schedule.failures) == 2, "the first two, which are begun together"
    assert all("cannot be placed" in failure for failure in schedule.failures.values())


class LosingWorkers(InThisThread):
    """Loses the worker of one run, as Dask tells it, the first so many times."""

    def __init__(self, seed: int, times: int) -> None:
        super().__init__()
        self.seed, self.times, self.lost = seed, times, 0

    def submit(self, function, /, task):
        if task.configuration.seed != self.seed or self.lost == self.times:
            return super().submit(function, task)
        self.lost += 1
        future = Future()
        future.set_exception(RuntimeError("the worker has died\nand more lines"))
        return future


@pytest.mark.parametrize("times", [2, 3])
def test_a_run_whose_worker_dies_is_tried_three_times(tmp_path, times: int) -> None:
    asked = study(tmp_path, 'base = "couette.toml"\nrepeats = 3\n')
    executor = LosingWorkers(asked.points[1].configuration.seed, times)
    if times < 3:
        assert len(run_study(asked, tmp_path / "study", executor).runs) == 3
        return
    with pytest.raises(RunError) as raised:
        run_study(asked, tmp_path / "study", executor)
    assert str(raised.value) == (
        "1 of 3 runs failed; the first one: the base as it is, repeat 1: its worker died each time (RuntimeError: the "
        "worker has died); look whether the machine runs out of memory, then start the study again"
    )
    assert executor.lost == 3
    assert (tmp_path / "study" / "results.csv").read_text().count("\n") == 3


class Broken(Executor):
    """A pool of processes that end as soon as they have begun."""

    def submit(self, *_):
        raise BrokenProcessPool("ended abruptly")


def test_workers_that_never_come_up_are_given_up_with_a_sentence(tmp_path) -> None:
    asked = study(tmp_path, 'base = "couette.toml"\n')
    with pytest.raises(RunError, match=r"10 crews of workers have broken down.*no run was done \(.*; look at"):
        run_study(asked, tmp_path / "study", Broken())


def test_a_worker_that_is_killed_costs_nothing_but_time(tmp_path, uninterrupted: Path) -> None:
    """SIGKILL in the middle of a run, as for want of memory."""
    asked = study(tmp_path, LONG)
    schedule = Schedule(asked, StudyFolder.create(tmp_path / "study", asked), 1)
    killed = []

    def kill_one(schedule: Schedule) -> None:
        if not killed and any(schedule.states[name].kind == "running" for name in schedule.running):
            time.sleep(0.2)
            killed.append(multiprocessing.active_children()[0].pid)
            os.kill(killed[0], signal.SIGKILL)

    schedule.run(partial(processes, 2), kill_one)
    assert killed
    assert not schedule.failures
    assert not multiprocessing.active_children()
    results_of(asked, schedule.folder).write(schedule.folder.folder)
    assert_same_study(schedule.folder.folder, uninterrupted)


@pytest.mark.parametrize("gets_on", [True, False])
def test_a_run_that_another_worker_is_at_is_waited_for_while_it_gets_on(
    tmp_path, monkeypatch: pytest.MonkeyPatch, gets_on: bool
) -> None:
    """As after a study on a cluster was killed, whose workers have not noticed yet."""
    monkeypatch.setattr("tether.study.work._PATIENCE", 0.5)
    asked = study(tmp_path, 'base = "couette.toml"\n')
    folder = StudyFolder.create(tmp_path / "study", asked).path(asked.points[0])
    folder.mkdir()
    is_held, is_over = threading.Event(), threading.Event()

    def other() -> None:
        with locked(folder):
            is_held.set()
            for step in range(12 if gets_on else 0):
                Progress(step, 240, 1.0).write(folder)
                is_over.wait(0.1)
            is_over.wait(0.0 if gets_on else 60.0)

    thread = threading.Thread(target=other)
    thread.start()
    is_held.wait()
    try:
        if gets_on:
            assert len(run_study(asked, tmp_path / "study", InThisThread()).runs) == 1
            return
        with pytest.raises(RunError, match=r"1 of 1 runs failed.*is in use \(another tether is running in it\); wait"):
            run_study(asked, tmp_path / "study", InThisThread())
    finally:
        is_over.set()
        thread.join()


# Adaptive

ADAPTIVE = """\
base = "couette.toml"
repeats = 3

[sweep]
run.steps = [100, 800]
"""


def test_repeats_are_added_where_the_error_is_worst(tmp_path) -> None:
    schedule = schedule_of(tmp_path, ADAPTIVE, until=time.monotonic() + 3600.0)
    short, long = schedule.study.ensembles
    assert schedule.worst() is None, "before a run is done nobody knows how long one takes"
    Schedule(schedule.study, schedule.folder, 1).run(crew_of(InThisThread()))
    schedule = Schedule(schedule.study, schedule.folder, 1, until=schedule.until)
    of_short, of_long = (schedule.relative_error(schedule.repeats_of(each), "viscosity") for each in (short, long))
    assert math.isfinite(of_short)
    assert of_short > of_long
    assert (added := schedule.worst()) is not None
    assert (added.ensemble, added.repeat) == (short, 3)


@pytest.mark.parametrize("kind", ["this thread", "processes"])
def test_an_adaptive_study_adds_repeats_until_its_time_is_over(tmp_path, kind: str) -> None:
    """The short runs scatter most, and get most of the repeats."""
    schedule = schedule_of(tmp_path, ADAPTIVE, until=time.monotonic() + 3600.0)
    late = set()

    def watch(schedule: Schedule) -> None:
        if len(schedule.points) >= 9:
            schedule.until = time.monotonic()
            late.add(len(schedule.points))

    schedule.run(crew_of(InThisThread()) if kind == "this thread" else partial(processes, 2), watch)
    assert len(late) == 1, "nothing is begun when the time is over"
    short, long = (len(schedule.repeats_of(ensemble)) for ensemble in schedule.study.ensembles)
    assert short > long >= 3
    assert set(done(schedule).values()) == {short, long}, "whatever was begun was done"
    assert not schedule.failures
    found = results_of(schedule.study, schedule.folder)
    assert list(found.means["repeats"]) == [short, long]
    assert found.dataset.sizes["repeat"] == max(short, long)
    again, executor = Schedule(schedule.study, schedule.folder, 1), InThisThread()
    again.run(crew_of(executor))
    assert not executor.tasks, "nothing is left to be done"
    assert len(again.points) == short + long


def test_an_adaptive_study_begins_nothing_that_does_not_fit_into_its_time(tmp_path) -> None:
    schedule = schedule_of(tmp_path, ADAPTIVE, until=time.monotonic())
    schedule.run(crew_of(InThisThread()))
    assert list(done(schedule).values()) == [3, 3], "what was asked for is done all the same"
    assert schedule.worst() is None


def test_an_adaptive_study_with_a_target_ends_when_it_is_reached(tmp_path) -> None:
    text = ADAPTIVE.replace("repeats = 3", "repeats = 3\nstop_when = {pressure = 0.004}")
    began = time.monotonic()
    schedule = schedule_of(tmp_path, text, until=began + 3600.0)
    schedule.run(crew_of(InThisThread()))
    for ensemble in schedule.study.ensembles:
        repeats = schedule.repeats_of(ensemble)
        assert schedule.relative_error(repeats, "pressure") <= 0.004
        assert len(repeats) <= 3 or schedule.relative_error(repeats[:-1], "pressure") > 0.004
    assert len(schedule.points) > 6
