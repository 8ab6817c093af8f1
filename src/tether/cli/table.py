"""The table that ends a run."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from tether.estimate import Estimate


def table(summary: dict[str, Any]) -> Table:
    """The summary of a run as a table of quantities, values and errors."""
    particles = summary["particles"]
    rows = Table(
        title=f"{summary['dimension']}D, {particles['solvent']} solvent particles, {particles['bodies']} bodies, "
        f"volume fraction {particles['volume_fraction']:.4f}",
        title_justify="left",
        pad_edge=False,
    )
    rows.add_column("quantity")
    rows.add_column("value", justify="right")
    rows.add_column("error", justify="right")
    rows.add_column("")
    for name, note in _QUANTITIES.items():
        _add(rows, name.replace("_", " "), summary[name], note)
    for name, entry in summary["temperature"].items():
        _add(rows, f"kT {name.replace('_', ' ')}", entry, "")
    numbers = summary["dimensionless"]
    for name, (title, _) in _NUMBERS.items():
        if numbers[name] is not None:
            rows.add_row(title, f"{numbers[name]:.3g}", "", _of(name, numbers))
    if summary["momentum_drift"] is not None:
        rows.add_row("momentum drift", f"{summary['momentum_drift']:.1e}", "", "per particle")
    performance = summary["performance"]
    threads = f"{performance['threads']} thread{'s' if performance['threads'] > 1 else ''}"
    if performance["particle_steps_per_second"] is not None:
        speed = performance["particle_steps_per_second"] / 1e6
        engine = performance["instruction_set"] or "the reference engine"
        rows.add_row(
            "speed", f"{speed:.2f}", "", f"million particle-steps/s on {threads}, {engine}, {performance['precision']}"
        )
    rows.add_row("state", summary["state_sha256"][:12], "", "SHA-256 of the final state, beginning")
    return rows


_QUANTITIES = {
    "viscosity": "S_xy / shear rate, total stress",
    "viscosity_pairwise": "without the stress in the bodies",
    "viscosity_random": "random forces' share, in no sum; zero on average",
    "N1": "S_xx - S_yy",
    "N2": "S_yy - S_zz",
    "pressure": "",
}

_NUMBERS = {
    "peclet": ("Peclet number", ("radius", "diffusivity")),
    "reynolds": ("Reynolds, channel L_y", ("radius", "viscosity")),
    "particle_reynolds": ("Reynolds, one body", ("radius", "viscosity")),
    "mach": ("Mach number", ("radius", "sound_speed")),
}
"""Title of each dimensionless number, and what it was made from (where that is from, summary.json says)."""


def _add(rows: Table, name: str, entry: dict[str, float | None] | None, note: str) -> None:
    if entry is None:
        return
    value, error = entry["value"], entry["error"]
    assert value is not None
    if error is None:
        rows.add_row(name, f"{value:.3g}", "-", "the run is too short for an error")
        return
    # Estimate knows how many digits an error is worth.
    shown = str(Estimate(value, error, samples=1, inefficiency=1.0, converged=True)).split(" +- ")
    rows.add_row(name, shown[0], shown[1], note)


def _of(name: str, numbers: dict[str, Any]) -> str:
    words = [f"{part.replace('_', ' ')} {numbers[part]['value']:.3g}" for part in _NUMBERS[name][1]]
    return ", ".join(words)
