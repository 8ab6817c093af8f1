"""One page with the exhibits: verdicts first, then each with its figure, tables and claims."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import pandas as pd

from tether.paper.claim import Claim, Verdict
from tether.paper.exhibit import Exhibit, Findings, Size
from tether.paper.panel import plotly_figure
from tether.report.page import Badge, Cell, Chart, Code, Image, Page, Section, Table, Text

_MOST_ROWS = 40
"""Of a table on the page; the whole one is in the file beside it."""

_LOOKS: dict[Verdict, Literal["good", "bad", "unsure", "plain"]] = {
    Verdict.HOLDS: "good",
    Verdict.REMARK: "good",
    Verdict.FAILS: "bad",
    Verdict.UNDECIDED: "unsure",
}


def write_page(wanted: Sequence[Exhibit], folder: Path, size: Size) -> Path:
    """Write folder/report-SIZE.html from what has been kept there, and return its path."""
    kept = {exhibit: exhibit.kept(folder / exhibit.name, size) for exhibit in wanted}
    counts = Counter(claim.verdict for findings, _ in kept.values() for claim in findings.claims)
    page = Page(
        "The paper, reproduced",
        "Phan-Thien, Mai-Duy & Khoo, J. Rheol. 58, 839 (2014), doi 10.1122/1.4874679: what holds, and what does not",
    )
    overview = Section(
        "Verdicts", *(Badge(f"{counts[verdict]} {verdict}", _LOOKS[verdict]) for verdict in Verdict),
        Text(_RULES), Table.of(("", "", *map(str, Verdict)), [_row(each, kept[each][0]) for each in wanted]),
    )  # fmt: skip
    page.add(overview)
    for exhibit, (findings, made) in kept.items():
        section = Section(exhibit.title, badges=_badges(findings.claims), shut=len(wanted) > 1)
        if exhibit.text:
            section.add(Text(exhibit.text))
        section.add(*_figure(exhibit, findings, folder), _claims(findings.claims))
        section.add(*(Text(note) for note in findings.notes))
        section.add(*(_table(name, table) for name, table in findings.tables.items()))
        section.add(
            *(Code(path.read_text("utf-8"), path.name) for path in sorted(exhibit.folder.glob(f"{size}*.toml")))
        )
        section.add(
            Text(
                f"Made by `{made['command']}`, tether {made['version']}, {made['date']}: {made['runs']} runs, "
                f"{made['core_hours']:.2g} core-hours; seeds {made['seeds']}."
            )
        )
        page.add(section)
    return page.write(folder / f"report-{size}.html")


_RULES = """\
Each claim is judged by a rule on numbers and their errors: it *holds* where the numbers with their errors lie inside
the interval that the claim means, *does not hold* where they lie outside, and is *undecided* where they reach over a
bound. Several numbers behind one claim have wider errors, so that all of them go wrong by chance in 5 of 100 cases.
Errors are one standard error."""


def _row(exhibit: Exhibit, findings: Findings) -> list[Cell]:
    counts = Counter(claim.verdict for claim in findings.claims)
    return [exhibit.name, exhibit.title, *(str(counts[verdict]) if counts[verdict] else "" for verdict in Verdict)]


def _badges(claims: Sequence[Claim]) -> list[Badge]:
    counts = Counter(claim.verdict for claim in claims)
    return [Badge(f"{counts[verdict]} {verdict}", _LOOKS[verdict]) for verdict in Verdict if counts[verdict]]


def _figure(exhibit: Exhibit, findings: Findings, folder: Path) -> list[Chart | Image]:
    """Interactive where it is told by panels, else the picture."""
    panels = exhibit.panels(findings)
    if panels:
        return [
            Chart(plotly_figure(panel), alt=f"{exhibit.title}: {panel.title}", title=panel.plain_title)
            for panel in panels
        ]
    picture = folder / exhibit.name / f"{exhibit.name}.png"
    return [Image(picture, alt=exhibit.title)] if picture.is_file() else []


def _claims(claims: Sequence[Claim]) -> Table:
    rows: list[list[Cell]] = []
    for claim in claims:
        text = f"{claim.text} ({claim.source})"
        why = claim.rule + (f". {claim.remark}" if claim.remark else "")
        if claim.verdict is Verdict.UNDECIDED and claim.core_hours is not None:
            why += f". {claim.core_hours:.2g} core-hours would decide it"
        rows.append([text, claim.measured, Badge(str(claim.verdict), _LOOKS[claim.verdict]), why])
    return Table(("the paper", "measured", "verdict", "rule"), [rows])


def _table(name: str, table: pd.DataFrame) -> Section:
    rows: list[list[Cell]] = [
        [_shown(value) for value in row] for row in table.head(_MOST_ROWS).itertuples(index=False)
    ]
    more = f" (the first {_MOST_ROWS} of {len(table)} rows)" if len(table) > _MOST_ROWS else ""
    words = f"Numbers: {name.replace('_', ' ').replace('-', ' ')}{more}"
    return Section(words, Table.of([str(column) for column in table.columns], rows), shut=True)


def _shown(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.5g}" if math.isfinite(value) else ""
    return str(value)
