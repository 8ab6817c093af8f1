"""Every table and figure of the paper at the size that takes seconds: it runs, judges every claim, and is drawn."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_runs import tether

from tether.paper import Exhibit, Verdict, exhibits
from tether.study.study import Study

PAPER = Path(__file__).parents[2] / "paper"
EXHIBITS = exhibits(PAPER)

NAMES = {"table1", "table2", *(f"fig{number:02d}" for number in range(1, 20))}
"""What the paper has; sections with numbers of their own come on top."""


@pytest.fixture(scope="module")
def smoke(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with what came out of all of them, and the page."""
    folder = tmp_path_factory.mktemp("paper")
    outcome = tether("paper", "all", "--smoke", "--report", "--paper", PAPER, "--runs", folder, "--quiet")
    assert outcome.code == 0, outcome
    return folder / "smoke-results"


def test_there_is_every_table_and_every_figure() -> None:
    assert {exhibit.name for exhibit in EXHIBITS} >= NAMES


@pytest.mark.parametrize("exhibit", EXHIBITS, ids=lambda exhibit: exhibit.name)
def test_an_exhibit_runs_and_is_drawn(exhibit: Exhibit, smoke: Path) -> None:
    findings, made = exhibit.kept(smoke / exhibit.name, "smoke")
    assert findings.claims
    assert all(claim.text and claim.source and claim.rule for claim in findings.claims)
    assert made["command"] == "tether paper all --smoke"
    assert (smoke / exhibit.name / "README.md").read_text("utf-8").startswith(f"# {exhibit.title}\n")
    if exhibit.name.startswith("fig"):
        assert (smoke / exhibit.name / f"{exhibit.name}.png").stat().st_size > 10_000


def test_the_page_has_all_of_them(smoke: Path) -> None:
    page = (smoke / "report-smoke.html").read_text("utf-8")
    for exhibit in EXHIBITS:
        assert exhibit.title.split(":")[0] in page


@pytest.mark.parametrize("exhibit", EXHIBITS, ids=lambda exhibit: exhibit.name)
def test_every_size_has_the_same_studies(exhibit: Exhibit) -> None:
    parts = {size: set(exhibit.studies(size)) for size in ("smoke", "quick", "full")}
    assert parts["smoke"] <= parts["quick"]
    assert parts["quick"] <= parts["full"]


@pytest.mark.parametrize("exhibit", EXHIBITS, ids=lambda exhibit: exhibit.name)
def test_what_is_committed_is_of_this_exhibit(exhibit: Exhibit) -> None:
    """Made at the committed size by its own claims, small, and with a verdict on each."""
    findings, made = exhibit.kept(exhibit.folder, "quick")
    assert made["size"] == "quick"
    assert all(isinstance(claim.verdict, Verdict) for claim in findings.claims)
    assert sum(path.stat().st_size for path in exhibit.folder.iterdir()) < 1_000_000


def test_studies_are_read_as_they_stand() -> None:
    for path in PAPER.glob("*/*.toml"):
        assert Study.read(path).points
