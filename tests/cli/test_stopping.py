"""Runs that are stopped, killed, crowded out or left without room, and go on in the same bits."""

from __future__ import annotations

import random
import resource
import shutil
import signal
import time
from collections.abc import Sequence
from pathlib import Path

import h5py
import pytest
import xarray as xr
from small_runs import Running, assert_one_sentence, assert_same_run, frames, names, summary, tether, write_couette

from tether.record import Record

# Long enough to be stopped on the way: two seconds or so of an idle processor.
EQUILIBRATION, END = 40000, 100000
LONG = ["--set", f"run.equilibration={EQUILIBRATION}", "--set", f"run.steps={END - EQUILIBRATION}"]


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The long run, never stopped."""
    folder = tmp_path_factory.mktemp("uninterrupted")
    assert tether("run", write_couette(folder), "--out", folder / "out", "--quiet", *LONG).code == 0
    return folder / "out"


def checkpointed_step(folder: Path) -> int:
    """The step of the checkpoint in a folder."""
    with h5py.File(folder / "checkpoint.h5") as file:
        return int(file.attrs["step"])


@pytest.mark.parametrize(
    ("number", "code", "phase"),
    [
        (signal.SIGINT, 130, "equilibrating"),
        (signal.SIGTERM, 143, "measuring"),
    ],
)
def test_a_signal_stops_a_run_which_goes_on_in_the_same_bits(
    tmp_path: Path, uninterrupted: Path, number: int, code: int, phase: str
) -> None:
    out = tmp_path / "out"
    options = LONG if phase == "equilibrating" else [*LONG, "--set", "output.checkpoint={seconds = 0.1}"]
    running = Running(tmp_path / "log", "run", write_couette(tmp_path), "--out", out, *options)
    running.wait_for((out / ("checkpoint.h5" if phase == "equilibrating" else "series.nc")).exists)
    began = time.monotonic()
    running.send(number)
    outcome = running.end()
    assert time.monotonic() - began < 3.0, "about a second, on a machine with nothing else to do"
    step = checkpointed_step(out)
    assert (step < EQUILIBRATION) == (phase == "equilibrating")
    assert step < END
    assert (outcome.code, outcome.err) == (code, f"stopped at step {step}; go on with: tether resume {out}\n")
    if phase == "measuring":
        assert tether("plot", out).code == 0
    assert tether("resume", out, "--quiet", "--threads", 2).code == 0
    ended = summary(out)
    assert ended["performance"]["threads"] == 2
    if phase == "equilibrating":
        assert_same_run(out, uninterrupted)
    else:  # the checkpoint's interval is in the configuration that the series carries
        assert ended["state_sha256"] == summary(uninterrupted)["state_sha256"]
        assert_same_run(out, uninterrupted)


def let_write(running: Running, checkpoint: Path, times: int) -> None:
    """Wait until the checkpoint has been written so many times more, or the run has ended."""
    seen: set[int] = set()
    while len(seen) <= times and running.is_alive:
        if checkpoint.exists():
            seen.add(checkpoint.stat().st_mtime_ns)
        time.sleep(0.001)


@pytest.mark.parametrize("seed", range(3))
def test_killed_at_any_moment_a_run_goes_on_in_the_same_bits(tmp_path: Path, run_often: Path, seed: int) -> None:
    """Checkpoints are written all the time here, so that many a kill falls into one. The whole run writes a hundred."""
    draw = random.Random(seed)
    out = tmp_path / "out"
    arguments: Sequence[object] = ("run", write_couette(tmp_path), "--out", out, "--quiet", *OFTEN)
    kills = 0
    for _ in range(8):
        running = Running(tmp_path / "log", *arguments)
        let_write(running, out / "checkpoint.h5", draw.randrange(15))
        time.sleep(draw.uniform(0.0, 0.02))
        running.send(signal.SIGKILL)
        outcome = running.end()
        if outcome.code == 0:
            break
        assert outcome.code == -signal.SIGKILL, outcome.err
        kills += 1
        arguments = ("resume", out, "--quiet")
    assert kills > 0
    outcome = tether("resume", out, "--quiet")
    assert outcome.code == 0, outcome
    assert_same_run(out, run_often)
    assert not [name for name in names(out) if name.endswith((".part", ".damaged"))]


def test_a_start_that_takes_long_is_stopped_at_once_too(tmp_path: Path) -> None:
    """A million gentle steps of fifty thousand particles take an hour or more."""
    out = tmp_path / "out"
    large = ["--set", "box.size=[25.0, 25.0, 20.0]", "--set", "bodies=[]", "--set", "start.gentle_steps=1000000"]
    running = Running(tmp_path / "log", "run", write_couette(tmp_path), "--out", out, *large)
    time.sleep(1.5)
    assert running.is_alive
    assert not out.exists()
    began = time.monotonic()
    running.send(signal.SIGINT)
    outcome = running.end()
    assert time.monotonic() - began < 2.0
    assert outcome.code in (-signal.SIGINT, 130)
    assert "Traceback" not in outcome.err
    assert not out.exists()


OFTEN = [
    *("--set", "output.checkpoint=7", "--set", "output.frames=15", "--set", "output.series=4"),
    *("--set", "run.equilibration=200", "--set", "run.steps=502"),
]


@pytest.fixture(scope="module")
def run_often(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run with many checkpoints, never stopped."""
    folder = tmp_path_factory.mktemp("often")
    assert tether("run", write_couette(folder), "--out", folder / "out", "--quiet", *OFTEN).code == 0
    return folder / "out"


