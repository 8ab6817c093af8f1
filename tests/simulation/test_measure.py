"""What [measure] asks for: observers in a run, in whatever portions it goes, through a checkpoint, and into files."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import tether as tt
from tether.drive import drive
from tether.files.checkpoint import Checkpoint
from tether.record import DATASETS, Record
from tether.resume import resume

ALL = {
    "profiles": {"bins": 8, "every": 5},
    "stress_profile": {"bins": 4, "every": 10},
    "radial_distribution": {"every": 20},
    "displacement": {"every": 5},
}
FLOWS = {
    "rest": tt.Rest(),
    "couette": tt.Couette(shear_rate=0.3),
    "oscillatory": tt.Oscillatory(strain_amplitude=0.4, angular_frequency=2.0),
    "stages": tt.Stages(stages=[{"shear_rate": 0.4, "duration": 0.3}, {"shear_rate": -0.1, "duration": 0.2}]),
    "poiseuille": tt.Poiseuille(force=0.2),
    "kolmogorov": tt.Kolmogorov(force=0.2, periods=2),
}
MODELS = [
    tt.Bodies("square", count=2),
    tt.Bodies("square", count=2, model="rigid", name="frozen"),
    tt.Bodies(model="single", radius=0.4, count=2),
]


def suspension(flow: str = "couette", **settings: object) -> tt.Simulation:
    """48 particles of solvent and two bodies of each model."""
    defaults = {"bodies": MODELS, "measure": tt.Measure(**ALL), "box": tt.Box(4, 4), "timestep": 0.005, "seed": 3}
    fluid = tt.Fluid(density=3.0, temperature=1.0)
    return tt.Simulation(**{**defaults, "fluid": fluid, "flow": FLOWS[flow], **settings})


def same(first: dict[str, xr.Dataset], second: dict[str, xr.Dataset]) -> bool:
    return first.keys() == second.keys() and all(first[name].identical(second[name]) for name in first)


@pytest.mark.parametrize("flow", FLOWS)
def test_portions_and_checkpoints_change_no_bit(flow: str, tmp_path: Path) -> None:
    """At once, step by step, or stopped, written, read and gone on with."""
    whole = suspension(flow)
    expected = whole.run(equilibration=7, steps=120)
    parts = suspension(flow, threads=2)
    parts.configuration = whole.configuration
    parts._measure_anew()
    while parts.step < 60:
        parts.advance(1)
    parts.checkpoint().write(tmp_path / "checkpoint.h5")
    second = tt.Simulation.from_configuration(whole.configuration)
    second.restore(Checkpoint.read(tmp_path / "checkpoint.h5"))
    while not second.is_finished:
        second.advance(11)
    found = second.result()
    assert found.state_sha256 == expected.state_sha256
    assert same(found.datasets, expected.datasets)
    assert found.series.identical(expected.series)
    assert set(expected.observed) == set(ALL)


def test_a_driven_flow_measures_profiles_in_any_case() -> None:
    result = suspension("kolmogorov", measure=tt.Measure()).run(steps=120)
    assert set(result.observed) == {"profiles"}
    assert "driving_force_density" in result.observed["profiles"]
    assert "viscosity_momentum_balance" in result.derived
    assert set(suspension("couette", measure=tt.Measure()).run(steps=40).observed) == set()


def test_a_driven_flow_is_no_heat() -> None:
    """Means are about the measured profile: with a strong flow, temperature, pressure and N1 are those of rest."""
    fluid, box = tt.Fluid(temperature=1.0), tt.Box(6, 6)
    settings = {"box": box, "fluid": fluid, "timestep": 0.005, "seed": 4}
    driven = tt.Simulation(flow=tt.Kolmogorov(force=1.0), **settings).run(equilibration=2000, steps=4000)
    energy = driven.series["temperature"].values.mean()
    temperature = driven.temperature["all"]
    assert temperature is not None
    assert energy > 1.2  # the series has the flow in it
    assert abs(temperature.value - 1) < 0.05
    assert abs(driven.N1.value) < 0.3
    assert -driven.series["stress_kinetic"].values.mean(axis=0)[0, 0] - 4 > 0.5


@pytest.mark.parametrize("dimension", [2, 3])
def test_rigid_bodies_have_fewer_degrees_of_freedom(dimension: int) -> None:
    """2D: 3 of 8; 3D: 6 of 24; less the share of the total momentum, which does not fluctuate."""
    shape, box = ("square", tt.Box(5, 5)) if dimension == 2 else ("cube", tt.Box(4, 4, 4))
    bodies = [tt.Bodies(shape, count=3, model="rigid")]
    simulation = tt.Simulation(box=box, fluid=tt.Fluid(temperature=1.0), bodies=bodies, timestep=0.005, seed=5)
    freedom = simulation.run(steps=20).freedom
    solvent, sites = simulation.configuration.solvent_count, 3 * 2**dimension
    share = sites / (sites + solvent)
    assert freedom.body_rotation == 3 * (1 if dimension == 2 else 3)
    assert freedom.constituents == pytest.approx(3 * (3 if dimension == 2 else 6) - dimension * share)
    assert freedom.constituents_raw == pytest.approx(dimension * (sites - share))
    assert freedom.all == pytest.approx(dimension * solvent + 3 * (3 if dimension == 2 else 6) - dimension)


def test_profiles_count_degrees_of_freedom_too() -> None:
    """The temperature of a rigid suspension is kT in every bin, also of its constituents."""
    bodies = [tt.Bodies("square", count=9, model="rigid")]
    measure = tt.Measure(profiles={"bins": 4, "every": 5})
    simulation = tt.Simulation(
        box=tt.Box(6, 6), fluid=tt.Fluid(temperature=1.0), bodies=bodies, timestep=0.01, seed=6, measure=measure
    )
    profile = simulation.run(equilibration=500, steps=20_000).observed["profiles"]
    for name in ("temperature", "temperature_solvent", "temperature_constituents"):
        assert np.abs(profile[name].values - 1).max() < 0.1, name
        assert abs(profile[name].values.mean() - 1) < 0.03, name


def test_a_run_stops_when_its_viscosity_is_known() -> None:
    """At the first look at which the relative error is small enough; the looks do not depend on the portions."""
    target = {"viscosity": 0.2}
    settings = {"bodies": [], "box": tt.Box(5, 5)}
    simulation = suspension(measure=tt.Measure(stop_when=target), **settings)
    result = simulation.run(equilibration=100, steps=200_000)
    assert result.viscosity is not None
    assert result.viscosity.converged
    assert result.viscosity.relative_error <= target["viscosity"]
    assert 1000 <= result.steps < 100_000
    assert simulation.is_finished
    assert result.steps == simulation.step - 100 == result.as_dict()["steps"]
    assert result.strain == pytest.approx(result.steps * 0.3 * 0.005)
    again = suspension(measure=tt.Measure(stop_when=target), **settings)
    again.configuration = simulation.configuration
    again._measure_anew()
    while not again.is_finished:
        again.advance(37)
    assert again.state_sha256 == result.state_sha256
    longer = suspension(measure=tt.Measure(stop_when={"viscosity": 1e-6}), **settings).run(steps=2000)
    assert longer.steps == 2000


def test_files_of_a_run(tmp_path: Path) -> None:
    """One netCDF file for each, which xarray reads; estimates stand in summary.json."""
    measure = tt.Measure(**ALL, green_kubo=True)
    result = suspension("rest", measure=measure).run(equilibration=20, steps=4000, out=tmp_path / "run")
    record = Record.open(tmp_path / "run")
    assert set(record.datasets()) == {*ALL, "green_kubo", "green_kubo_integral"} <= set(DATASETS)
    for name, dataset in record.datasets().items():
        xr.testing.assert_allclose(dataset, result.datasets[name])
        for variable in dataset.data_vars.values():
            assert "long_name" in variable.attrs or variable.name.endswith("_error"), (name, variable.name)
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    for name in ("temperature_configurational", "viscosity_green_kubo"):
        assert name in summary, name
    assert summary["particles"]["volume_fraction_from"][0] == "eq. 42"
    assert record.configuration() == result.configuration.resolved()


@pytest.mark.parametrize("flow", ["oscillatory", "stages"])
def test_unsteady_shear_has_its_functions(flow: str, tmp_path: Path) -> None:
    result = suspension(flow, measure=tt.Measure()).run(steps=1400, out=tmp_path / "run")
    name, mean = ("lissajous", "loss_modulus") if flow == "oscillatory" else ("start_up", None)
    assert name in Record.open(tmp_path / "run").datasets()
    assert mean is None or mean in result.derived
    assert result.viscosity is None
    strain = FLOWS[flow].strain(result.series["step"].values, 0.005)
    np.testing.assert_allclose(result.series["strain"].values, strain)
    rate = np.diff(np.concatenate([[0.0], strain])) / (result.configuration.series_interval * 0.005)
    np.testing.assert_allclose(result.series["shear_rate"].values, rate, atol=1e-12)


def test_resuming_goes_on_with_what_was_observed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that is interrupted and resumed from its folder ends with the same files."""
    whole = suspension().run(equilibration=10, steps=200, out=tmp_path / "whole")
    interrupted = suspension()
    ordinary: Callable[[int], None] = interrupted.advance

    def advance(steps: int) -> None:
        if interrupted.step >= 100:
            raise tt.RunError("interrupted", "the test wants it", "go on")
        ordinary(min(steps, 10))

    monkeypatch.setattr(interrupted, "advance", advance)
    output = {"out": tmp_path / "parts"}
    interrupted.configuration = interrupted.configuration.changed(output=tt.Output(checkpoint=30))
    with pytest.raises(tt.RunError):
        interrupted.run(equilibration=10, steps=200, **output)
    simulation, record, _ = resume(tmp_path / "parts")
    drive(simulation, record)
    assert same(simulation.result().datasets, whole.datasets)


