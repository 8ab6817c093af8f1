"""The table that ends a run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich.table import Table

from tether.estimate import Estimate

Entry = dict[str, float | None]
Row = tuple[str, str, str, str]
"""Quantity, value, error, note."""


def table(summary: dict[str, Any]) -> Table:
    """The summary of a run as a table of quantities, values and errors, like ones together."""
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
    for group in (*_means(summary), _numbers(summary), _run(summary)):
        for row in group:
            rows.add_row(*row)
        rows.add_section()
    return rows


_GROUPS: tuple[dict[str, str], ...] = (
    {
        "viscosity": "S_xy / shear rate, total stress",
        "viscosity_pairwise": "without the stress in the bodies",
        "viscosity_planes": "from the force through planes normal to y",
        "viscosity_planes_pairwise": "the same without what holds bodies together",
        "viscosity_momentum_balance": "from the profile under the applied force",
        "viscosity_green_kubo": "from the fluctuations of the stress at rest",
        "viscosity_random": "random forces' share, in no sum; zero on average",
    },
    {
        "storage_modulus": "G', in phase with the strain",
        "loss_modulus": "G'', in phase with the rate",
        "dynamic_viscosity": "G'' / angular frequency",
        "third_harmonic": "over the first; noise alone lifts it to its error",
    },
    {
        "N1": "S_xx - S_yy",
        "N1_planes": "from the forces through planes normal to x and to y",
        "N1_planes_pairwise": "the same without what holds bodies together",
        "N2": "S_yy - S_zz",
        "pressure": "",
    },
    {"temperature_configurational": "of the solvent, from forces, not velocities"},
    {
        "diffusion_velocity": "the same from the velocities",
        "diffusion_rotational": "of the orientation",
        "diffusion": "from the mean-square displacement",
        "spin": "mean, about z",
    },
    {
        "contact_distance": "where g(r) with solvent becomes 0.01",
        "effective_radius": "contact distance less the solvent's radius",
    },
)
"""What stands together, and a note on each. Names of the last two groups are followed by a species' name."""

_NOTES = {"effective_radius_solvent": "half the contact distance"}
"""Of single quantities, instead of the above."""

_TEMPERATURES = {"constituents_raw": "as if constituents of rigid bodies were free; no temperature"}

_NUMBERS = {
    "peclet": ("Peclet number", ("radius", "diffusivity")),
    "reynolds": ("Reynolds, channel L_y", ("radius", "viscosity")),
    "particle_reynolds": ("Reynolds, one body", ("radius", "viscosity")),
    "mach": ("Mach number", ("radius", "sound_speed")),
}
"""Title of each dimensionless number, and what it was made from (where that is from, summary.json says)."""


def _means(summary: dict[str, Any]) -> list[list[Row]]:
    """The groups of means that this run has; what no group knows comes last, so that nothing measured is hidden."""
    found: list[list[Row]] = [[] for _ in range(len(_GROUPS) + 1)]
    for name, entry in summary.items():
        if not _is_mean(entry):
            continue
        number, note = _place(name)
        found[number].append(_row(name.replace("_", " "), entry, note))
    kinetic = [
        _row(f"kT {of.replace('_', ' ')}", entry, _TEMPERATURES.get(of, ""))
        for of, entry in summary["temperature"].items()
        if entry is not None
    ]
    with_temperature = next(number for number, group in enumerate(_GROUPS) if "temperature_configurational" in group)
    found[with_temperature] = kinetic + [("kT configurational", *row[1:]) for row in found[with_temperature]]
    return found


def _is_mean(entry: Any) -> bool:
    return isinstance(entry, dict) and set(entry) == {"value", "error"}


def _place(name: str) -> tuple[int, str]:
    """The group of a mean, and the note on it: of the longest known beginning of its name."""
    known = [
        (len(beginning), number, note)
        for number, group in enumerate(_GROUPS)
        for beginning, note in group.items()
        if name == beginning or (number >= len(_GROUPS) - 2 and name.startswith(f"{beginning}_"))
    ]
    if not known:
        return len(_GROUPS), ""
    _, number, note = max(known)
    return number, _NOTES.get(name, note)


def _row(name: str, entry: Entry, note: str) -> Row:
    value, error = entry["value"], entry["error"]
    if value is None:
        return name, "-", "-", "the run is too short for it"
    if error is None:
        return name, f"{value:.3g}", "-", "the run is too short for an error"
    # Estimate knows how many digits an error is worth.
    shown = str(Estimate(value, error, samples=1, inefficiency=1.0, converged=True)).split(" +- ")
    return name, shown[0], shown[1], note


def _numbers(summary: dict[str, Any]) -> Iterator[Row]:
    numbers = summary["dimensionless"]
    for name, (title, made_from) in _NUMBERS.items():
        if numbers[name] is not None:
            words = [f"{part.replace('_', ' ')} {numbers[part]['value']:.3g}" for part in made_from]
            yield title, f"{numbers[name]:.3g}", "", ", ".join(words)


def _run(summary: dict[str, Any]) -> Iterator[Row]:
    if summary["momentum_drift"] is not None:
        yield "momentum drift", f"{summary['momentum_drift']:.1e}", "", "per particle"
    performance = summary["performance"]
    threads = f"{performance['threads']} thread{'s' if performance['threads'] > 1 else ''}"
    if performance["particle_steps_per_second"] is not None:
        speed = performance["particle_steps_per_second"] / 1e6
        engine = performance["instruction_set"] or "the reference engine"
        note = f"million particle-steps/s on {threads}, {engine}, {performance['precision']}"
        yield "speed", f"{speed:.2f}", "", note
    yield "state", summary["state_sha256"][:12], "", "SHA-256 of the final state, beginning"
