"""`tether study` and its commands: what is wrong is one sentence, and each command says what it should."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from small_runs import assert_one_sentence, names, tether
from small_studies import InThisThread, assert_same_study, copy_of, crew_of, study, write_study

from tether.study import run_study

BASE = 'base = "couette.toml"\n'
SMALL = BASE + "repeats = 2\n[sweep]\nflow.shear_rate = [0.5, 1.0]\n"
RELATIVE = BASE + "relative = true\n[sweep]\nflow.shear_rate = [0.5, 1.0]\nbodies.0.count = [2, 3]\n"


def rows(path: Path) -> list[dict[str, str]]:
    """A table."""
    return list(csv.DictReader(path.read_text().splitlines()))


# What is wrong with a study: its lines after the first, the line and key at fault, why, and what to do.
WRONG = [
    # the table [sweep]
    ("[sweep]\nflow.shear_rate = 1.0", "line 3: flow.shear_rate = 1.0 is not a list", "write [1.0] and more values"),
    ("[sweep]\nflow.shear_rate = []", "line 3: flow.shear_rate has no values", "give some"),
    ("[sweep]\nflow.shear_rate = [1, 2, 1.0]", "line 3: flow.shear_rate has 1.0 twice", "take one out"),
    (
        "[sweep]\nflow.shear_rate = [\n 1,\n 2,\n 1.0]",
        "line 6: flow.shear_rate has 1.0 twice (both would be the same point)",
        "take one out",
    ),
    ("[sweep]\nflow.shear_rte = [1, 2]", "line 3, at shear_rte = 1: flow.shear_rte is not a key", "mean shear_rate?"),
    ("[sweep]\nflow = {}", "line 3: flow = {} is no range", "write {linspace = [first, last, number]}"),
    ("[sweep]\nbodies.4.count = [1, 2]", "line 3: bodies.4 does not exist (there are 1", "the number of one"),
    ("[sweep]\nseed = [1, 2]", "line 3: seed cannot be swept (the seeds of repeats are made", "give repeats instead"),
    (
        "[sweep]\nflow.shear_rate = {linspace = [1, 2, 1000]}\nfluid.temperature = {linspace = [1, 2, 1000]}",
        "line 2: sweep makes 1000000 combinations (a study has at most 100000)",
        "let keys change together in [[sweep.zip]]",
    ),
    ("sweep = 3", "line 2: sweep = 3 is a whole number, not a table", "give a table"),
    (
        '[sweep]\nflow = [{kind = "rest"}]\n[[sweep.zip]]\nflow.shear_rate = [1, 2]',
        "line 5: flow.shear_rate is swept beside flow (one would replace what the other one sets)",
        "sweep one of them",
    ),
    # ranges
    (
        "[sweep]\nflow.shear_rate = {linspac = [1, 2, 3]}",
        "line 3: flow.shear_rate = {linspac = [1, 2, 3]} is no range (a range is told by its ends and the number of",
        "write {linspace = [first, last, number]}",
    ),
    ("[sweep]\nflow.shear_rate = {logspace = [1, 2]}", "is no range", "write {logspace = [first, last, number]}"),
    ("[sweep]\nflow.shear_rate = {linspace = [0, inf, 3]}", "line 3", "is no range"),
    ("[sweep]\nflow.shear_rate = {linspace = [1, 2, 3], logspace = [1, 2, 3]}", "line 3", "is no range"),
    ("[sweep]\nflow.shear_rate = {linspace = [1, 2, 1]}", "asks for 1 values (a range has from 2 to", "another number"),
    ("[sweep]\nflow.shear_rate = {linspace = [1, 1, 3]}", "line 3: flow.shear_rate ends where it begins", "two ends"),
    (
        "[sweep]\nflow.shear_rate = {logspace = [0, 1, 3]}",
        "line 3: flow.shear_rate goes from 0 to 1 (a logarithmic range has ends of one sign",
        "use linspace",
    ),
    # keys that change together
    (
        "[[sweep.zip]]\nflow.shear_rate = [1, 2]\nbodies.0.count = [1, 2, 3]",
        "line 4: bodies.0.count has 3 values and flow.shear_rate has 2",
        "give lists of the same length",
    ),
    ("[sweep]\nzip = 3", "line 3: sweep.zip holds no tables of keys", "write [[sweep.zip]]"),
    ("[sweep]\nzip = [{}]", "line 3: sweep.zip holds no tables of keys", "write [[sweep.zip]]"),
    (
        "[[sweep.zip]]\nflow.shear_rate = [1, 1]\nbodies.0.count = [2, 2]",
        "line 3: flow.shear_rate and the keys beside it have [1, 2] twice",
        "take one out",
    ),
    # values that the configuration refuses
    (
        "[sweep]\nfluid.temperature = [\n 1.0,\n -1.0]",
        "line 5, at temperature = -1: fluid.temperature = -1.0 must be greater than 0 (thermal energy kT",
        "give a number greater than 0",
    ),
    ('[sweep]\nfluid.temperature = [1.0, "x"]', 'fluid.temperature = "x" is text, not a number', "give a number"),
    ("[sweep]\nflow.shear_rate = [nan, 1.0]", "at shear_rate = nan: flow.shear_rate = nan is not a finite", "give a"),
    ("[sweep]\nbox.size = [[4.0, 4.0], [2.0, 2.0]]", "line 3, at size = [2.0, 2.0]", "shorter than 3 cutoffs"),
    ('[set]\nflow.kind = "poiseuille"', "line 3: flow.force is missing", "give force"),
    ("[set]\nfluid.temprature = 1.0", "line 3: fluid.temprature is not a key", "did you mean temperature?"),
    (
        "[set]\nbodies.0.volume_fraction = 0.1\n[sweep]\nbodies.0.count = [1, 2]",
        "bodies.0.volume_fraction = 0.1 is given beside count",
        "give exactly one",
    ),
    ("set = 3", "line 2: set = 3 is a whole number, not a table", "give a table"),
    # what else a study has
    ("repeats = 0", "line 2: repeats = 0 must be at least 1", "give 1 or more"),
    ("repeat = 2", "line 2: repeat is not a key of the top level", "did you mean repeats?"),
    ("stop_when = {viscosity = 0.1}", "line 2: stop_when has one run to look at", "give repeats"),
    ("repeats = 2\nstop_when = {viscosty = 0.1}", "line 3: stop_when.viscosty is not a key", "mean viscosity?"),
    ("repeats = 2\nstop_when = {}", "line 3: stop_when", "give {viscosity = 0.01}"),
    (
        'relative = true\n[set]\nflow = {kind = "rest"}',
        "line 2: relative = true needs bodies and a steady shear flow (it divides",
        "take it out",
    ),
    (
        "[sweep]\nbodies.0.count = [2, 3]\noutput.checkpoint = [10, 20]",
        "line 2: count = 2, checkpoint = 20 and count = 2, checkpoint = 10 are the same run",
        "take one out of the sweep",
    ),
    ("[sweep", 'line 2: "[sweep" is not TOML', "write [table]"),
]


@pytest.mark.parametrize(("lines", "place", "remedy"), WRONG)
def test_what_is_wrong_with_a_study_is_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lines: str, place: str, remedy: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write_study(tmp_path, BASE + lines + "\n")
    before, _, after = place.partition("line")
    parts = [f"study.toml, line{after}"] if not before and after else [place]
    assert_one_sentence(tether("study", "study.toml"), 2, "study.toml, line ", *parts, remedy)
    assert names(tmp_path) == ["couette.toml", "study.toml"]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "[sweep]\nflow.shear_rate = [1]\n",
            'study.toml: base is missing (the configuration that is varied); give base, for example base = "couette.'
            'toml"',
        ),
        ("base = 3\n", "study.toml, line 1: base = 3 is neither the path of a configuration nor a table (a study"),
        ('base = "no.toml"\n', "study.toml, line 1: no.toml cannot be read (no such file or directory); look at the"),
        ('base = "study.toml"\n', "study.toml, line 1: box is missing (the periodic box); add a table [box] with"),
    ],
)
def test_a_base_that_is_none_is_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, sentence: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write_study(tmp_path, text)
    outcome = tether("study", "study.toml")
    assert_one_sentence(outcome, 2)
    assert outcome.err.startswith(f"error: {sentence}")


def test_a_mistake_in_the_base_is_shown_in_the_base(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_study(tmp_path, SMALL)
    base = tmp_path / "couette.toml"
    base.write_text(base.read_text().replace("temperature = 1.0", "temperature = -1.0"))
    assert_one_sentence(tether("study", "study.toml"), 2, "couette.toml, line 7", "fluid.temperature = -1.0 must be")


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["study", "none.toml"], ["none.toml cannot be read (no such file or directory)"]),
        (
            ["study", "study.toml", "--out", "couette.toml"],
            ["couette.toml is a file (a study writes a folder); choose"],
        ),
        (["study", "study.toml", "--out", "mine"], ["mine exists and is no folder of a study (what it holds is left"]),
        (["study", "study.toml", "--set", "fluid.temprature=2"], ["--set fluid.temprature=2", "did you mean"]),
        (["study", "study.toml", "--set", "fluid.temperature"], ["--set fluid.temperature", "section.key=value"]),
        (["study", "status", "mine"], ["mine is no folder of a study (it has no study.toml of tether); name one"]),
        (["study", "collect", "none"], ["none is no folder of a study"]),
        (["study", "plot", "couette.toml"], ["couette.toml is no folder of a study"]),
        (
            ["study", "run-point", "study.toml", "4"],
            ["there is no run 4 (this study has 4 runs, numbered from 0); give"],
        ),
    ],
)
def test_wrong_arguments_are_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], parts: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_study(tmp_path, SMALL)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("precious")
    assert_one_sentence(tether(*arguments), 2, *parts)
    assert names(tmp_path) == ["couette.toml", "mine", "study.toml"]
    assert names(tmp_path / "mine") == ["thesis.tex"]


# Commands


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to be in, where runs are done in this process: others take seconds to start."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tether.cli.study.processes", lambda _: crew_of(InThisThread())())
    return tmp_path


@pytest.fixture(scope="module")
def ended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a study that has ended, not to be changed."""
    folder = tmp_path_factory.mktemp("ended")
    run_study(study(folder, RELATIVE), folder / "study", InThisThread())
    return folder / "study"


