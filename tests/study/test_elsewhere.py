"""The same study on Dask and under MPI: the same results, whoever does the runs and whoever is killed."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from small_runs import assert_one_sentence, tether
from small_studies import LONG, STUDY, RunningStudy, assert_same_study, study, write_study

from tether.study import results_of
from tether.study.executors import Crew, dask
from tether.study.folder import StudyFolder
from tether.study.schedule import Schedule

# Dask leaves sockets and event loops to the garbage collector when one of its processes was killed.
pytestmark = pytest.mark.filterwarnings("ignore:unclosed:ResourceWarning")


def test_a_killed_worker_of_dask_costs_nothing_but_time(tmp_path: Path, uninterrupted: Path) -> None:
    """SIGKILL to a worker process with a run under way. Dask starts another one, and the run goes on there."""
    pytest.importorskip("distributed")
    asked = study(tmp_path, LONG)
    schedule = Schedule(asked, StudyFolder.create(tmp_path / "study", asked), 1)
    killed = []

    @contextmanager
    def remembered() -> Iterator[Crew]:
        with dask("local", 2) as crew:
            remembered.pids = crew.executor._client.run(os.getpid)
            yield crew

    def kill_one(schedule: Schedule) -> None:
        if not killed and any(schedule.states[name].kind == "running" for name in schedule.running):
            time.sleep(0.2)
            killed.append(next(iter(remembered.pids.values())))
            os.kill(killed[0], signal.SIGKILL)

    schedule.run(remembered, kill_one)
    assert killed
    assert not schedule.failures
    results_of(asked, schedule.folder).write(schedule.folder.folder)
    assert_same_study(schedule.folder.folder, uninterrupted)


@pytest.mark.parametrize(
    ("scheduler", "parts"),
    [
        ("tcp://127.0.0.1:1", ["no Dask scheduler answers at tcp://127.0.0.1:1 (", "; start one with: dask scheduler"]),
        ("nonsense", ["no Dask scheduler answers at nonsense ("]),
        ("scheduler.json", ["scheduler.json is no scheduler's file of Dask (it tells no address)"]),
    ],
)
def test_a_scheduler_that_is_not_there_is_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, scheduler: str, parts: list[str]
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("tether.study.executors._SECONDS_TO_CONNECT", 0.5)
    monkeypatch.chdir(tmp_path)
    path = write_study(tmp_path)
    (tmp_path / "scheduler.json").write_text("{}")
    assert_one_sentence(tether("study", path, "--dask", scheduler, "--quiet"), 2, *parts)


def test_without_dask_it_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.chdir(tmp_path)
    outcome = tether("study", write_study(tmp_path), "--dask", "local")
    assert_one_sentence(outcome, 2, "needs the package distributed (it is not installed); pip install 'tether[dask]'")


def mpiexec() -> str:
    """The launcher beside this Python, or on the path."""
    pytest.importorskip("mpi4py")
    found = shutil.which("mpiexec", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    return found or pytest.skip("there is no mpiexec")


def test_under_mpi_a_study_has_the_same_results(tmp_path: Path, finished: Path) -> None:
    launcher = mpiexec()
    path, out = write_study(tmp_path, STUDY), tmp_path / "study"
    running = RunningStudy(tmp_path / "log", path, "--out", out, "--quiet", launcher=(launcher, "-n", "3"), mpi=True)
    try:
        assert running.end() == 0, running.text
    finally:
        running.clean()
    assert_same_study(out, finished)


def test_a_single_process_of_mpi_is_one_sentence(tmp_path: Path) -> None:
    launcher = mpiexec()
    running = RunningStudy(
        tmp_path / "log", write_study(tmp_path), "--quiet", "--out", tmp_path / "out", launcher=(launcher, "-n", "1"),
        mpi=True,
    )  # fmt: skip
    try:
        assert running.end() == 2, running.text
    finally:
        running.clean()
    assert running.text.count("needs at least 2 processes") == 1
    assert "Traceback" not in running.text
