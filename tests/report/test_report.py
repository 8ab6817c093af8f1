"""The pages of runs and studies: complete, with the numbers that were measured; sentences where there is no page."""

from __future__ import annotations

import math
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pages import RUNS, Page
from small_runs import assert_one_sentence, summary, tether

from tether.plot.sweep import _WORDS
from tether.record import DATASETS, Record
from tether.report.charts.panel import Panel, Scale
from tether.report.citation import PAPER, TITLE, methods_of
from tether.report.run import _DRAWN
from tether.report.style import of_formulas, template
from tether.report.write import report
from tether.study.folder import StudyFolder
from tether.study.results import results_of

TITLES = {
    "flat": ["Results", "Suspension", "Over time", "Velocity", "Profiles across the gradient"],
    "solid": ["Results", "Suspension", "Over time", "Velocity"],
    "oscillatory": ["Results", "Suspension", "Over time", "Oscillation"],
    "stages": ["Results", "Suspension", "Over time", "Start-up and stop"],
    "driven": ["Results", "Suspension", "Over time", "Profiles across the gradient", "Stress across the gradient"],
    "rest": ["Results", "Suspension", "Over time", "Velocity", "Structure", "Diffusion", "Viscosity from fluctuations"],
}


def written(path: Path, *folders: Path) -> Page:
    """The page of these folders, which are no other test's."""
    return Page.read(report(folders, path))


@pytest.mark.parametrize("name", RUNS)
def test_the_page_of_a_run_is_complete(run_of: Callable[[str], Path], page_of: Callable[..., Path], name: str) -> None:
    folder = run_of(name)
    page = Page.read(page_of(name))
    assert page.loaded() == []
    titles = [each.text.split("\n")[0].strip() for each in page.root.all("h2")]
    titles = [re.sub(r" *(\d+ warnings?|no warnings)$", "", each) for each in titles]
    assert titles == [*TITLES[name], "Configuration", "How to cite"]
    assert len(page.views) == 1
    for figure in page.figures:
        assert any(value is not None for trace in figure["data"] for value in trace["x"])
        assert figure["layout"]["xaxis"]["title"]["text"]
        unit = figure["layout"]["yaxis"]["title"]["text"]
        assert "DPD units" in unit or re.search(r"fraction|strain|g\(r\)|autocorrelation|radian", unit), unit
    assert (folder / "config.toml").read_text().partition("\n")[2].strip() in page.text


def test_every_dataset_has_plots() -> None:
    assert {*_DRAWN, "green_kubo_integral"} == set(DATASETS)


@pytest.mark.parametrize("name", ["flat", "solid", "rest"])
def test_numbers_in_the_table_are_those_of_the_summary(
    run_of: Callable[[str], Path], page_of: Callable[..., Path], name: str
) -> None:
    folder = run_of(name)
    page = Page.read(page_of(name))
    rows = {row[0]: row[1:] for row in page.tables[0][1:]}
    found = summary(folder)
    means = {**found, **{f"kT {of}": entry for of, entry in found["temperature"].items()}}
    checked = 0
    for quantity, entry in means.items():
        words = re.sub(r"^temperature (?=configurational)", "kT ", quantity.replace("_", " "))
        if isinstance(entry, dict) and set(entry) == {"value", "error"} and entry["value"] is not None:
            value, error, _ = rows[words]
            digits = 0.51 * 10.0 ** (_exponent(value))
            assert float(value) == pytest.approx(entry["value"], abs=digits), quantity
            if entry["error"] is not None:
                assert float(error) == pytest.approx(entry["error"], rel=0.26), quantity  # of one digit, at worst
            checked += 1
    assert checked >= 5
    for warning in found["warnings"]:
        assert warning in page.text


def _exponent(number: str) -> int:
    """Of the last digit that is written."""
    mantissa, _, exponent = number.partition("e")
    return int(exponent or 0) - len(mantissa.partition(".")[2])