def test_the_command_line_runs_a_study_and_prints_its_means(ended: Path, tmp_path: Path) -> None:
    out = tmp_path / "study"
    outcome = tether("study", write_study(tmp_path, RELATIVE), "--out", out, "--workers", 1)
    assert outcome.code == 0, outcome
    assert_same_study(out, ended)
    assert "eta_r" in outcome.out
    assert f"Results: {out / 'results.csv'}, " in outcome.out
    again = tether("study", "run", out, "--quiet")  # a folder will do, and there is nothing left
    assert (again.code, again.out, again.err) == (0, "", "")
    assert_same_study(out, ended)


def test_runs_of_a_job_array_are_the_study(ended: Path, tmp_path: Path) -> None:
    path, out = write_study(tmp_path, RELATIVE), tmp_path / "study"
    assert tether("study", "count", path).out == "6\n"
    for number in reversed(range(6)):
        outcome = tether("study", "run-point", path, number, "--out", out)
        assert (outcome.code, outcome.out, outcome.err) == (0, "", "")
    assert "6 done" in tether("study", "status", out).out
    assert tether("study", "collect", out).code == 0
    assert_same_study(out, ended)
    assert tether("study", "run-point", out, 3).code == 0, "done already"


def test_a_run_that_fails_is_said_by_all_commands(here: Path) -> None:
    """The placement fails in one setting, and nothing but the plain fluid is done where it fails in all."""
    text = BASE + "relative = true\n[sweep]\nbodies.0.count = [{}]\n"
    write_study(here, text.format("3, 5000"), "some.toml")
    outcome = tether("study", "some.toml", "--quiet")
    assert_one_sentence(outcome, 1, "error: 1 of 3 runs failed; the first one: count = 5000, repeat 0: 5000 bodies")
    assert [row["role"] for row in rows(Path("some/results.csv"))] == ["suspension", "plain_fluid"]
    status = tether("study", "status", "some")
    assert "2 done, 1 failed" in status.out
    assert "failed: count = 5000, repeat 0: 5000 bodies cannot be placed" in status.out
    number = 1
    failed = tether("study", "run-point", "some.toml", number)
    assert_one_sentence(failed, 1, "error: count = 5000, repeat 0: 5000 bodies cannot be placed")

    write_study(here, text.format("5000"), "none.toml")
    outcome = tether("study", "none.toml")
    assert outcome.code == 1
    assert outcome.err == "error: 1 of 2 runs failed; the first one: " + outcome.err.partition("the first one: ")[2]
    assert "5000 bodies cannot be placed" in outcome.err
    assert tether("study", "collect", "none").code == 0
    assert_one_sentence(tether("study", "plot", "none"), 2, "nothing to draw")


