"""What each command prints and writes when all is well."""

from __future__ import annotations

import json
import math
import re
import tomllib
from pathlib import Path
from typing import Any, get_args

import jsonschema
import matplotlib.image
import numpy as np
import pytest
from small_runs import assert_one_sentence, names, summary, tether, write_couette

import tether as tt
from tether.flows import Flow


def test_version() -> None:
    outcome = tether("--version")
    assert (outcome.code, outcome.out, outcome.err) == (0, f"tether {tt.__version__}\n", "")


def test_without_a_command_the_help_is_printed() -> None:
    outcome = tether()
    assert "Usage: " in outcome.out + outcome.err
    for command in ("run", "resume", "show", "plot", "init", "schema"):
        assert f"\n  {command} " in outcome.out + outcome.err


# run


def test_a_run_prints_a_table_and_where_its_results_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_couette(tmp_path)
    outcome = tether("run", "couette.toml")
    assert outcome.code == 0
    assert outcome.err == ""
    assert outcome.out.endswith("Results: couette\n"), "the folder is called as the file"
    for word in ("viscosity", "pressure", "N1", "kT all", "kT body rotation", "Peclet number", "momentum drift"):
        assert word in outcome.out
    assert "warning: the total strain is 0.5, less than 5" in outcome.out
    written = [name for name in names(tmp_path / "couette") if name[0] != "."]
    assert written == ["checkpoint.h5", "config.toml", "series.nc", "summary.json", "trajectory.gsd"]


def test_quiet_prints_nothing_and_settings_arrive(tmp_path: Path) -> None:
    out = tmp_path / "out"
    options = ["--set", "flow.shear_rate=-0.25", "--set", "run.strain=0.1", "--set", "fluid.friction=9.0"]
    outcome = tether("run", write_couette(tmp_path), "--out", out, "--quiet", "--seed", "123", "--threads", 1, *options)
    assert (outcome.code, outcome.out, outcome.err) == (0, "", "")
    found = summary(out)
    assert found["seed"] == 123
    assert found["shear_rate"] == -0.25
    assert found["steps"] == 80
    assert found["performance"]["threads"] == 1
    resolved = tomllib.loads((out / "config.toml").read_text())
    assert resolved["fluid"]["friction"] == 9.0
    assert "noise" not in resolved["fluid"]
    assert resolved["seed"] == 123


def test_config_toml_runs_again_to_the_same_bits(finished: Path, tmp_path: Path) -> None:
    assert tether("run", finished / "config.toml", "--out", tmp_path / "again", "--quiet").code == 0
    assert summary(tmp_path / "again")["state_sha256"] == summary(finished)["state_sha256"]


@pytest.mark.usefixtures("finished")
def test_a_run_starts_from_a_frame_of_another_and_errors_name_the_line(tmp_path: Path) -> None:
    text = '[start]\nfile = "out/trajectory.gsd"\n\n[run]'
    config = write_couette(tmp_path, [("[run]", text)], "second.toml")
    assert tether("run", config, "--out", tmp_path / "second", "--quiet").code == 0
    first = 1 + config.read_text().splitlines().index('file = "out/trajectory.gsd"')
    for setting, line, problem in [
        ("bodies.0.count=4", f"line {first}", "holds other particles"),
        ("box.size=[4.0, 5.0]", f"line {first}", "holds other particles"),
        ("start.file=missing.gsd", "--set start.file=missing.gsd", "does not exist"),
        ("start.frame=2000", "--set start.frame=2000", "has no frame 2000"),
    ]:
        outcome = tether("run", config, "--out", tmp_path / "third", "--set", setting)
        assert outcome.code == 2
        assert line in outcome.err
        assert problem in outcome.err
        assert outcome.err.count("\n") == 1
        assert not (tmp_path / "third").exists()


def test_relative_viscosity_runs_the_plain_fluid_once(tmp_path: Path) -> None:
    config, out = write_couette(tmp_path), tmp_path / "out"
    options = ["--set", "run.steps=3000", "--set", "run.equilibration=0", "--relative"]
    outcome = tether("run", config, "--out", out, *options)
    assert outcome.code == 0, outcome
    assert outcome.out.count("eta_r = ") == 2
    assert "Einstein" in outcome.out
    assert "Krieger-Dougherty" in outcome.out
    relative = json.loads((out / "relative.json").read_text())
    suspension, plain = summary(out), summary(out / "plain_fluid")
    ratio = suspension["viscosity"]["value"] / plain["viscosity"]["value"]
    assert relative["relative_viscosity"]["value"] == pytest.approx(ratio)
    particles = plain["particles"]
    assert (particles["solvent"], particles["constituents"], particles["volume_fraction"]) == (64, 0, 0.0)
    written = (out / "plain_fluid" / "summary.json").stat().st_mtime_ns
    again = tether("run", config, "--out", out, "--force", *options)
    assert again.code == 0
    assert (out / "plain_fluid" / "summary.json").stat().st_mtime_ns == written
    (out / "plain_fluid" / "checkpoint.h5").write_text("damaged")
    assert tether("run", config, "--out", out, "--force", "--quiet", *options).code == 0
    assert (out / "plain_fluid" / "summary.json").stat().st_mtime_ns > written