def test_plots_hold_what_was_measured(run_of: Callable[[str], Path], page_of: Callable[..., Path]) -> None:
    page = Page.read(page_of("driven"))
    profiles = xr.load_dataset(run_of("driven") / "profiles.nc", engine="h5netcdf")
    drawn = [trace for figure in page.figures for trace in figure["data"] if trace.get("name") == "solvent"]
    pairs = {(x, y) for trace in drawn for x, y in zip(trace["x"], trace["y"], strict=True)}
    for y, velocity in zip(profiles["y"].values, profiles["velocity_solvent"].values, strict=True):
        assert any(math.isclose(a, y, rel_tol=1e-5) and math.isclose(b, velocity, rel_tol=1e-5) for a, b in pairs)


def test_points_without_an_error_are_pale_and_named() -> None:
    panel = Panel("title", Scale("x"), Scale("y"))
    panel.points([1.0, 2.0, 3.0], [1.0, math.nan, 2.0], [0.1, 0.1, math.nan], "#000000", "series")
    data = panel.chart().figure["data"]
    assert [(trace["name"], trace["showlegend"]) for trace in data] == [
        ("series", True), ("", False), ("error not known", True),
    ]  # fmt: skip
    assert list(data[0]["error_y"]["array"]) == [0.1, 0.1]
    assert (list(data[0]["x"]), list(data[0]["y"])) == ([1.0, 2.0], [1.0, None])
    assert data[1]["opacity"] < 0.5


def test_light_plots_have_the_settings_of_the_pictures() -> None:
    light, dark = template(dark=False)["layout"], template(dark=True)["layout"]
    assert light["colorway"] == dark["colorway"]
    assert "DejaVu Sans" in light["font"]["family"]
    assert light["font"]["color"] != dark["font"]["color"]


@pytest.mark.parametrize("words", _WORDS.values())
def test_no_formula_is_left_in_what_pictures_of_studies_say(words: str) -> None:
    assert not re.search(r"[\\$_{}]", of_formulas(words)), of_formulas(words)


def test_several_runs_begin_with_a_comparison(run_of: Callable[[str], Path], page_of: Callable[..., Path]) -> None:
    page = Page.read(page_of("flat", "solid", "oscillatory"))
    headings, *rows = page.tables[0]
    assert [row[0] for row in rows] == ["flat", "solid", "oscillatory"]
    assert headings[:5] == ["run", "flow", "φ", "\N{GREEK SMALL LETTER GAMMA}\N{COMBINING DOT ABOVE}", "η"]
    viscosity = summary(run_of("flat"))["viscosity"]["value"]
    value = rows[0][4].split(" ")[0]
    assert float(value) == pytest.approx(viscosity, abs=0.51 * 10.0 ** _exponent(value))
    assert rows[2][4] == "", "no viscosity without a steady rate"
    shut = page.root.all("details")
    assert [each.all("h2")[0].text.split("\n")[0].strip().split(" ")[0] for each in shut if each.all("h2")] == [
        "flat", "solid", "oscillatory",
    ]  # fmt: skip
    assert len(page.views) == 3
    assert page.loaded() == []


def test_the_page_of_a_study(page_of: Callable[..., Path]) -> None:
    page = Page.read(page_of("study"))
    assert page.loaded() == []
    titles = [each.text.split("  ")[0].split("\n")[0].strip() for each in page.root.all("h2")]
    assert titles[0].startswith("Means over repeats")
    assert "Curves" in titles
    assert titles[-2:] == ["Configuration", "How to cite"]
    headings, *rows = page.tables[0]
    assert headings[:3] == ["shear rate", "count", "repeats"]
    assert len(rows) == 4
    drawn = [trace for figure in page.figures for trace in figure["data"] if trace["mode"] == "markers"]
    assert {trace["marker"]["symbol"] for trace in drawn} >= {"circle", "triangle-down", "circle-open"}
    assert all("error_y" in trace or trace.get("opacity", 1.0) < 1.0 for trace in drawn)


