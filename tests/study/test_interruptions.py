"""Studies that are killed, stopped or crowded out, and go on to the same results; nobody is left behind."""

from __future__ import annotations

import random
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import h5py
import pytest
from small_runs import assert_one_sentence, tether
from small_studies import LONG, RunningStudy, assert_same_study, write_study

from tether.study.folder import StudyFolder


@pytest.fixture
def running() -> Iterator[list[RunningStudy]]:
    """Studies to end with the test, however that ends."""
    studies: list[RunningStudy] = []
    yield studies
    for each in studies:
        each.clean()


def checkpoints(folder: Path) -> dict[str, int]:
    """The steps of all runs that have a checkpoint and have not ended."""
    found = {}
    for path in (folder / "points").glob("*/checkpoint.h5"):
        if not (path.parent / "summary.json").exists():
            with h5py.File(path) as file:
                found[path.parent.name] = int(file.attrs["step"])
    return found


def progress(folder: Path) -> int:
    """How much there is of a study: it grows while the study goes on."""
    ended = len(list((folder / "points").glob("*/summary.json")))
    return ended + len(list((folder / "points").glob("*/checkpoint.h5")))


def test_killed_twice_a_study_ends_with_the_same_results_and_no_orphans(
    tmp_path: Path, uninterrupted: Path, running: list[RunningStudy]
) -> None:
    """SIGKILL of the main process alone, at any moment; its workers are to end by themselves."""
    draw = random.Random(1)
    path, out = write_study(tmp_path, LONG), tmp_path / "study"
    for kill in range(2):
        study = RunningStudy(tmp_path / "log", path, "--out", out, "--workers", 2, "--quiet")
        running.append(study)
        study.wait_for(lambda seen=kill: progress(out) > seen)
        time.sleep(draw.uniform(0.0, 0.7))
        study.send(signal.SIGKILL)
        assert study.end() == -signal.SIGKILL
        assert progress(out) < 8, "it had not ended"
    study = RunningStudy(tmp_path / "log", path, "--out", out, "--workers", 2, "--quiet")
    running.append(study)
    assert study.end() == 0, study.text
    assert_same_study(out, uninterrupted)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stopped_study_has_checkpoints(tmp_path: Path, running: list[RunningStudy], number: int) -> None:
    """Ctrl-C reaches all processes of a terminal; SIGTERM, as batch systems send it, the first one."""
    path, out = write_study(tmp_path, LONG), tmp_path / "study"
    slow = ["--set", "run.steps=1000000", "--set", "output.checkpoint={seconds = 1000.0}"]
    study = RunningStudy(tmp_path / "log", path, "--out", out, "--workers", 2, "--quiet", *slow)
    running.append(study)
    study.wait_for(lambda: progress(out) == 2)
    start = study.age
    if number == signal.SIGTERM:
        look_at(out)
    began = time.monotonic()
    study.send(number, to_all=number == signal.SIGINT)
    assert study.end() == 130
    assert time.monotonic() - began < 5.0 + 3.0 * start, "two seconds, on a machine with nothing else to do"
    assert study.text == f"stopped; the same command goes on with it (or: tether study {out})\n"
    steps = checkpoints(out)
    assert len(steps) == 2
    assert all(step > 0 for step in steps.values())
    assert "2 interrupted, 2 waiting" in tether("study", "status", out).out


def look_at(out: Path) -> None:
    """What others can do with a study that is under way."""
    status = tether("study", "status", out)
    assert status.code == 0
    assert "0 done, 2 running, 2 waiting" in status.out
    assert_one_sentence(tether("study", out), 2, f"{out} is in use", "another tether is running in it")
    asked = (out / "study.toml").read_text()
    other = write_study(out.parent / "other", 'base = "couette.toml"\n')
    assert_one_sentence(tether("study", other, "--out", out), 2, f"{out} is in use")
    assert (out / "study.toml").read_text() == asked, "the study that goes on is left as it is"
    assert_one_sentence(tether("study", "collect", out), 2, f"no run in {out} is done", "run the study first")
    assert_one_sentence(tether("study", "plot", out), 2, "nothing to draw")


def test_ctrl_c_is_one_sentence_while_the_workers_start(tmp_path: Path, running: list[RunningStudy]) -> None:
    """They are importing then, and must not take the signal for themselves."""
    path, out = write_study(tmp_path, LONG), tmp_path / "study"
    study = RunningStudy(tmp_path / "log", path, "--out", out, "--workers", 2, "--quiet")
    running.append(study)
    study.wait_for(lambda: len(study.processes()) == 4)  # the main one, the tracker of semaphores, and both workers
    time.sleep(0.2)
    study.send(signal.SIGINT, to_all=True)
    assert study.end() == 130
    assert study.text == f"stopped; the same command goes on with it (or: tether study {out})\n"


def test_a_second_stop_does_not_wait_for_particles_to_be_placed(tmp_path: Path, running: list[RunningStudy]) -> None:
    """A million gentle steps of fifty thousand particles take an hour or more, and there is nothing to be saved."""
    text = 'base = "couette.toml"\n[set]\nbodies = []\nbox.size = [25.0, 25.0, 20.0]\nstart.gentle_steps = 1000000\n'
    path, out = write_study(tmp_path, text), tmp_path / "study"
    study = RunningStudy(tmp_path / "log", path, "--out", out, "--workers", 1, "--quiet")
    running.append(study)
    study.wait_for(lambda: any((out / "points").glob("*/progress.json")))
    start = study.age
    study.send(signal.SIGTERM)
    time.sleep(0.5)
    assert study.processes()
    began = time.monotonic()
    study.send(signal.SIGTERM)
    assert study.end() == 130
    assert time.monotonic() - began < 5.0 + 3.0 * start, "three seconds, on a machine with nothing else to do"
    assert "Traceback" not in study.text
    found = StudyFolder.open(out)
    assert [state.kind for state in found.states(found.study().points).values()] == ["interrupted"]
