"""Exhibits: a small one of our own is run, kept, drawn again, and listed; wrong ones are answered in a sentence."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from small_runs import COUETTE, tether

from tether.errors import InputError
from tether.paper import Panel, Series, draw_panels, exhibits
from tether.paper.panel import plotly_figure

EXHIBIT = '''\
"""Fig. 1: viscosity against shear rate.

The paper says that it is positive.
"""

import pandas as pd

from tether.estimate import Estimate
from tether.paper import Comparison, Findings, Panel, Series, judged


def evaluate(parts):
    means = parts[""].results.means
    table = means[["shear_rate", "pressure", "pressure_error"]]
    numbers = [Estimate(row.pressure, row.pressure_error, 0, 1.0, True) for row in table.itertuples()]
    claim = judged("pressure is positive", "section 1", "p > 0", [Comparison(each, low=0.0) for each in numbers])
    return Findings({"pressure": table}, [claim], ["series of others: not available"])


def panels(findings):
    table = findings.tables["pressure"]
    series = Series("p", table["shear_rate"], table["pressure"], table["pressure_error"])
    return [Panel("Pressure", "shear rate (DPD units)", "pressure (DPD units)", [series])]
'''
STUDY = 'base = "../base.toml"\n[sweep]\nflow.shear_rate = [0.5, 1.0]\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    paper = tmp_path / "paper"
    (paper / "fig1").mkdir(parents=True)
    (paper / "base.toml").write_text(COUETTE.replace("steps = 200", "steps = 4000"), encoding="utf-8")
    (paper / "fig1" / "exhibit.py").write_text(EXHIBIT, encoding="utf-8")
    for size in ("smoke", "quick"):
        (paper / "fig1" / f"{size}.toml").write_text(STUDY, encoding="utf-8")
    return paper


def test_an_exhibit_is_run_kept_and_listed(folder: Path, tmp_path: Path) -> None:
    options = ("--paper", folder, "--runs", tmp_path / "runs", "--workers", 1)
    outcome = tether("paper", "fig1", *options)
    assert outcome.code == 0, outcome
    assert "pressure is positive" in outcome.out
    kept = json.loads((folder / "fig1" / "quick.json").read_text(encoding="utf-8"))
    assert kept["claims"][0]["verdict"] == "holds"
    assert kept["made"]["command"] == "tether paper fig1 --quick"
    readme = (folder / "fig1" / "README.md").read_text(encoding="utf-8")
    assert readme.startswith("# Fig. 1: viscosity against shear rate\n\nThe paper says")
    assert "| pressure is positive | section 1 |" in readme
    assert (folder / "fig1" / "fig1.png").is_file()
    assert len(list((tmp_path / "runs" / "points").iterdir())) == 2
    before = (folder / "fig1" / "quick-pressure.csv").read_bytes()
    assert tether("paper", "all", *options, "--quiet").code == 0  # nothing is run again, and the same comes out
    assert (folder / "fig1" / "quick-pressure.csv").read_bytes() == before
    (exhibit,) = exhibits(folder)
    findings, _ = exhibit.kept(folder / "fig1", "quick")
    assert exhibit.panels(findings)[0].title == "Pressure"
    listed = tether("paper", *options)
    assert "1 claims" in listed.out


def test_smoke_leaves_what_is_kept_alone(folder: Path, tmp_path: Path) -> None:
    outcome = tether("paper", "fig1", "--smoke", "--paper", folder, "--runs", tmp_path / "runs", "--workers", 1)
    assert outcome.code == 0, outcome
    assert (tmp_path / "runs" / "smoke-results" / "fig1" / "smoke.json").is_file()
    assert not (folder / "fig1" / "README.md").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("fig99",), "fig99 is no table or figure here (there are fig1); give one of these"),
        (
            ("fig1", "--quick", "--full"),
            "--quick, --full and --smoke exclude each other (each is a size); give one of them",
        ),
    ],
)
def test_wrong_input_is_answered_in_a_sentence(arguments: tuple[str, ...], said: str, folder: Path) -> None:
    outcome = tether("paper", *arguments, "--paper", folder)
    assert outcome.code == 2
    assert outcome.err.strip() == f"error: {said}"


def test_a_folder_without_exhibits(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no tables and figures"):
        exhibits(tmp_path)


def test_panels_are_drawn_for_print_and_for_the_screen(tmp_path: Path) -> None:
    x = np.array([0.1, 1.0, 10.0])
    series = [
        Series("measured", x, [1.0, np.nan, 3.0], [0.1, 0.1, np.nan]),
        Series(r"$\phi_m$", x, x, kind="dashed"),
        Series("smooth", x, x, 0.1 * x, kind="band"),
    ]
    panel = Panel("Title", "x", r"$\eta$ (DPD units)", series, log_x=True, log_y=True, levels=[(1.0, "one")])
    paths = draw_panels([panel, panel, panel], tmp_path / "picture")
    assert [path.suffix for path in paths] == [".png", ".svg"]
    figure = plotly_figure(panel)
    assert figure["data"][0]["y"] == [1.0, None, 3.0]
    assert figure["data"][0]["error_y"]["array"] == [0.1, 0.1, None]
    assert figure["layout"]["xaxis"]["type"] == "log"
    json.dumps(figure, allow_nan=False)