def test_a_run_that_stopped_goes_on_when_asked(tmp_path: Path) -> None:
    """By so many steps beyond where it stopped, and without the goal; also if that is interrupted at once."""
    goal = tt.Measure(stop_when={"viscosity": 0.3})
    settings = {"bodies": [], "box": tt.Box(5, 5), "measure": goal}
    stopped = suspension(**settings).run(steps=200_000, out=tmp_path / "run")
    simulation, record, _ = resume(tmp_path / "run", more_steps=500)
    record.take_over(simulation)  # and then somebody pulls the plug
    again, record, _ = resume(tmp_path / "run")
    assert again.end == stopped.steps + 500
    drive(again, record)
    assert record.summary()["steps"] == stopped.steps + 500


@pytest.mark.parametrize(
    ("flow", "measure", "run"),
    [
        ("kolmogorov", {}, {"steps": 30}),  # no sample of the profile
        ("poiseuille", {"profiles": {"bins": 500, "every": 5}}, {"steps": 100}),  # bins that are always empty
        ("rest", {"green_kubo": True, "displacement": {"every": 50}}, {"steps": 20}),
        ("couette", {"stress_profile": {"every": 1000}, "radial_distribution": {"every": 1000}}, {"steps": 20}),
        ("stages", {}, {"steps": 40}),  # less than a cycle
        ("oscillatory", {}, {"steps": 40}),
    ],
)
def test_the_shortest_of_runs_end_well(
    flow: str, measure: dict[str, object], run: dict[str, int], tmp_path: Path
) -> None:
    """What there is too little of is left out or has no error; everything that is written can be read."""
    suspension(flow, measure=tt.Measure(**measure)).run(**run, out=tmp_path / "run")
    record = Record.open(tmp_path / "run")
    assert record.summary()["steps"] == run["steps"]
    record.datasets()


