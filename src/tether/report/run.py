"""Sections on one run: what came out, what stands against it, the suspension itself, plots, and what was asked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import xarray as xr

from tether.cli.table import table
from tether.errors import InputError
from tether.plot.pictures import title_of
from tether.record import Record
from tether.report.charts.comparison import Comparison
from tether.report.charts.displacement import displacement_charts
from tether.report.charts.profiles import profile_charts, stress_charts, velocity_charts
from tether.report.charts.radial_distribution import radial_distribution_charts
from tether.report.charts.responses import green_kubo_charts, lissajous_charts, start_up_charts
from tether.report.charts.series import series_charts
from tether.report.page import Badge, Chart, Code, Section, Table, Text, View, Warnings, of_letters
from tether.report.suspension import suspension

_DRAWN: dict[str, tuple[str, Callable[[xr.Dataset, Comparison], list[Chart]]]] = {
    "profiles": ("Profiles across the gradient", profile_charts),
    "stress_profile": ("Stress across the gradient", stress_charts),
    "radial_distribution": ("Structure", radial_distribution_charts),
    "displacement": ("Diffusion", displacement_charts),
    "lissajous": ("Oscillation", lissajous_charts),
    "start_up": ("Start-up and stop", start_up_charts),
    "green_kubo": ("Viscosity from fluctuations", green_kubo_charts),
}
"""Titles and plots of the datasets of a run."""


def title(record: Record) -> str:
    """What was run, in a line."""
    return of_letters(title_of(record.configuration()))


def badges(record: Record) -> list[Badge]:
    """Whether it has ended, and how many warnings there are."""
    if not record.summary_path.is_file():
        return [Badge("not ended", "unsure")]
    count = len(record.summary().get("warnings", []))
    if count == 0:
        return [Badge("no warnings", "good")]
    return [Badge(f"{count} warning{'s' if count > 1 else ''}", "unsure")]


def sections(record: Record, most_bytes: int) -> list[Section]:
    """All of a run but how to cite it. most_bytes: for its trajectory.

    Raises InputError when a file of it is damaged.
    """
    made = [results(record)]
    view = _view(record, most_bytes)
    if view is not None:
        made.append(view)
    return [*made, *_plots(record), configuration(record.configuration().to_toml())]


def results(record: Record) -> Section:
    """The table that ends a run, and the warnings."""
    section = Section("Results", badges=badges(record))
    if not record.summary_path.is_file():
        return section.add(Text("The run has not ended; there are no means yet. `tether resume` goes on with it."))
    summary = record.summary()
    try:
        section.add(results_table(summary), Text("Values in reduced (DPD) units, with standard errors."))
        if summary["warnings"]:
            section.add(Warnings(summary["warnings"]))
    except (KeyError, TypeError, ValueError):
        why = "it lacks what a summary has"
        raise InputError(f"{record.summary_path} is damaged", why, "run the configuration again") from None
    return section


def results_table(summary: Mapping[str, Any]) -> Table:
    """The same as in the terminal."""
    return Table.like(table(dict(summary)))


def configuration(text: str) -> Section:
    """What was asked, as TOML."""
    return Section("Configuration", Code(text, "configuration"), shut=True)


def _view(record: Record, most_bytes: int) -> Section | None:
    found = suspension(record, most_bytes)
    if found is None:
        return None
    words = f"{title(record)}: the suspension, {len(found.description['times'])} frames"
    return Section("Suspension", View(found, words))


def _plots(record: Record) -> list[Section]:
    """Of the series, which a run has before it has ended, and of each dataset."""
    try:
        comparison = Comparison(record)
    except InputError as error:
        if record.series_path.is_file() and record.summary_path.is_file():
            raise
        return [Section("Over time", Text(f"Nothing can be drawn: {error}."))]
    made = [Section("Over time", *series_charts(comparison))]
    velocity = velocity_charts(record, comparison)
    if velocity:
        made.append(Section("Velocity", *velocity))
    for name, (words, charts) in _DRAWN.items():
        if name in comparison.datasets:
            drawn = charts(comparison.datasets[name], comparison)
            if drawn:
                made.append(Section(words, *drawn))
    return made