def test_a_dry_run_prints_the_plan_and_makes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_study(tmp_path, RELATIVE)
    outcome = tether("study", "study.toml", "--dry-run")
    assert outcome.code == 0, outcome
    assert "6 runs, 6 to do" in outcome.out
    assert "from half a second of one of them on this machine" in outcome.out
    for label in ("shear_rate = 0.5, count = 3", "plain fluid, shear rate 1"):
        assert label in outcome.out
    assert names(tmp_path) == ["couette.toml", "study.toml"]


def test_a_dry_run_knows_what_is_done(ended: Path) -> None:
    outcome = tether("study", ended, "--dry-run")
    assert "6 runs, 0 to do" in outcome.out
    assert "from the runs that are done" in outcome.out


def test_status_tells_where_each_setting_stands(ended: Path, here: Path) -> None:
    out = copy_of(ended, here / "study")
    points = sorted((out / "points").iterdir())
    (points[0] / "summary.json").unlink()
    (points[1] / "summary.json").unlink()
    (points[1] / "progress.json").unlink()
    outcome = tether("study", "status", out)
    assert outcome.code == 0
    assert "4 done, 1 interrupted, 1 waiting" in outcome.out
    assert "shear_rate = 0.5, count = 2" in outcome.out
    fewer = write_study(here, RELATIVE.replace("[2, 3]", "[2]"), "less.toml")
    assert tether("study", fewer, "--out", out, "--quiet").code == 0
    assert "2 more in" in tether("study", "status", out).out, "what is not asked for any more is kept"


