"""The simulation from Python, as in the README's five lines."""

from __future__ import annotations

import re
import signal
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import tether as tt
from tether.drive import Stopped, drive
from tether.resume import resume


def small(**keys: Any) -> tt.Simulation:
    """76 particles in two dimensions."""
    defaults = {
        "box": tt.Box(4, 4),
        "fluid": tt.Fluid(temperature=1.0),
        "bodies": [tt.Bodies(tt.square(0.25), count=3)],
        "flow": tt.Couette(shear_rate=0.5),
        "timestep": 0.005,
        "seed": 1,
    }
    return tt.Simulation(**(defaults | keys))


def test_five_lines() -> None:
    sim = small()
    result = sim.run(equilibration=200, steps=8000)
    assert re.fullmatch(r"\d+\.\d+ \+- \d+\.\d+", str(result.viscosity)), str(result.viscosity)
    assert 1.5 < result.viscosity.value < 9
    assert sim.step == 8200
    assert sim.time == pytest.approx(41.0)


def test_arrays_have_the_documented_shapes_and_are_copies() -> None:
    sim = small()
    assert sim.positions.shape == sim.velocities.shape == (76, 2)
    assert sim.species.shape == sim.body_index.shape == sim.masses.shape == (76,)
    assert list(sim.body_index[60:]) == [-1] * 4 + [0] * 4 + [1] * 4 + [2] * 4
    assert list(np.unique(sim.species)) == [0, 1]
    before = sim.state_sha256
    sim.positions[:] = 0.0
    sim.velocities[:] = 0.0
    assert sim.state_sha256 == before
    assert (sim.positions >= 0).all()
    assert (sim.positions < 4).all()


def test_a_short_run_says_so_instead_of_giving_an_error() -> None:
    result = small().run(steps=50)
    assert str(result.viscosity).endswith("(too short for an error)")
    assert any("too short" in warning for warning in result.warnings)
    assert any("total strain is 0.125" in warning for warning in result.warnings)


# Bits


@pytest.mark.parametrize("dimension", [2, 3])
def test_results_do_not_depend_on_threads(dimension: int) -> None:
    results = []
    for threads in (1, 2, 3):
        sim = small(
            box=tt.Box(12, 12) if dimension == 2 else tt.Box(6, 6, 6),
            bodies=[tt.Bodies(tt.square(0.25) if dimension == 2 else tt.cube(0.25), count=20)],
            threads=threads,
        )
        assert sim.threads == threads
        results.append(sim.run(equilibration=20, steps=40))
    assert len({result.state_sha256 for result in results}) == 1
    for result in results[1:]:
        xr.testing.assert_identical(result.series, results[0].series)


@pytest.mark.parametrize("series", [1, 4, 10])
def test_results_do_not_depend_on_the_portions_of_a_run(series: int) -> None:
    whole = small(output=tt.Output(series=series))
    expected = whole.run(equilibration=15, steps=85)
    assert expected.series.sizes["time"] == 85 // series
    configuration = whole.configuration
    for portions in ([1], [3, 1, 7], [64]):
        sim = tt.Simulation.from_configuration(configuration)
        turn = 0
        while not sim.is_finished:
            sim.advance(portions[turn % len(portions)])
            turn += 1
        assert sim.step == 100
        assert sim.state_sha256 == expected.state_sha256
        xr.testing.assert_identical(sim.result().series, expected.series)


def test_a_sample_is_the_mean_over_its_steps() -> None:
    each = small(output=tt.Output(series=1)).run(steps=60).series
    means = small(output=tt.Output(series=10)).run(steps=60).series
    for name in ("stress_conservative", "stress_random", "temperature", "momentum"):
        expected = each[name].values.reshape(6, 10, *each[name].shape[1:]).mean(axis=1)
        assert means[name].values == pytest.approx(expected, rel=1e-12, abs=1e-12), name


def test_a_checkpoint_in_memory_goes_on_in_the_same_bits() -> None:
    sim = small(output=tt.Output(series=10))
    expected = sim.run(equilibration=10, steps=100)
    half = tt.Simulation.from_configuration(sim.configuration)
    while half.step < 57:
        half.advance(1)
    rest = tt.Simulation.from_configuration(sim.configuration, threads=2)
    rest.restore(half.checkpoint())
    while not rest.is_finished:
        rest.advance(1000)
    assert rest.state_sha256 == expected.state_sha256
    xr.testing.assert_identical(rest.result().series, expected.series)


def test_running_again_goes_on_and_measures_anew() -> None:
    sim = small()
    first = sim.run(equilibration=20, steps=40)
    second = sim.run(steps=60)
    assert sim.step == 120
    assert list(second.series["step"].values) == list(range(70, 121, 10))
    assert list(first.series["step"].values) == list(range(30, 61, 10))
    assert first.state_sha256 != second.state_sha256
    once = small()
    once.run(equilibration=60, steps=60)
    assert once.state_sha256 == second.state_sha256