# show


def test_show_prints_the_table_again(finished: Path) -> None:
    outcome = tether("show", finished)
    assert outcome.code == 0
    assert "viscosity pairwise" in outcome.out
    assert "warning: " in outcome.out
    assert json.loads(tether("show", finished, "--json").out) == summary(finished)


CASES: dict[str, tuple[list[str], set[str]]] = {
    "2D couette": ([], {"N2"}),
    "3D couette": (['bodies.0.shape="cube"', "box.size=[4.0, 4.0, 4.0]"], set()),
    "2D rest": (['flow={kind = "rest"}'], {"N2", "viscosity", "viscosity_pairwise", "viscosity_random"}),
    "2D plain": (["bodies=[]"], {"N2", "constituents", "body_translation", "body_rotation"}),
    "3D plain rest": (
        ["bodies=[]", "box.size=[4.0, 4.0, 4.0]", 'flow={kind = "rest"}'],
        {
            "viscosity", "viscosity_pairwise", "viscosity_random",
            "constituents", "body_translation", "body_rotation",
        },
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_summary_has_every_key_and_null_for_what_does_not_exist(tmp_path: Path, case: str) -> None:
    settings, absent = CASES[case]
    options = [word for setting in settings for word in ("--set", setting)]
    out = tmp_path / "out"
    outcome = tether("run", write_couette(tmp_path), "--out", out, *options)
    assert outcome.code == 0, outcome
    found = summary(out)
    entry = {"type": "object", "required": ["value", "error"], "additionalProperties": False}
    entry["properties"] = {"value": {"type": "number"}, "error": {"type": ["number", "null"]}}

    def of(name: str) -> dict[str, Any]:
        return {"type": "null"} if name in absent else entry

    def table(**properties: dict[str, Any]) -> dict[str, Any]:
        return {"type": "object", "required": list(properties), "properties": properties}

    number, integer = {"type": "number"}, {"type": "integer"}
    temperatures = ("all", "solvent", "constituents", "body_translation", "body_rotation")
    schema = table(
        version={"const": tt.__version__},
        seed={"const": 7},
        dimension={"const": 3 if case.startswith("3D") else 2},
        particles=table(solvent=integer, constituents=integer, bodies=integer, volume_fraction=number),
        steps={"const": 200},
        temperature=table(**{name: of(name) for name in temperatures}),
        momentum_drift=number,
        performance=table(particle_steps_per_second=number, seconds=number, threads=integer),
        flow={"const": "rest" if "rest" in case else "couette"},
        **{name: of(name) for name in ("pressure", "viscosity", "viscosity_pairwise", "N1", "N2")},
    )
    jsonschema.validate(found, schema)
    assert found["momentum_drift"] < 1e-12
    for name in absent:
        assert name.replace("_", " ") not in outcome.out.split("warning")[0]


def test_the_table_has_every_mean_in_its_group_and_says_what_has_no_value(finished: Path) -> None:
    found = summary(finished)
    mean = {"value": 2.5, "error": 0.1}
    new = {
        "viscosity_planes": mean, "viscosity_momentum_balance": {"value": 2.5, "error": None},
        "viscosity_green_kubo": {"value": None, "error": None}, "storage_modulus": mean,
        "temperature_configurational": mean, "diffusion_solvent": mean, "diffusion_rotational_my_rod": mean,
        "effective_radius_my_rod": mean, "something_new": mean,
    }  # fmt: skip
    found["temperature"]["constituents_raw"] = mean
    (finished / "summary.json").write_text(json.dumps({**found, **new}))
    outcome = tether("show", finished)
    assert outcome.code == 0
    lines = outcome.out.splitlines()
    names = ("viscosity planes", "storage modulus", "pressure", "kT constituents raw", "kT configurational",
             "diffusion rotational my rod", "effective radius my rod", "something new")  # fmt: skip
    row = {name: [line[1:].startswith(f"{name} ") for line in lines].index(True) for name in names}
    assert list(row.values()) == sorted(row.values())
    assert "too short for an error" in next(line for line in lines if "viscosity momentum balance" in line)
    assert "too short for it" in next(line for line in lines if "viscosity green kubo" in line)
    assert "of the orientation" in lines[row["diffusion rotational my rod"]]


# plot


def test_plot_draws_pictures_that_show_something(finished: Path) -> None:
    outcome = tether("plot", finished)
    assert outcome.code == 0
    pictures = [finished / f"{name}.{kind}" for name in ("series", "profile") for kind in ("png", "svg")]
    assert outcome.out.split() == [str(path) for path in pictures]
    for path in pictures:
        if path.suffix == ".png":
            image = matplotlib.image.imread(path)
            assert min(image.shape[:2]) > 300
            pixels = image[::4, ::4, :3]
            assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 20
            assert 0.01 < np.mean(pixels.min(axis=2) < 0.9) < 0.9
        else:
            text = path.read_text()
            assert "<svg" in text
            assert "nan" not in text.lower().split("<path")[-1]


@pytest.mark.parametrize(
    "settings",
    [
        ["run.steps=2", "output.series=1"],
        ['flow={kind = "rest"}'],
        ["bodies=[]"],
        ["box.size=[4.0, 4.0, 4.0]", 'bodies.0.shape="cube"'],
    ],
)
def test_plot_of_the_smallest_of_runs(tmp_path: Path, settings: list[str]) -> None:
    options = [word for setting in settings for word in ("--set", setting)]
    out = tmp_path / "out"
    outcome = tether("run", write_couette(tmp_path), "--out", out, *options)
    assert outcome.code == 0, outcome
    assert tether("show", out).code == 0
    assert tether("plot", out).code == 0
    assert (out / "series.png").stat().st_size > 10_000


STRESS = {"profiles": "{bins = 4, every = 10}", "stress_profile": "{bins = 4, every = 10}"}
STRUCTURE = {"radial_distribution": "{every = 20, width = 0.05}", "displacement": "{every = 5}"}
FLOWS: dict[str, tuple[str, dict[str, str], set[str]]] = {
    "couette": ("shear_rate = 0.5", STRESS | STRUCTURE, {"profile", *STRESS, *STRUCTURE}),
    "rest": ("", STRUCTURE | {"green_kubo": "true"}, {"profile", "green_kubo", *STRUCTURE}),
    "oscillatory": ("strain_amplitude = 0.5, angular_frequency = 5.0", {}, {"lissajous"}),
    "stages": (
        "stages = [{shear_rate = 0.5, duration = 0.2}, {shear_rate = 0.0, duration = 0.2}]", {}, {"start_up"},
    ),
    "poiseuille": ("force = 0.5", STRESS, set(STRESS)),
    "kolmogorov": ("force = 0.5", {}, {"profiles"}),
}  # fmt: skip
"""Of each kind of flow: its keys, what is measured, and the pictures that there are beside the series."""


@pytest.mark.parametrize("flow", FLOWS)
def test_plot_draws_a_picture_of_everything_that_was_measured(tmp_path: Path, flow: str) -> None:
    keys, measured, expected = FLOWS[flow]
    out = tmp_path / "out"
    options = [f'flow={{kind = "{flow}"{", " if keys else ""}{keys}}}', "run.steps=1500"]
    options += [f"measure.{name}={table}" for name, table in measured.items()]
    settings = [word for setting in options for word in ("--set", setting)]
    outcome = tether("run", write_couette(tmp_path), "--out", out, "--quiet", *settings)
    assert outcome.code == 0, outcome
    outcome = tether("plot", out)
    assert (outcome.code, outcome.err) == (0, "")
    pictures = {f"{name}.{kind}" for name in {"series", *expected} for kind in ("png", "svg")}
    assert {Path(path).name for path in outcome.out.split()} == pictures
    assert {path.name for path in out.iterdir() if path.suffix in (".png", ".svg")} == pictures
    assert tether("show", out).code == 0


def test_plot_of_damaged_or_unfinished_results(tmp_path: Path) -> None:
    out = tmp_path / "out"
    options = ["--set", 'flow={kind = "kolmogorov", force = 0.5}']
    assert tether("run", write_couette(tmp_path), "--out", out, "--quiet", *options).code == 0
    (out / "profiles.nc").write_bytes(b"text")
    assert_one_sentence(tether("plot", out), 2, "profiles.nc is damaged", "run the configuration again")
    assert not (out / "series.png").exists(), "nothing is drawn, rather than some"
    (out / "summary.json").unlink()  # as of a run that was stopped: what belongs to its end is not drawn
    assert [Path(path).name for path in tether("plot", out).out.split()] == ["series.png", "series.svg"]
    assert "; energy of the" in (out / "series.svg").read_text(), "no profile is known to take the flow off by"


def test_one_sample_cannot_be_drawn(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert tether("run", write_couette(tmp_path), "--out", out, "--quiet", "--set", "run.steps=1").code == 0
    assert_one_sentence(tether("plot", out), 2, "has a series of one sample")


# init, schema


KINDS = [kind.model_fields["kind"].default for kind in get_args(get_args(Flow)[0])]


@pytest.mark.parametrize("flow", KINDS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_init_writes_a_file_that_runs(tmp_path: Path, flow: str, dimension: int) -> None:
    config = tmp_path / "my run.toml"
    outcome = tether("init", config, "--flow", flow, "--dimension", dimension)
    assert (outcome.code, outcome.err) == (0, "")
    assert str(config) in outcome.out
    assert tether("init", "-", "--flow", flow, "--dimension", dimension).out == config.read_text()
    assert_one_sentence(tether("init", config), 2, "exists", "name another file")
    assert_one_sentence(tether("init", tmp_path / "none" / "my.toml"), 2, "cannot be written", "name another file")
    jsonschema.validate(tomllib.loads(config.read_text()), json.loads(tether("schema").out))
    options = ["--set", "run.equilibration=5", "--set", "run.steps=60"]
    assert tether("run", config, "--out", tmp_path / "out", "--quiet", *options).code == 0
    found = summary(tmp_path / "out")
    assert found["dimension"] == dimension
    assert (found["flow"], found["viscosity"] is None) == (flow, flow != "couette")
    assert math.isfinite(found["pressure"]["value"])


@pytest.mark.parametrize("flow", KINDS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_what_init_leaves_commented_out_is_valid_too(tmp_path: Path, flow: str, dimension: int) -> None:
    text = tether("init", "-", "--flow", flow, "--dimension", dimension).out
    assert max(map(len, text.splitlines())) <= 110
    config = tmp_path / "all.toml"
    config.write_text(re.sub(r"^# (?=\[|\w+ = )", "", text, flags=re.MULTILINE))
    made = tt.load(config)
    assert (made.flow.kind, made.dimension) == (flow, dimension)
    measured = set(tomllib.loads(config.read_text())["measure"])
    assert set(tt.Measure.model_fields) - measured <= {"green_kubo", "stop_when"}
    assert tt.load(config).measure == tt.Measure.model_validate(
        dict.fromkeys(measured - {"stop_when", "green_kubo"}, True)
        | {"green_kubo": made.measure.green_kubo, "stop_when": made.measure.stop_when}
    ), "what is written there are the defaults"
    jsonschema.validate(tomllib.loads(config.read_text()), json.loads(tether("schema").out))


def test_the_schema_takes_the_examples_and_what_is_resolved_and_refuses_typing_errors(finished: Path) -> None:
    schema = json.loads(tether("schema").out)
    jsonschema.Draft202012Validator.check_schema(schema)
    examples = list((Path(__file__).parents[2] / "examples").glob("*.toml"))
    assert examples
    for path in [*examples, finished / "config.toml", finished.parent / "couette.toml"]:
        jsonschema.validate(tomllib.loads(path.read_text()), schema)
    of_studies = json.loads(tether("schema", "--study").out)
    jsonschema.Draft202012Validator.check_schema(of_studies)
    for path in (Path(__file__).parents[2] / "examples" / "studies").glob("*.toml"):
        jsonschema.validate(tomllib.loads(path.read_text()), of_studies)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"base": "couette.toml", "sweeep": {}}, of_studies)
    good = tomllib.loads((finished / "config.toml").read_text())
    for kind in KINDS:  # without a kind no flow is one
        flow = {key: value for key, value in _flow_of_template(kind).items() if key != "kind"}
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**good, "flow": flow}, schema)
    for table, key, value in [("fluid", "temprature", 1.0), ("fluid", "temperature", "1"), ("flow", "kind", "shear")]:
        spoiled = {**good, table: {**good[table], key: value}}
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(spoiled, schema)


def _flow_of_template(kind: str) -> dict[str, Any]:
    flow: dict[str, Any] = tomllib.loads(tether("init", "-", "--flow", kind).out)["flow"]
    return flow