def test_the_energy_of_no_flow_is_none() -> None:
    """A force that drives nothing leaves temperature and N1 alone, however many bins find a chance velocity."""
    settings = {"bodies": [], "box": tt.Box(5, 5), "measure": tt.Measure(profiles={"bins": 100, "every": 5})}
    weak = suspension("kolmogorov", **settings).configuration.changed(flow=tt.Kolmogorov(force=1e-6))
    simulation = tt.Simulation.from_configuration(weak)
    result = simulation.run(equilibration=200, steps=4000)
    series, temperature = float(result.series["temperature"].mean()), result.temperature["all"]
    assert temperature is not None
    assert abs(temperature.value - series) < 0.02


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"flow": "oscillatory", "frequency": 1000.0}, "flow.angular_frequency"),
        ({"flow": "kolmogorov", "periods": 9, "measure": {"profiles": {"bins": 20}}}, "measure.profiles.bins"),
        ({"flow": "poiseuille", "measure": {"profiles": {"bins": 5}}}, "measure.profiles.bins"),
        ({"flow": "stages", "output": {"series": 7}}, "output.series"),
        ({"flow": "rest", "measure": {"radial_distribution": {"width": 5.0}}}, "measure.radial_distribution.width"),
        ({"flow": "rest", "measure": {"radial_distribution": {"range": 3.9}}}, "measure.radial_distribution.range"),
        ({"flow": "couette", "measure": {"green_kubo": True}}, "measure.green_kubo"),
        ({"flow": "rest", "measure": {"stop_when": {"viscosity": 0.1}}}, "measure.stop_when.viscosity"),
    ],
)
def test_what_cannot_be_measured_is_refused(settings: dict[str, object], said: str) -> None:
    flow = FLOWS[str(settings["flow"])]
    if "frequency" in settings:
        flow = flow.changed(angular_frequency=settings["frequency"])
    if "periods" in settings:
        flow = flow.changed(periods=settings["periods"])
    keys = {"box": tt.Box(4, 4), "fluid": tt.Fluid(temperature=1.0), "flow": flow, "timestep": 0.005}
    tables = {"measure": tt.Measure, "output": tt.Output}
    more = {name: table(**settings[name]) for name, table in tables.items() if name in settings}
    with pytest.raises(tt.InputError, match=said.replace(".", r"\.")):
        tt.Simulation(**keys, **more).run(steps=100)
