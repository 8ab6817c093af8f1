"""What a study costs beside its runs, and how busy it keeps the processors."""

from __future__ import annotations

import resource
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

from tether.study import Study, results_of
from tether.study.executors import processes, processors
from tether.study.folder import StudyFolder
from tether.study.schedule import Schedule

SQUARES = {
    "box": {"size": [10.0, 10.0]},
    "fluid": {"temperature": 1.0},
    "bodies": [{"shape": "square", "volume_fraction": 0.2}],
    "flow": {"kind": "couette", "shear_rate": 0.2},
    "run": {"timestep": 0.01, "equilibration": 500, "steps": 20000},
}
"""The paper's box in 2D, phi = 0.2."""

RATES = {"logspace": [0.05, 0.8, 20]}


def studies() -> dict[str, Any]:
    """Print and return both figures."""
    found = {**bookkeeping(), **utilisation()}
    print(
        f"1000 finished points: {found['seconds_of_1000_points']:.2f} s to plan them, see that they are done, gather "
        f"and write results; while they ran, the main process took {found['main_process_seconds']:.2f} s of a processor"
    )
    print(
        f"64 runs of {found['seconds_of_a_run']:.2f} s on {found['workers']} processors: {found['seconds']:.1f} s, "
        f"{found['busy']:.1%} of it busy, {found['in_runs']:.1%} in steps of runs"
    )
    return found


def bookkeeping() -> dict[str, Any]:
    """Of 1000 runs that are as short as can be: all that is no run."""
    tiny = {
        **SQUARES,
        "box": {"size": [3.0, 3.0]},
        "bodies": [{"shape": "square", "count": 1}],
        "run": {"timestep": 0.005, "steps": 10},
    }
    sweep = {"flow.shear_rate": RATES, "bodies.0.count": [1, 2], "fluid.temperature": [0.25, 0.5, 0.75, 1.0, 1.25]}
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_SELF)
        _run(tiny, sweep, 5, Path(folder), processors())
        after = resource.getrusage(resource.RUSAGE_SELF)
        began = time.perf_counter()
        _run(tiny, sweep, 5, Path(folder), processors())
        again = time.perf_counter() - began
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"seconds_of_1000_points": again, "main_process_seconds": spent}


def utilisation() -> dict[str, Any]:
    """Of 64 short runs in 2D: processor time of the workers and their children over what there was."""
    workers = processors()
    sweep = {"flow.shear_rate": {"logspace": [0.05, 0.8, 4]}, "bodies.0.volume_fraction": [0.05, 0.1, 0.2, 0.3]}
    with tempfile.TemporaryDirectory() as folder:
        before = _spent()
        began = time.perf_counter()
        schedule = _run(SQUARES, sweep, 4, Path(folder), workers)
        seconds = time.perf_counter() - began
        busy = _spent() - before
    steps = sum(each["performance"]["seconds"] for each in schedule.summaries.values())
    return {
        "workers": workers,
        "seconds": seconds,
        "seconds_of_a_run": steps / len(schedule.summaries),
        "busy": busy / (workers * seconds),
        "in_runs": steps / (workers * seconds),
    }


def _run(base: dict[str, Any], sweep: dict[str, Any], repeats: int, folder: Path, workers: int) -> Schedule:
    """All that `tether study` does but print."""
    study = Study(base=base, sweep=sweep, repeats=repeats)
    study.check()
    schedule = Schedule(study, StudyFolder.create(folder, study), 1)
    schedule.run(partial(processes, workers))
    results_of(study, schedule.folder).write(folder)
    return schedule


def _spent() -> float:
    """Processor time of this process and of its workers, which have ended, seconds."""
    return sum(
        usage.ru_utime + usage.ru_stime
        for usage in (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    )
