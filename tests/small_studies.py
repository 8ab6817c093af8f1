"""Studies of a few runs of a few dozen particles, and a way to do them in the process that asks."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from pathlib import Path

from small_runs import write_couette

from tether.study import Study
from tether.study.executors import Crew

# Crossed, repeated, and compared with the plain fluid: 18 runs.
STUDY = """\
base = "couette.toml"
repeats = 3
relative = true

[sweep]
flow.shear_rate = [0.5, 1.0]
bodies.0.count = [2, 3]
"""

# Four runs of 10000 steps each, a second or so each: long enough to be stopped on the way.
LONG = """\
base = "couette.toml"
repeats = 2

[set]
run.steps = 10000
output.checkpoint = {seconds = 0.05}

[sweep]
flow.shear_rate = [0.5, 1.0]
"""


def write_study(folder: Path, text: str = STUDY, name: str = "study.toml") -> Path:
    """Write a study, and couette.toml beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    write_couette(folder)
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def study(folder: Path, text: str = STUDY) -> Study:
    """A study of small runs."""
    return Study.read(write_study(folder, text))


class InThisThread(Executor):
    """Does what it is given at once, in the thread that gives it, and keeps a list of it."""

    def __init__(self) -> None:
        self.tasks = []

    def submit(self, function, /, *arguments):
        future = Future()
        self.tasks += arguments
        try:
            future.set_result(function(*arguments))
        except Exception as error:
            future.set_exception(error)
        return future


def crew_of(executor, size=1):
    """What opens a crew that is already there."""

    @contextmanager
    def open_crew():
        yield Crew(executor, size)

    return open_crew


# A study in processes of its own


class RunningStudy:
    """`python -m tether study ...`, the first of a group of processes of its own, as a terminal would start it."""

    def __init__(self, log: Path, *arguments: object, launcher: tuple[str, ...] = (), mpi: bool = False) -> None:
        self._log, self._began = log, time.monotonic()
        mpi4py = ("-m", "mpi4py.futures") if mpi else ()
        with log.open("w") as file:
            self._process = subprocess.Popen(
                [*launcher, sys.executable, *mpi4py, "-m", "tether", "study", *map(str, arguments)],
                stdout=file,
                stderr=file,
                start_new_session=True,
            )

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def age(self) -> float:
        """Seconds since it was started: how fast the machine is, once it is known how far the study has come."""
        return time.monotonic() - self._began

    def wait_for(self, condition: Callable[[], bool], seconds: float = 300.0) -> None:
        """Wait until something has come about while the study goes on."""
        end = time.monotonic() + seconds
        while not condition():
            assert self._process.poll() is None, f"ended too early: {self.text}"
            assert time.monotonic() < end, f"waited in vain: {self.text}"
            time.sleep(0.01)

    def send(self, number: int, *, to_all: bool = False) -> None:
        """Send a signal to the main process, or to all, as Ctrl-C does."""
        (os.killpg if to_all else os.kill)(self.pid, number)

    def end(self, seconds: float = 300.0) -> int:
        """Wait for the end, and that nobody is left behind; the exit code."""
        code = self._process.wait(seconds)
        until = time.monotonic() + 60.0
        while left := self.processes():
            assert time.monotonic() < until, f"left behind: {left}"
            time.sleep(0.05)
        return code

    def processes(self) -> list[int]:
        """All that still go on in its session."""
        everyone = (int(path.name) for path in Path("/proc").iterdir() if path.name.isdecimal())
        return [pid for pid in everyone if _session(pid) == self.pid]

    @property
    def text(self) -> str:
        """All that was printed."""
        return self._log.read_text(encoding="utf-8")

    def clean(self) -> None:
        """Leave nothing behind when a test fails."""
        if self.processes():
            os.killpg(self.pid, signal.SIGKILL)
            self._process.wait(10.0)


def _session(pid: int) -> int | None:
    """The session of a process that has not ended; None if it has."""
    try:
        state, _, _, session = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[:4]
    except OSError:
        return None
    return int(session) if state != "Z" else None


# Comparison

TABLES = ("results.csv", "results.parquet", "means.csv", "means.parquet", "results.nc")


def assert_same_study(folder: Path, other: Path) -> None:
    """Equal in every byte of what came out."""
    for name in TABLES:
        assert (folder / name).read_bytes() == (other / name).read_bytes(), name


def copy_of(folder: Path, to: Path) -> Path:
    """A copy of a study to spoil."""
    return Path(shutil.copytree(folder, to))