def test_strain_gives_the_steps() -> None:
    result = small().run(strain=0.5)
    assert result.configuration.steps == 200
    assert result.strain == pytest.approx(0.5)


# Files from Python


def test_a_run_writes_its_folder_and_can_be_resumed(tmp_path: Path) -> None:
    sim = small()
    result = sim.run(equilibration=10, steps=50, out=tmp_path / "out")
    written = {each.name for each in (tmp_path / "out").iterdir() if each.name[0] != "."}
    assert written == {"config.toml", "trajectory.gsd", "series.nc", "checkpoint.h5", "summary.json"}
    again, record, remarks = resume(tmp_path / "out", more_steps=30)
    assert remarks == []
    assert again.state_sha256 == result.state_sha256
    drive(again, record)
    assert again.step == 90
    with pytest.raises(tt.InputError, match="exists"):
        sim.run(steps=10, out=tmp_path / "out")
    sim.run(steps=10, out=tmp_path / "out", force=True)
    assert resume(tmp_path / "out")[0].step == sim.step == 70


def test_a_second_run_resumes_where_it_stood(tmp_path: Path) -> None:
    sim = small()
    sim.run(steps=30)
    second = sim.run(equilibration=10, steps=40, out=tmp_path / "out")
    again, _, _ = resume(tmp_path / "out")
    assert again.is_finished
    assert again.step == 80
    xr.testing.assert_identical(again.result().series, second.series)


def test_a_start_from_a_relative_path_resumes_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    small().run(steps=10, out="first")
    small(start=tt.Start(file="first/trajectory.gsd")).run(steps=20, out="second")
    monkeypatch.chdir("/")
    assert resume(tmp_path / "second")[0].step == 20


# Errors


def test_errors_are_sentences() -> None:
    with pytest.raises(tt.InputError, match=r"threads = 0 must be from 1 to 1024"):
        small(threads=0)
    with pytest.raises(tt.InputError, match=r"Run: steps is missing, and so is strain"):
        small().run()
    with pytest.raises(tt.InputError, match=r"run.strain = 5.0 needs a flow that shears"):
        small(flow=tt.Rest()).run(strain=5.0)
    with pytest.raises(tt.InputError, match=r"output.series = 10 is more than the 5 steps"):
        small(output=tt.Output(series=10)).run(steps=5)
    with pytest.raises(tt.RunError, match="nothing has been measured yet"):
        small().result()
    with pytest.raises(tt.RunError, match=r"ran away at step \d+, .*; try run.timestep = 0\.025"):
        small(timestep=0.1, bodies=[], fluid=tt.Fluid(temperature=1.0, repulsion=500.0)).run(steps=500)


# The interpreter meanwhile


def test_other_threads_run_meanwhile() -> None:
    """Another thread wakes up every millisecond while the engine steps; with the interpreter held it could not."""
    sim = small(box=tt.Box(20, 20, 10), bodies=[tt.Bodies(tt.cube(0.25), count=8)], threads=1)
    sim.place()
    ends = threading.Event()
    woken: list[float] = []

    def count() -> None:
        while not ends.wait(0.001):
            woken.append(time.perf_counter())

    counter = threading.Thread(target=count)
    counter.start()
    began = time.perf_counter()
    sim.engine.run(30)
    ended = time.perf_counter()
    ends.set()
    counter.join()
    assert len([moment for moment in woken if began < moment < ended]) > 10


def test_a_run_in_a_thread_of_its_own_takes_no_signals() -> None:
    former = signal.getsignal(signal.SIGINT)
    results: list[tt.Result] = []
    runner = threading.Thread(target=lambda: results.append(small().run(steps=50)))
    runner.start()
    runner.join()
    assert len(results) == 1
    assert signal.getsignal(signal.SIGINT) is former


def test_an_interruption_keeps_the_simulation_and_gives_the_signals_back() -> None:
    sim = small()
    former = signal.getsignal(signal.SIGINT)
    timer = threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT))
    timer.start()
    with pytest.raises(Stopped, match=r"^stopped at step \d+$"):
        sim.run(steps=10**8)
    timer.join()
    assert issubclass(Stopped, KeyboardInterrupt), "so that `except Exception` does not go on with the next run"
    assert signal.getsignal(signal.SIGINT) is former
    assert 0 < sim.step < 10**8
    assert sim.result().pressure.value > 0
    assert sim.run(steps=10).pressure.value > 0


def test_a_signal_that_is_ignored_stays_ignored() -> None:
    """As that of a job which a script has put into the background."""
    former = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        timer = threading.Timer(0.05, lambda: signal.raise_signal(signal.SIGINT))
        timer.start()
        result = small().run(steps=3000)
        timer.join()
    finally:
        signal.signal(signal.SIGINT, former)
    assert result.configuration.steps == 3000
