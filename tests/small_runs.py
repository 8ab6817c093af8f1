"""Runs of a few dozen particles for the tests of files and of the command line, and when two are the same."""

from __future__ import annotations

import io
import json
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

import gsd.hoomd
import numpy as np
import xarray as xr

from tether.cli import main

# 64 particles of solvent and three squares in two dimensions.
COUETTE = """\
seed = 7

[box]
size = [4.0, 4.0]

[fluid]
temperature = 1.0

[[bodies]]
shape = "square"
count = 3

[flow]
kind = "couette"
shear_rate = 0.5

[run]
timestep = 0.005
equilibration = 40
steps = 200
"""


def write_couette(folder: Path, changes: Sequence[tuple[str, str]] = (), name: str = "couette.toml") -> Path:
    """Write the file above with some of its text changed."""
    text = COUETTE
    for old, new in changes:
        assert text.count(old) == 1, f"{old!r} is in the file {text.count(old)} times"
        text = text.replace(old, new)
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@dataclass(frozen=True)
class Outcome:
    """How a command ended."""

    code: int
    out: str
    err: str


def tether(*arguments: object) -> Outcome:
    """Run the command line in this process."""
    out, err = io.StringIO(), io.StringIO()
    code: int | str | None = 0
    with (
        patch.object(sys, "argv", ["tether", *map(str, arguments)]),
        redirect_stdout(out),
        redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as end:
            code = end.code
    assert code is None or isinstance(code, int)
    return Outcome(code or 0, out.getvalue(), err.getvalue())


def names(folder: Path) -> list[str]:
    """What is in a folder."""
    return sorted(path.name for path in folder.iterdir())


# Processes of their own, for signals. They are forked from a server that has imported tether once.

_processes = multiprocessing.get_context("forkserver")
_processes.set_forkserver_preload(["tether.cli"])


class Running:
    """The command line in another process."""

    def __init__(self, log: Path, *arguments: object) -> None:
        self._log = log
        self._process = _processes.Process(target=_in_child, args=(log, [str(each) for each in arguments]))
        self._process.start()

    @property
    def is_alive(self) -> bool:
        return self._process.is_alive()

    def send(self, number: int) -> None:
        """Send a signal, if there is still something to send it to."""
        if self._process.pid is not None and self._process.is_alive():
            os.kill(self._process.pid, number)

    def wait_for(self, condition: Callable[[], bool], seconds: float = 60.0) -> None:
        """Wait until something has come about while the process runs."""
        end = time.monotonic() + seconds
        while not condition():
            assert self.is_alive, f"ended too early: {self._log.read_text()}"
            assert time.monotonic() < end, "waited in vain"
            time.sleep(0.002)

    def end(self, seconds: float = 60.0) -> Outcome:
        """Wait for the end; a negative code is a signal's number, as for subprocesses."""
        self._process.join(seconds)
        assert self._process.exitcode is not None, "the process did not end"
        return Outcome(self._process.exitcode, "", self._log.read_text(encoding="utf-8"))


def _in_child(log: Path, arguments: list[str]) -> None:
    handle = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(handle, 1)
    os.dup2(handle, 2)
    # A shell starts background jobs, these tests perhaps, with SIGINT ignored, and tether leaves an ignored one alone.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.argv = ["tether", *arguments]
    main()


# Comparison


def summary(folder: Path) -> dict[str, Any]:
    """summary.json, read as strictly as JSON is defined."""
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"), parse_constant=_refuse)


def _refuse(constant: str) -> None:
    raise AssertionError(f"{constant} is no JSON")


def frames(folder: Path) -> list[Any]:
    """All frames of the trajectory."""
    with gsd.hoomd.open(str(folder / "trajectory.gsd")) as trajectory:
        return list(trajectory)


def assert_same_run(folder: Path, other: Path) -> None:
    """Equal in every bit: final state, series, means, and frames."""
    mine, theirs = summary(folder), summary(other)
    assert mine["state_sha256"] == theirs["state_sha256"]
    for each in (mine, theirs):
        del each["performance"]
    assert mine == theirs
    with xr.open_dataset(folder / "series.nc") as series, xr.open_dataset(other / "series.nc") as others:
        xr.testing.assert_identical(series.drop_attrs(), others.drop_attrs())
    mine_frames, their_frames = frames(folder), frames(other)
    assert [f.configuration.step for f in mine_frames] == [f.configuration.step for f in their_frames]
    for frame, its in zip(mine_frames, their_frames, strict=True):
        assert np.array_equal(frame.particles.position, its.particles.position)
        assert np.array_equal(frame.particles.velocity, its.particles.velocity)


def assert_one_sentence(outcome: Outcome, code: int, *parts: str) -> None:
    """An error as users should see it: one line on stderr, nothing on stdout, and no traceback."""
    assert outcome.code == code, outcome
    assert outcome.out == ""
    assert outcome.err.startswith("error: "), outcome.err
    assert outcome.err.count("\n") == 1, outcome.err
    assert "Traceback" not in outcome.err
    assert "; " in outcome.err, "a remedy follows the semicolon"
    for part in parts:
        assert part in outcome.err, (part, outcome.err)
