"""What is shown in a terminal while a run goes."""

from __future__ import annotations

import os
import pty
import re
import sys
import threading
from pathlib import Path

import pytest
from small_runs import tether, write_couette

from tether.cli import main
from tether.cli import progress as shown


def run_in_terminal(arguments: list[str], monkeypatch: pytest.MonkeyPatch) -> str:
    """All that a terminal of 120 columns gets from a run."""
    master, slave = pty.openpty()
    got: list[bytes] = []

    def listen() -> None:
        while True:
            try:
                read = os.read(master, 65536)
            except OSError:  # the other side is closed
                return
            if not read:
                return
            got.append(read)

    listener = threading.Thread(target=listen)
    listener.start()
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setenv("TERM", "xterm")
    with os.fdopen(slave, "w") as terminal:
        monkeypatch.setattr(sys, "argv", ["tether", *arguments])
        monkeypatch.setattr(sys, "stderr", terminal)
        monkeypatch.setattr(sys, "stdout", terminal)
        with pytest.raises(SystemExit) as end:
            main()
        monkeypatch.undo()
    assert end.value.code == 0
    listener.join(10)
    os.close(master)
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", b"".join(got).decode())


def test_a_terminal_shows_rate_time_left_and_running_means(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The bar is drawn ten times a second: both phases take several tenths on a fast machine."""
    monkeypatch.setattr(shown, "_SECONDS_BETWEEN_MEANS", 0.02)
    config = write_couette(tmp_path)
    options = ["--set", "run.equilibration=60000", "--set", "run.steps=60000"]
    text = run_in_terminal(["run", str(config), "--out", str(tmp_path / "out"), *options], monkeypatch)
    assert re.search(r"equilibrating .* \d+% .* \d+\.\d\d M particle-steps/s +kT \d\.\d+", text)
    assert re.search(r"measuring .* \d+% \d+:\d\d \d+\.\d\d M particle-steps/s +eta [\d.]+ .*kT \d\.\d+", text)
    assert "eta_r" not in text
    assert "Results: " in text


def test_a_terminal_shows_a_run_whose_first_sample_is_far(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shown, "_SECONDS_BETWEEN_MEANS", 0.01)
    config = write_couette(tmp_path, [("equilibration = 40", "equilibration = 0")])
    options = ["--set", "run.steps=60000", "--set", "output.series=60000"]
    text = run_in_terminal(["run", str(config), "--out", str(tmp_path / "out"), *options], monkeypatch)
    assert re.search(r"measuring .* M particle-steps/s +kT \d\.\d+", text)
    assert "Results: " in text


def test_a_quiet_run_in_a_terminal_shows_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    config = write_couette(tmp_path)
    assert run_in_terminal(["run", str(config), "--out", str(tmp_path / "out"), "--quiet"], monkeypatch) == ""


def test_without_a_terminal_there_is_no_bar(tmp_path: Path) -> None:
    outcome = tether("run", write_couette(tmp_path), "--out", tmp_path / "out")
    assert outcome.err == ""
    assert "particle-steps/s +" not in outcome.out
    assert "\x1b" not in outcome.out


def test_without_a_terminal_a_line_now_and_then(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tether.cli.progress._SECONDS_BETWEEN_LINES", 0.0)
    outcome = tether("run", write_couette(tmp_path), "--out", tmp_path / "out")
    lines = outcome.err.splitlines()
    assert lines[0].startswith("equilibrating, ")
    assert lines[-1].startswith("measuring, ")
    assert re.search(r"M particle-steps/s  eta .*  kT ", lines[-1])
