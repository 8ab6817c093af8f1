"""A flow curve that is interrupted in every way there is, and comes out as if it had not been."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

Record = Callable[..., None]

STUDY = Path(__file__).parents[1] / "examples" / "studies" / "flow-curve.toml"
"""5 shear rates x 4 volume fractions x 2 repeats in 2D, and as often the plain fluid: 50 runs."""

BIN = Path(sys.executable).parent


def _run(*command: str | Path, **options: object) -> None:
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL, **options)  # type: ignore[call-overload]


def _digest(folder: Path) -> str:
    """All that the study has found: every number of every run, and the SHA-256 of its last state."""
    return (folder / "results.csv").read_text(encoding="utf-8") + (folder / "means.csv").read_text(encoding="utf-8")


def _finished(folder: Path) -> int:
    return len(list(folder.glob("points/*/summary.json")))


@pytest.fixture(scope="module")
def in_one_go(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("studies") / "in one go"
    _run(BIN / "tether", "study", STUDY, "--out", folder)
    assert _finished(folder) == 50
    return folder


def _workers_of(pid: int) -> Iterator[int]:
    """Child processes of all threads, and theirs."""
    for children in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in map(int, children.read_text(encoding="ascii").split()):
            yield child
            yield from _workers_of(child)


def test_killed_twice(in_one_go: Path, tmp_path: Path, record: Record) -> None:
    folder, chance = tmp_path / "killed", random.Random(5)
    done = []
    for enough in (8, 30):
        process = subprocess.Popen([BIN / "tether", "study", STUDY, "--out", folder], stdout=subprocess.DEVNULL)
        while _finished(folder) < enough:
            time.sleep(0.1)
        time.sleep(chance.uniform(0.0, 1.5))
        process.send_signal(signal.SIGKILL)
        process.wait()
        done.append(_finished(folder))
    _run(BIN / "tether", "study", STUDY, "--out", folder)
    record("study_killed_twice", runs=50, done_when_killed=done, identical=_digest(folder) == _digest(in_one_go))
    assert all(0 < number < 50 for number in done)
    assert _digest(folder) == _digest(in_one_go)


def test_on_dask_with_a_worker_killed(in_one_go: Path, tmp_path: Path, record: Record) -> None:
    folder = tmp_path / "dask"
    command = [BIN / "tether", "study", STUDY, "--out", folder, "--dask", "local", "--workers", "2"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        while _finished(folder) < 5:
            time.sleep(0.5)
        busy = max(_workers_of(process.pid), key=_spent)
        os.kill(busy, signal.SIGKILL)
        done = _finished(folder)
    assert process.returncode == 0
    record("study_on_dask", runs=50, done_when_killed=done, identical=_digest(folder) == _digest(in_one_go))
    assert _digest(folder) == _digest(in_one_go)


def _spent(pid: int) -> int:
    """Processor time of a process, in ticks."""
    return sum(map(int, Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[11:13]))


def test_on_mpi(in_one_go: Path, tmp_path: Path, record: Record) -> None:
    folder = tmp_path / "mpi"
    _run(
        BIN / "mpiexec", "-n", "2", sys.executable, "-m", "mpi4py.futures", "-m", "tether", "study", STUDY,
        "--out", folder,
    )  # fmt: skip
    record("study_on_mpi", runs=50, ranks=2, identical=_digest(folder) == _digest(in_one_go))
    assert _digest(folder) == _digest(in_one_go)
