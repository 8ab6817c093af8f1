"""Running a study from Python, on any executor."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from tether.errors import InputError, RunError
from tether.study.executors import Crew, OpenCrew, processes, processors
from tether.study.folder import StudyFolder
from tether.study.results import Results, results_of
from tether.study.schedule import Schedule
from tether.study.study import Study


def run_study(
    study: Study,
    folder: str | Path,
    executor: Executor | None = None,
    *,
    workers: int | None = None,
    threads: int = 1,
) -> Results:
    """Do the runs of a study that are not done yet, write its results into the folder and return them.

    executor: anything with the interface of concurrent.futures (a Dask client's `get_executor(pure=False)`, mpi4py's
    MPIPoolExecutor, a process pool of your own), whose workers see the folder under the same path; processes on this
    machine if not given. workers: how many runs it does at a time. threads: of each run.

    Like everything that starts processes, call it below `if __name__ == "__main__":`. Raises InputError for a folder
    that cannot be used, RunError when runs have failed (the results of the others are written then), and
    KeyboardInterrupt after Ctrl-C, with every run at a checkpoint.
    """
    study.check()
    schedule = Schedule(study, StudyFolder.create(Path(folder), study), threads)
    size = workers or max(1, processors() // threads)
    open_crew: OpenCrew = partial(processes, size) if executor is None else partial(_lent, executor, size)
    schedule.run(open_crew)
    results = results_of(study, schedule.folder)
    if len(results.runs):
        results.write(schedule.folder.folder)
    if error := failure(schedule):
        raise error
    if not len(results.runs):
        raise InputError(f"no run in {folder} is done", "there are no results", "run it again")
    return results


@contextmanager
def _lent(executor: Executor, workers: int) -> Iterator[Crew]:
    """An executor that is somebody else's to close."""
    yield Crew(executor, workers)


def failure(schedule: Schedule) -> RunError | None:
    """What is to be said of the runs that failed, if there are any."""
    if not schedule.failures:
        return None
    first = next(point for point in schedule.points if point.identity in schedule.failures)
    return RunError(
        f"{len(schedule.failures)} of {len(schedule.points)} runs failed; the first one: {first.label}: "
        f"{schedule.failures[first.identity]}"
    )
