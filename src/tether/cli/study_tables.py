"""Tables of a study: its plan, where its runs stand, and what came out."""

from __future__ import annotations

import math
from collections import Counter
from typing import Any

import pandas as pd
from rich.table import Table

from tether.cli.study_progress import duration
from tether.estimate import Estimate
from tether.study.ledger import Ledger
from tether.study.study import Ensemble

_MOST_ROWS = 60


def plan(ledger: Ledger) -> Table:
    """Every setting: its runs' numbers, size, steps and time."""
    study = ledger.study
    table = Table(pad_edge=False)
    for name in ("setting", "runs"):
        table.add_column(name)
    for name in ("particles", "steps", "time of a run", "done"):
        table.add_column(name, justify="right")
    every = len(study.all_ensembles)
    for number, ensemble in enumerate(study.all_ensembles[:_MOST_ROWS]):
        configuration = ensemble.configuration
        repeats = ledger.repeats_of(ensemble)
        done = sum(1 for point in repeats if point.identity in ledger.summaries)
        numbers = ", ".join(str(number + every * repeat) for repeat in range(min(study.repeats, 3)))
        table.add_row(
            ensemble.label, numbers + (", ..." if study.repeats > 3 else ""),
            str(configuration.solvent_count + configuration.constituent_count),
            str(configuration.run.equilibration + configuration.steps), duration(ledger.seconds_of(repeats[0])),
            f"{done} of {len(repeats)}",
        )  # fmt: skip
    if every > _MOST_ROWS:
        table.add_row(f"and {every - _MOST_ROWS} more")
    return table


def status(ledger: Ledger) -> Table:
    """Every setting: how many of its runs are done, under way, waiting, and the mean so far."""
    table = Table(pad_edge=False)
    table.add_column("setting")
    for name in ("done", "under way", "to do", "failed"):
        table.add_column(name, justify="right")
    table.add_column("mean so far")
    for ensemble in ledger.study.all_ensembles[:_MOST_ROWS]:
        repeats = ledger.repeats_of(ensemble)
        kinds = Counter(ledger.states[point.identity].kind for point in repeats)
        progress = [ledger.states[point.identity].progress for point in repeats]
        parts = [f"{each.fraction:.0%}" for each in progress if each is not None and not each.failure]
        table.add_row(
            ensemble.label, str(kinds["done"]), f"{kinds['running']}" + (f" ({', '.join(parts[:4])})" if parts else ""),
            str(kinds["waiting"] + kinds["interrupted"]), str(kinds["failed"]), _mean(ledger, ensemble),
        )  # fmt: skip
    if len(ledger.study.all_ensembles) > _MOST_ROWS:
        table.add_row(f"and {len(ledger.study.all_ensembles) - _MOST_ROWS} more")
    return table


def _mean(ledger: Ledger, ensemble: Ensemble) -> str:
    name, symbol = ("viscosity", "eta") if ensemble.configuration.flow.shear_rate != 0 else ("pressure", "p")
    mean = ledger.mean(ledger.repeats_of(ensemble), name)
    return f"{symbol} {_estimate(mean.value, mean.error)}" if mean.repeats else ""


_SHOWN = {
    "viscosity": "eta",
    "viscosity_pairwise": "eta, pairs alone",
    "relative_viscosity": "eta_r",
    "relative_viscosity_pairwise": "eta_r, pairs alone",
    "viscosity_green_kubo": "eta, Green-Kubo",
    "viscosity_momentum_balance": "eta, momentum balance",
    "storage_modulus": "G'",
    "loss_modulus": "G''",
    "N1": "N1",
    "N2": "N2",
    "pressure": "p",
}


def means(table: pd.DataFrame, keys: list[str]) -> Table:
    """The means over repeats with their errors, a row a setting."""
    shown = {name: words for name, words in _SHOWN.items() if name in table and table[name].notna().any()}
    made = Table(pad_edge=False)
    for key in keys:
        made.add_column(key.split(".")[-1], justify="right")
    made.add_column("repeats", justify="right")
    for words in list(shown.values())[:6]:
        made.add_column(words, justify="right")
    for _, row in table.head(_MOST_ROWS).iterrows():
        estimates = [_estimate(row[name], row[f"{name}_error"]) for name in list(shown)[:6]]
        values = [f"{row[key]:g}" if isinstance(row[key], float) else str(row[key]) for key in keys]
        made.add_row(*values, str(row["repeats"]), *estimates)
    if len(table) > _MOST_ROWS:
        made.add_row(f"and {len(table) - _MOST_ROWS} more")
    return made


_LAWS = {
    "krieger_dougherty": "Krieger-Dougherty",
    "krieger_dougherty_free": "the same, slope free",
    "quemada": "Quemada",
}


def fits(rows: list[dict[str, Any]], keys: list[str]) -> Table:
    """Laws fitted to viscosity against volume fraction."""
    keys = [key for key in keys if key in rows[0]]
    table = Table(pad_edge=False, title="eta(phi), fitted", title_justify="left")
    for name in (*(key.split(".")[-1] for key in keys), "", "law", "phi_m", "[eta]", "chi^2 / freedom", "p"):
        table.add_column(name)
    for row in [row for row in rows if row["law"] in _LAWS and not math.isnan(row["maximum_packing"])][:_MOST_ROWS]:
        slope = _estimate(row["intrinsic_viscosity"], row["intrinsic_viscosity_error"])
        table.add_row(
            *(f"{row[key]:g}" if isinstance(row[key], int | float) else str(row[key]) for key in keys),
            "pairs alone" if row["quantity"] == "viscosity_pairwise" else "total", _LAWS[row["law"]],
            _estimate(row["maximum_packing"], row["maximum_packing_error"]), slope,
            f"{row['chi_square']:.3g} / {row['degrees_of_freedom']}",
            f"{row['p_value']:.2g}" if math.isfinite(row["p_value"]) else "",
        )  # fmt: skip
    return table


def _estimate(value: float, error: float) -> str:
    """Value and error, or that it is not known."""
    if not math.isfinite(value):
        return ""
    return str(Estimate(value, error, 0, math.nan, converged=True)) if math.isfinite(error) else f"{value:.3g} +- ?"
