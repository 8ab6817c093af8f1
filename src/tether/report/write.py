"""The page of runs and studies."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tether.config import Configuration
from tether.errors import InputError
from tether.estimate import Estimate
from tether.record import Record
from tether.report import run
from tether.report.citation import citation
from tether.report.page import Badge, Cell, Page, Section, Table, Text
from tether.report.study import StudyReport
from tether.study.folder import StudyFolder

MOST_BYTES = 6_000_000
"""Of all trajectories of a page: in base64, and beside Plotly and the view, this is a page of 14 MB."""

_COMPARED = {
    "viscosity": "\N{GREEK SMALL LETTER ETA}",
    "viscosity_pairwise": "\N{GREEK SMALL LETTER ETA}, pairs alone",
    "viscosity_green_kubo": "\N{GREEK SMALL LETTER ETA}, fluctuations",
    "viscosity_momentum_balance": "\N{GREEK SMALL LETTER ETA}, momentum balance",
    "storage_modulus": "G\N{PRIME}",
    "loss_modulus": "G\N{DOUBLE PRIME}",
    "N1": "N<sub>1</sub>",
    "N2": "N<sub>2</sub>",
    "pressure": "p",
}
"""Means that stand side by side, as far as a run has them."""


def report(folders: Sequence[Path], path: Path) -> Path:
    """Write the page of these folders, of runs and of studies, and return its path.

    A single run or study has the page to itself; several runs begin with a table that compares them. Raises InputError
    when a folder is of neither, holds what is damaged, or the page cannot be written.
    """
    if not folders:
        raise InputError("a report needs a folder", "none is given", "name one that tether run or tether study wrote")
    found = [_opened(folder) for folder in folders]
    records = [each for each in found if isinstance(each, Record)]
    studies = [StudyReport(each) for each in found if isinstance(each, StudyFolder)]
    if len(found) == 1:
        page = _page_of_run(records[0]) if records else _page_of_study(studies[0])
    else:
        page = _page_of_several(records, studies)
    configurations = [each.configuration() for each in records]
    configurations += [ensemble.configuration for each in studies for ensemble in each.study.all_ensembles]
    return page.add(_cited(configurations, studies)).write(path)


def _opened(folder: Path) -> Record | StudyFolder:
    if not folder.is_dir():
        what = "is a file" if folder.exists() else "does not exist"
        remedy = "name a folder that tether run or tether study wrote"
        raise InputError(f"{folder} {what}", "a report is of folders", remedy)
    if (folder / "study.toml").is_file():
        return StudyFolder.open(folder)
    if (folder / "config.toml").is_file():
        return Record.open(folder)
    raise InputError(
        f"{folder} is no folder of a run or a study", "it has neither config.toml nor study.toml",
        "name a folder that tether run or tether study wrote",
    )  # fmt: skip


def _cited(configurations: Sequence[Configuration], studies: Sequence[StudyReport]) -> Section:
    return citation(configurations, laws=any(study.has_fits for study in studies))


def _page_of_run(record: Record) -> Page:
    page = Page(record.folder.resolve().name, lead=run.title(record))
    return page.add(*run.sections(record, MOST_BYTES))


def _page_of_study(study: StudyReport) -> Page:
    return Page(study.folder.folder.resolve().name, lead=study.title).add(*study.sections())


def _page_of_several(records: Sequence[Record], studies: Sequence[StudyReport]) -> Page:
    """The runs' comparison, then each run and each study, shut until wanted."""
    counted = ((records, "run", "runs"), (studies, "study", "studies"))
    words = [f"{len(each)} {one if len(each) == 1 else many}" for each, one, many in counted if each]
    page = Page("Report", lead=" and ".join(words))
    if len(records) > 1:
        page.add(
            Section("Comparison", _compared(records), Text("Values in reduced (DPD) units, with standard errors."))
        )
    for record, name in zip(records, _names([record.folder for record in records]), strict=True):
        own = run.sections(record, MOST_BYTES // len(records))
        page.add(Section(name, Text(run.title(record)), *own, badges=run.badges(record), shut=True))
    for study, name in zip(studies, _names([study.folder.folder for study in studies]), strict=True):
        page.add(Section(name, Text(study.title), *study.sections(), badges=study.badges, shut=len(studies) > 1))
    return page


def _names(folders: Sequence[Path]) -> list[str]:
    """The folders' names, or with as much of their paths as tells them apart."""
    whole = [folder.resolve() for folder in folders]
    for parts in range(1, max(len(path.parts) for path in whole) if whole else 1):
        names = ["/".join(path.parts[-parts:]) for path in whole]
        if len(set(names)) == len(set(whole)):
            return names
    return [str(path) for path in whole]


def _compared(records: Sequence[Record]) -> Table:
    """A row for each run; columns that no run has are left out."""
    summaries = [record.summary() if record.summary_path.is_file() else {} for record in records]
    shown = {name: words for name, words in _COMPARED.items() if any(summary.get(name) for summary in summaries)}
    rows: list[list[Cell]] = []
    for record, name, summary in zip(records, _names([record.folder for record in records]), summaries, strict=True):
        configuration = record.configuration()
        rate = configuration.flow.shear_rate
        warned: Badge = run.badges(record)[0]
        rows.append([
            name, f"{configuration.flow.kind}, {configuration.dimension}D", f"{configuration.volume_fraction:.4f}",
            f"{rate:g}" if rate else "", *(_entry(summary.get(quantity)) for quantity in shown), warned,
        ])  # fmt: skip
    fraction, rate_words = "\N{GREEK SMALL LETTER PHI}", "\N{GREEK SMALL LETTER GAMMA}\N{COMBINING DOT ABOVE}"
    return Table.of(["run", "flow", fraction, rate_words, *shown.values(), ""], rows)


def _entry(entry: Any) -> str:
    """Value and error of a summary, as in its table."""
    if not isinstance(entry, dict) or entry.get("value") is None:
        return ""
    value, error = entry["value"], entry["error"]
    if error is None:
        return f"{value:.3g} (no error)"
    return str(Estimate(value, error, 0, 1.0, converged=True)).replace("+-", "\N{PLUS-MINUS SIGN}")