def test_what_a_study_draws_is_its_means(study_folder: Path, page_of: Callable[..., Path]) -> None:
    page = Page.read(page_of("study"))
    folder = StudyFolder.open(study_folder)
    means = results_of(folder.study(), folder).dataset
    drawn = {
        value
        for figure in page.figures
        for trace in figure["data"]
        if trace["mode"] == "markers"
        for value in trace["y"]
    }
    for name in ("viscosity", "relative_viscosity", "N1"):
        for value in np.ravel(means[f"{name}_mean"].values):
            assert any(each is not None and math.isclose(each, value, rel_tol=1e-5) for each in drawn), name


def test_a_study_without_a_finished_run_says_so(study_folder: Path, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(study_folder, tmp_path / "study"))
    shutil.rmtree(copy / "points")
    (copy / "points").mkdir()
    page = written(tmp_path / "page.html", copy)
    assert "No run has ended yet" in page.text
    assert "12 waiting" in page.text


def test_a_run_that_has_not_ended_shows_what_there_is(run_of: Callable[[str], Path], tmp_path: Path) -> None:
    copy = Path(shutil.copytree(run_of("flat"), tmp_path / "run"))
    (copy / "summary.json").unlink()
    page = written(tmp_path / "page.html", copy)
    assert "The run has not ended" in page.text
    assert len(page.figures) == 4, "series and velocity, without what observers found"
    (copy / "series.nc").unlink()
    (copy / "trajectory.gsd").unlink()
    page = written(tmp_path / "page.html", copy)
    assert "Nothing can be drawn" in page.text
    assert page.views == page.figures == []


def test_the_command_writes_a_page(
    run_of: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = tether("report", run_of("flat"))
    assert outcome.code == 0, outcome
    assert re.fullmatch(r"Wrote report\.html \(\d\.\d MB\)\n", outcome.out)
    assert (tmp_path / "report.html").stat().st_size < 8e6


def test_errors_are_sentences(run_of: Callable[[str], Path], tmp_path: Path) -> None:
    out = tmp_path / "page.html"
    copy = Path(shutil.copytree(run_of("flat"), tmp_path / "run"))
    (tmp_path / "empty").mkdir()
    for folder, part in (
        (tmp_path / "nowhere", "does not exist"), (copy / "config.toml", "is a file"),
        (tmp_path / "empty", "neither config.toml nor study.toml"),
    ):  # fmt: skip
        assert_one_sentence(tether("report", folder, "--out", out), 2, part)
    assert_one_sentence(tether("report", copy, "--out", tmp_path / "no" / "page.html"), 2, "cannot be written")
    for name in ("trajectory.gsd", "profiles.nc", "series.nc", "summary.json"):
        kept = (copy / name).read_bytes()
        (copy / name).write_bytes(b"spoiled")
        assert_one_sentence(tether("report", copy, "--out", out), 2, f"{name} is damaged")
        (copy / name).write_bytes(kept)
    (copy / "summary.json").write_text("{}")
    assert_one_sentence(tether("report", copy, "--out", out), 2, "summary.json is damaged")
    assert not out.exists()


def test_what_is_cited_is_what_the_project_says_and_the_run_used(run_of: Callable[[str], Path]) -> None:
    stated = (Path(__file__).parents[2] / "CITATION.cff").read_text(encoding="utf-8")
    assert f'title: "{TITLE}"' in stated
    assert f"doi: {PAPER.doi}" in stated
    used = {name: set(methods_of(Record.open(run_of(name)).configuration())) for name in ("flat", "driven", "rest")}
    assert "shear by moving periodic images" in used["flat"]
    assert "reverse Poiseuille flow" in used["driven"] - used["flat"]
    assert "viscosity from fluctuations" in used["rest"] - used["flat"]
    assert "shear by moving periodic images" not in used["rest"]