def test_checkpoints_are_written_at_the_steps_that_were_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps = []
    write = Record.write_checkpoint
    monkeypatch.setattr(
        Record,
        "write_checkpoint",
        lambda record, simulation: (steps.append(simulation.step), write(record, simulation)),
    )
    changes = ["--set", "output.checkpoint=50", "--set", "output.frames=33"]
    outcome = tether("run", write_couette(tmp_path), "--out", tmp_path / "out", "--quiet", *changes)
    assert outcome.code == 0
    assert steps == [0, 50, 100, 150, 200, 240]
    assert [frame.configuration.step for frame in frames(tmp_path / "out")] == [0, *range(73, 240, 33), 240]


# Longer runs


@pytest.mark.parametrize("series", [7, 10])
def test_a_longer_run_is_one_long_run(tmp_path: Path, series: int) -> None:
    config = write_couette(tmp_path)
    intervals = ["--quiet", "--set", f"output.series={series}", "--set", "output.frames=40"]
    assert tether("run", config, "--out", tmp_path / "long", *intervals, "--set", "run.steps=320").code == 0
    assert tether("run", config, "--out", tmp_path / "short", *intervals).code == 0
    assert summary(tmp_path / "short")["steps"] == 200
    assert tether("resume", tmp_path / "short", "--steps", 120, "--quiet").code == 0
    assert_same_run(tmp_path / "short", tmp_path / "long")


def test_a_run_that_has_ended_is_left_as_it_is(finished: Path) -> None:
    before = {path.name: path.read_bytes() for path in finished.iterdir()}
    outcome = tether("resume", finished)
    assert outcome.code == 0
    assert "viscosity" in outcome.out
    assert f"The run in {finished} has ended; --steps N makes it longer." in outcome.out
    assert {path.name: path.read_bytes() for path in finished.iterdir()} == before
    assert tether("resume", finished, "--quiet").out == ""


def test_a_run_killed_before_its_summary_gets_one(finished: Path, run_once: Path) -> None:
    (finished / "summary.json").unlink()
    (finished / "series.nc").unlink()
    assert tether("resume", finished, "--quiet").code == 0
    assert_same_run(finished, run_once / "out")


def test_a_lengthening_that_was_killed_is_not_forgotten(finished: Path) -> None:
    path = finished / "config.toml"
    path.write_text(path.read_text().replace("\nsteps = 200", "\nsteps = 300"))
    assert tether("resume", finished, "--quiet").code == 0
    assert summary(finished)["steps"] == 300


def test_another_configuration_cannot_slip_in(finished: Path) -> None:
    path = finished / "config.toml"
    for old, new in [("temperature = 1.0", "temperature = 2.0"), ("\nsteps = 200", "\nsteps = 100")]:
        text = path.read_text()
        path.write_text(text.replace(old, new))
        assert_one_sentence(tether("resume", finished), 2, "config.toml is not what this run was made from")
        path.write_text(text)


def test_without_a_checkpoint_a_run_begins_again_unless_it_has_results(finished: Path, run_once: Path) -> None:
    (finished / "checkpoint.h5").unlink()
    assert_one_sentence(tether("resume", finished), 2, "has results and no checkpoint")
    (finished / "summary.json").unlink()
    assert tether("resume", finished, "--quiet").code == 0
    assert_same_run(finished, run_once / "out")


# Damage


def test_a_damaged_trajectory_is_set_aside_and_said(finished: Path) -> None:
    for damage in (b"", b"text", (finished / "trajectory.gsd").read_bytes()[:300]):
        (finished / "trajectory.gsd").write_bytes(damage)
        assert_one_sentence(tether("plot", finished), 2, "trajectory.gsd is damaged") if damage else None
        outcome = tether("resume", finished, "--steps", 20)
        assert outcome.code == 0, outcome
        assert "trajectory.gsd.damaged" in outcome.err
        assert (finished / "trajectory.gsd.damaged").read_bytes() == damage
        assert frames(finished)


