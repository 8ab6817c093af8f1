"""Wrong input: exit code 2, one sentence on stderr, nothing created."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_runs import COUETTE, assert_one_sentence, names, tether, write_couette

SPOILED = [
    ("temperature = 1.0", "temprature = 1.0", "line 7", "did you mean temperature?"),
    ("temperature = 1.0", 'temperature = "1.0"', "line 7", "is text, not a number"),
    ("temperature = 1.0", "temperature = -1", "line 7", "must be greater than 0"),
    ("timestep = 0.005", "timestep = 0", "line 18", "must be greater than 0"),
    ("steps = 200", "steps = 0", "line 20", "at least 1"),
    ("size = [4.0, 4.0]", "size = [4.0, 2.5]", "line 4", "shorter than 3 cutoffs"),
    ("count = 3", "count = 5000", "line 9", "5000 bodies cannot be placed"),
    ('kind = "couette"', 'kind = "shear"', "line 14", '"stages", "poiseuille" or "kolmogorov"'),
    ("seed = 7", "seed = 7 8", "line 1", "couette.toml"),
]


@pytest.mark.parametrize(("old", "new", "line", "part"), SPOILED)
def test_a_spoiled_file_is_refused_in_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, old: str, new: str, line: str, part: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write_couette(tmp_path, [(old, new)])
    assert_one_sentence(tether("run", "couette.toml"), 2, "couette.toml", line, part)
    assert names(tmp_path) == ["couette.toml"]


@pytest.mark.parametrize(
    ("options", "part"),
    [
        (["--set", "fluid.temprature=2"], "did you mean temperature?"),
        (["--set", "fluid.temperature"], "section.key=value"),
        (["--set", "bodies.4.count=2"], "bodies.4 does not exist"),
        (["--set", "run.timestep=0.5"], "too long for springs"),
        (["--seed", "-1"], "--seed -1: seed = -1 must be at least 0"),
        (["--relative", "--set", "bodies=[]"], "--relative needs bodies"),
        (["--relative", "--set", 'flow={kind = "poiseuille", force = 0.1}'], "a steady shear flow"),
        (["--set", "measure.green_kubo=true"], "green_kubo = true needs a suspension at rest"),
        (["--set", "measure.radial_distribution.range=3.0"], "is more than a third of the smallest side, 4"),
        (["--set", "measure.stop_when={viscosity = 0.01}", "--set", 'flow={kind = "rest"}'], "needs a steady shear"),
        (["--set", "measure.profile=true"], "did you mean profiles?"),
        (["--set", 'flow={kind = "poiseuille"}'], "force is missing"),
        (["--set", 'flow={kind = "stages", stages = []}'], "flow.stages"),
        (["--set", 'flow={kind = "stages", stages = [{shear_rate = 0.5}]}'], "duration is missing"),
        (["--set", 'flow={kind = "oscillatory", strain_amplitude = 0.5, angular_frequency = 0}'], "greater than 0"),
        (["--relative", "--set", 'flow={kind = "rest"}'], "--relative needs bodies and a steady shear flow"),
    ],
)
def test_wrong_options_are_refused_in_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: list[str], part: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write_couette(tmp_path)
    assert_one_sentence(tether("run", "couette.toml", *options), 2, part)
    assert names(tmp_path) == ["couette.toml"]


@pytest.mark.parametrize("arguments", [["run"], ["walk"], ["run", "a.toml", "--no-such"], ["init", "--dimension", "4"]])
def test_wrong_usage_ends_with_2_and_says_how(arguments: list[str]) -> None:
    outcome = tether(*arguments)
    assert outcome.code == 2
    assert "Usage: " in outcome.err
    assert "Traceback" not in outcome.err


def test_a_file_that_is_not_there_or_no_text(tmp_path: Path) -> None:
    assert_one_sentence(tether("run", tmp_path / "none.toml"), 2, "none.toml")
    assert_one_sentence(tether("run", tmp_path), 2, str(tmp_path))
    (tmp_path / "binary.toml").write_bytes(b"\x93\x00\xff")
    assert_one_sentence(tether("run", tmp_path / "binary.toml"), 2, "binary.toml")


# The folder of results


def test_an_existing_run_is_kept_without_force(finished: Path) -> None:
    finished = finished.rename(finished.parent / "my run")
    before = {path.name: path.read_bytes() for path in finished.iterdir()}
    assert_one_sentence(
        tether("run", finished.parent / "couette.toml", "--out", finished),
        2,
        "exists",
        f"tether resume '{finished}'",
        "--force",
    )
    assert {path.name: path.read_bytes() for path in finished.iterdir()} == before


def test_force_overwrites_what_a_run_wrote_and_nothing_else(finished: Path) -> None:
    (finished / "series.png").write_text("ours")
    (finished / "thesis.png").write_text("not ours")
    assert (
        tether("run", finished.parent / "couette.toml", "--out", finished, "--quiet", "--force", "--seed", 9).code == 0
    )
    assert (finished / "thesis.png").read_text() == "not ours"
    assert not (finished / "series.png").exists(), "a picture of the run before"
    assert "seed = 9" in (finished / "config.toml").read_text()


def test_a_forced_run_that_cannot_start_destroys_nothing(finished: Path) -> None:
    before = {path.name: path.read_bytes() for path in finished.iterdir()}
    outcome = tether(
        "run", finished.parent / "couette.toml", "--out", finished, "--force", "--set", "bodies.0.count=5000"
    )
    assert_one_sentence(outcome, 2, "cannot be placed")
    assert {path.name: path.read_bytes() for path in finished.iterdir()} == before


@pytest.mark.parametrize("theirs", ["letter.txt", "config.toml", "summary.json"])
def test_a_foreign_folder_is_left_alone_with_force_too(tmp_path: Path, theirs: str) -> None:
    config, out = write_couette(tmp_path), tmp_path / "project"
    out.mkdir()
    (out / theirs).write_text("mine\n")
    for options in ([], ["--force"]):
        outcome = tether("run", config, "--out", out, *options)
        assert_one_sentence(outcome, 2, "is no folder of a run", "--out")
        assert names(out) == [theirs]
        assert (out / theirs).read_text() == "mine\n"


def test_a_configuration_in_the_folder_that_it_names_is_not_overwritten(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_couette(tmp_path, name="config.toml")
    assert_one_sentence(tether("run", "config.toml", "--out", ".", "--force"), 2, "is no folder of a run")
    assert (tmp_path / "config.toml").read_text() == COUETTE


def test_an_empty_folder_is_taken(tmp_path: Path) -> None:
    config, out = write_couette(tmp_path), tmp_path / "out"
    out.mkdir()
    assert tether("run", config, "--out", out, "--quiet").code == 0


def test_a_file_in_the_place_of_the_folder(tmp_path: Path) -> None:
    config = write_couette(tmp_path)
    assert_one_sentence(tether("run", config, "--out", config), 2, "is a file")
    assert_one_sentence(tether("run", config, "--out", config / "out"), 2, "cannot be written", "not a directory")
    assert config.read_text() == COUETTE


@pytest.mark.parametrize("method", ["mkdir", "exists"])
def test_a_folder_that_may_not_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, method: str) -> None:
    config = write_couette(tmp_path)

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, method, refuse)
    outcome = tether("run", config, "--out", tmp_path / "out")
    monkeypatch.undo()
    assert_one_sentence(outcome, 2, "out cannot be written (permission denied)", "--out")
    assert names(tmp_path) == ["couette.toml"]


@pytest.mark.parametrize("command", ["resume", "show", "plot"])
def test_a_folder_of_no_run(tmp_path: Path, command: str) -> None:
    assert_one_sentence(tether(command, tmp_path), 2, "is no folder of a run")
    assert_one_sentence(tether(command, tmp_path / "none"), 2, "is no folder of a run")
    assert names(tmp_path) == []


def test_results_that_are_not_there_yet(finished: Path) -> None:
    for name in ("summary.json", "series.nc"):
        (finished / name).unlink()
    assert_one_sentence(tether("show", finished), 2, "has no results", "tether resume")
    assert_one_sentence(tether("plot", finished), 2, "has no series", "tether resume")


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"dimension": 2}', '"text"'])
def test_a_damaged_summary(finished: Path, text: str) -> None:
    (finished / "summary.json").write_text(text)
    assert_one_sentence(tether("show", finished), 2, "summary.json is damaged", "run the configuration again")


@pytest.mark.parametrize("spoil", ["empty", "truncated", "text"])
def test_a_damaged_series(finished: Path, spoil: str) -> None:
    whole = (finished / "series.nc").read_bytes()
    (finished / "series.nc").write_bytes(
        {"empty": b"", "truncated": whole[: len(whole) // 2], "text": b"text\n"}[spoil]
    )
    assert_one_sentence(tether("plot", finished), 2, "series.nc is damaged")