def test_collect_gathers_what_is_done_so_far(ended: Path, tmp_path: Path) -> None:
    out = copy_of(ended, tmp_path / "study")
    for path in (out / "points").iterdir():
        if json.loads((path / "summary.json").read_text())["shear_rate"] == 1.0:
            (path / "summary.json").unlink()
    for name in ("results.csv", "means.csv"):
        (out / name).unlink()
    assert tether("study", "collect", out).code == 0
    assert len(rows(out / "results.csv")) == 3
    assert len(rows(out / "means.csv")) == 2


def test_pictures_are_drawn_of_what_is_done(ended: Path, tmp_path: Path) -> None:
    out = copy_of(ended, tmp_path / "study")
    outcome = tether("study", "plot", out)
    assert outcome.code == 0, outcome
    paths = [Path(line) for line in outcome.out.splitlines()]
    assert paths
    assert all(path.is_file() for path in paths)
    outcome = tether("study", "plot", out, "--quantity", "pressure", "--against", "flow.shear_rate")
    assert outcome.code == 0, outcome
    assert (out / "pressure-shear_rate.png").is_file()
    assert_one_sentence(tether("study", "plot", out, "--quantity", "pressure"), 2, "go together", "give both")


def test_a_spoiled_summary_is_one_sentence(ended: Path, tmp_path: Path) -> None:
    out = copy_of(ended, tmp_path / "study")
    path = min((out / "points").iterdir()) / "summary.json"
    path.write_text("{")
    for command in (["status", out], ["collect", out], [out]):
        assert_one_sentence(tether("study", *command), 2, f"{path} is damaged")


def test_options_of_the_study_change_its_base(here: Path) -> None:
    write_study(here, SMALL)
    changes = ["--set", "run.steps=50", "--set", "bodies.0.count=2"]
    outcome = tether("study", "study.toml", *changes, "--quiet")
    assert outcome.code == 0, outcome
    assert {(row["steps"], row["bodies"]) for row in rows(Path("study/results.csv"))} == {("50", "2")}
    assert_one_sentence(tether("study", "study", *changes), 2, "--set needs the study's file")
