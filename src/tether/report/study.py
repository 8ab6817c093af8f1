"""Sections on a study: means, fits, curves, and what was asked."""

from __future__ import annotations

import math
from typing import Literal

import pandas as pd
import xarray as xr

from tether.cli import study_tables
from tether.estimate import Estimate
from tether.plot.study_pictures import fits_of
from tether.plot.sweep import axis_label, quantities
from tether.report.charts.panel import told
from tether.report.charts.study import study_charts
from tether.report.page import Badge, Cell, Section, Table, Text, Warnings
from tether.report.run import configuration
from tether.report.style import of_formulas
from tether.study.folder import StudyFolder
from tether.study.ledger import Ledger
from tether.study.results import Results, results_of

_KINDS: dict[str, Literal["good", "bad", "unsure", "plain"]] = {
    "done": "good",
    "failed": "bad",
    "interrupted": "unsure",
    "running": "plain",
    "waiting": "plain",
}


class StudyReport:
    """A study's folder and what its finished runs have found. Raises InputError when it is damaged."""

    def __init__(self, folder: StudyFolder) -> None:
        self.folder = folder
        self.study = folder.study()
        self._ledger = Ledger(self.study, folder)
        self._results: Results = results_of(self.study, folder)
        self._fits = fits_of(self._results.dataset) if len(self._results.means) else []
        self.has_fits = any(row["law"] in ("krieger_dougherty", "quemada") and not row["remark"] for row in self._fits)

    @property
    def title(self) -> str:
        """What is swept, and how many runs there are."""
        keys = [name for axis in self.study.axes for name in axis.names]
        runs = len(self._ledger.points)
        return f"{runs} runs" + (f": {', '.join(keys)}" if keys else "")

    @property
    def badges(self) -> list[Badge]:
        """How many runs are done, and how many are not."""
        kinds = [self._ledger.states[point.identity].kind for point in self._ledger.points]
        counts = {kind: kinds.count(kind) for kind in _KINDS if kind in kinds}
        return [Badge(f"{count} {kind}", _KINDS[kind]) for kind, count in counts.items()]

    def sections(self) -> list[Section]:
        """All of it but how to cite it."""
        section = Section("Means over repeats", badges=self.badges)
        made = [section]
        if len(self._results.means):
            keys = [name for axis in self.study.axes for name in axis.names]
            section.add(Table.like(study_tables.means(self._results.means, keys)))
            if self._results.disagreement:
                section.add(Warnings([f"{self._results.disagreement}."]))
            section.add(Text("Values in reduced (DPD) units, with standard errors. `results.csv` has every run."))
            section.add(Section("All means", _all_means(self._results.means, self._results.dataset, keys), shut=True))
            charts = study_charts(self._results.dataset)
            if charts:
                made.append(Section("Curves", *charts))
            if self.has_fits:
                made.append(Section("Fitted laws", Table.like(study_tables.fits(self._fits, keys))))
        else:
            section.add(Text("No run has ended yet; `tether study` goes on with it."))
        return [*made, configuration(self.study.to_toml())]


def _all_means(means: pd.DataFrame, dataset: xr.Dataset, keys: list[str]) -> Table:
    """Whatever has a mean and an error, a row a setting."""
    shown = [name for name in quantities(dataset) if name in means and f"{name}_error" in means]
    rows: list[list[Cell]] = []
    for _, row in means.iterrows():
        settings = [f"{row[key]:g}" if isinstance(row[key], float) else str(row[key]) for key in keys]
        rows.append([*settings, *(_estimate(row[name], row[f"{name}_error"]) for name in shown)])
    headings = [key.split(".")[-1].replace("_", " ") for key in keys]
    return Table.of([*headings, *(of_formulas(axis_label(dataset, name)) for name in shown)], rows)


def _estimate(value: float, error: float) -> str:
    """Value and error, or nothing where there is no value."""
    if not math.isfinite(value):
        return ""
    if not math.isfinite(error):
        return f"{value:.3g} \N{PLUS-MINUS SIGN} ?"
    return told(Estimate(value, error, 0, 1.0, converged=True))