@pytest.mark.parametrize("damage", ["truncated", "flipped", "text", "foreign", "version", "empty"])
def test_a_damaged_checkpoint_is_refused_in_one_sentence(finished: Path, damage: str) -> None:
    path = finished / "checkpoint.h5"
    whole = path.read_bytes()
    problem = "is damaged"
    if damage == "truncated":
        path.write_bytes(whole[: len(whole) // 2])
    elif damage == "flipped":
        path.write_bytes(whole[:-3000] + bytes([whole[-3000] ^ 1]) + whole[-2999:])
    elif damage == "text":
        path.write_text("once upon a time\n" * 1000)
    elif damage == "empty":
        path.write_bytes(b"")
    elif damage == "foreign":
        path.unlink()
        with h5py.File(path, "w") as file:
            file["position"] = [1.0, 2.0]
        problem = "is damaged or no checkpoint of tether"
    before = {each.name: each.read_bytes() for each in finished.iterdir()}
    with pytest.MonkeyPatch.context() as patch:
        if damage == "version":
            patch.setattr("tether.files.checkpoint.__version__", "99.0")
            problem = "was written by tether 0."
        assert_one_sentence(tether("resume", finished, "--steps", 10), 2, "checkpoint.h5", problem, "run the")
    assert {each.name: each.read_bytes() for each in finished.iterdir()} == before


# A time step that blows up


def test_a_runaway_names_the_step_and_a_smaller_timestep_and_keeps_what_was_measured(tmp_path: Path) -> None:
    config = write_couette(tmp_path, [("timestep = 0.005", "timestep = 0.03"), ("equilibration = 40\n", "")])
    out = tmp_path / "out"
    options = ["--set", "run.steps=100000", "--set", "bodies=[]", "--set", "fluid.repulsion=400"]
    options += ["--set", "output.checkpoint=3", "--set", "output.frames=2", "--set", "output.series=2"]
    outcome = tether("run", config, "--out", out, *options)
    assert_one_sentence(outcome, 1, "couette.toml, line ", "ran away at step ", "try run.timestep = 0.0075")
    step = int(outcome.err.split("at step ")[1].split(",")[0])
    assert not (out / "summary.json").exists()
    assert 0 < checkpointed_step(out) < step
    assert all(frame.configuration.step < step for frame in frames(out))
    again = tether("resume", out)
    assert_one_sentence(again, 1, f"ran away at step {step}", "try run.timestep = 0.0075")
    assert_one_sentence(tether("show", out), 2, "has no results")
    with xr.open_dataset(out / "series.nc") as series:
        assert 0 < int(series["step"][-1]) < step
    assert tether("plot", out).code == 0


# Two processes, and no room


def test_two_processes_do_not_write_into_one_folder(tmp_path: Path) -> None:
    config, out = write_couette(tmp_path), tmp_path / "out"
    running = Running(tmp_path / "log", "run", config, "--out", out, "--quiet", "--set", "run.steps=100000000")
    running.wait_for((out / "checkpoint.h5").exists)
    try:
        assert_one_sentence(tether("resume", out), 2, "is in use", "another tether")
        assert_one_sentence(tether("run", config, "--out", out, "--force"), 2, "is in use", "another tether")
        assert (out / "checkpoint.h5").exists()
    finally:
        running.send(signal.SIGTERM)
    assert running.end().code == 143


def test_a_killed_process_holds_no_folder(tmp_path: Path) -> None:
    config, out = write_couette(tmp_path), tmp_path / "out"
    running = Running(tmp_path / "log", "run", config, "--out", out, "--quiet", "--set", "run.steps=100000000")
    running.wait_for((out / "checkpoint.h5").exists)
    running.send(signal.SIGKILL)
    assert running.end().code == -signal.SIGKILL
    assert tether("run", config, "--out", out, "--quiet", "--force").code == 0


@pytest.mark.parametrize("most", [3_000, 40_000])
def test_a_full_disk_is_said_and_the_run_goes_on_later(tmp_path: Path, run_once: Path, most: int) -> None:
    """The limit on the size of a file stands in for the disk: the operating system refuses real writes."""
    config, out = write_couette(tmp_path), tmp_path / "out"
    former = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, former[1]))
    try:
        outcome = tether("run", config, "--out", out)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, former)
        signal.signal(signal.SIGXFSZ, ignored)
    assert_one_sentence(
        outcome, 1, "out cannot be written (file too large)", f"see to the disk, then tether resume {out}"
    )
    assert not [name for name in names(out) if name.endswith(".part")]
    again = tether("resume", out, "--quiet")
    assert again.code == 0, again
    assert_same_run(out, run_once / "out")


def test_a_write_that_fails_half_way_leaves_the_former_file(
    finished: Path, run_once: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(28, "No space left on device")

    before = (finished / "checkpoint.h5").read_bytes()
    shutil.copytree(finished, finished.parent / "kept")
    monkeypatch.setattr("tether.files.whole.os.fsync", refuse)
    outcome = tether("resume", finished, "--steps", 20)
    monkeypatch.undo()
    assert_one_sentence(outcome, 1, "cannot be written (no space left on device)", "tether resume")
    assert (finished / "checkpoint.h5").read_bytes() == before
    assert_same_run(finished, run_once / "out")
