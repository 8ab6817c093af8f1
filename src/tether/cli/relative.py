"""The relative viscosity: a suspension's over that of the same fluid without bodies."""

from __future__ import annotations

import json
import math
from pathlib import Path

from rich.console import Console

from tether.cli.progress import progress
from tether.config import Configuration
from tether.drive import drive
from tether.errors import InputError
from tether.estimate import Estimate
from tether.files.whole import whole
from tether.record import Record
from tether.result import Result
from tether.resume import resume
from tether.simulation import Simulation
from tether.theory.suspension import MAXIMUM_PACKING, einstein, krieger_dougherty


def relative_viscosity(result: Result, record: Record, threads: int | None, quiet: bool) -> None:
    """Print the relative viscosity beside theory, draw it, and write relative.json into the record."""
    from tether.plot import plot_relative  # matplotlib takes longer to import than a small run to start

    configuration = result.configuration
    plain = _plain_fluid(configuration, record.folder / "plain_fluid", threads, quiet)
    assert result.viscosity is not None
    assert result.viscosity_pairwise is not None
    total = result.viscosity / plain
    pairwise = result.viscosity_pairwise / plain
    phi, dimension = configuration.volume_fraction, configuration.dimension
    theory = {
        "Einstein": einstein(phi, dimension),
        f"Krieger-Dougherty, phi_m = {MAXIMUM_PACKING[dimension]:g}": krieger_dougherty(phi, dimension),
    }
    with whole(record.folder / "relative.json") as temporary:
        entries = {
            "volume_fraction": phi,
            "viscosity_plain_fluid": plain.as_dict(),
            "relative_viscosity": total.as_dict(),
            "relative_viscosity_pairwise": pairwise.as_dict(),
            "theory": {name: value if math.isfinite(value) else None for name, value in theory.items()},
        }
        temporary.write_text(json.dumps(entries, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    pictures = plot_relative(phi, total, dimension, record.folder / "relative", pairwise)
    if quiet:
        return
    console = Console(highlight=False, markup=False, soft_wrap=True)
    console.print(f"Relative viscosity at phi = {phi:.4f}, shear rate {configuration.flow.shear_rate:g}:")
    console.print(f"  eta_r = {total}   (total stress; the plain fluid's viscosity is {plain})")
    console.print(f"  eta_r = {pairwise}   (pairwise stress, the figure that the paper plots)")
    for name, value in theory.items():
        console.print(f"  {value:.3f}   {name}" if math.isfinite(value) else f"  beyond phi_m: {name}")
    console.print(f"Picture: {pictures[0]}")


def _plain_fluid(configuration: Configuration, folder: Path, threads: int | None, quiet: bool) -> Estimate:
    """The viscosity of the same run without bodies: from the folder if it has been run, else run now."""
    plain = configuration.plain_fluid()
    kept = _kept(folder, plain, threads)
    if kept is not None:
        simulation, record = kept
    else:
        simulation = Simulation.from_configuration(plain, threads)
        record = Record.create(folder, plain, force=True)
    if not simulation.is_finished:
        with progress(simulation, quiet) as watch:
            drive(simulation, record, watch)
    viscosity = simulation.result().viscosity
    assert viscosity is not None
    return viscosity


def _kept(folder: Path, configuration: Configuration, threads: int | None) -> tuple[Simulation, Record] | None:
    """The run of this configuration in the folder, if there is one that can go on."""
    try:
        if Record.open(folder).configuration().to_toml() != configuration.to_toml():
            return None
        simulation, record, _ = resume(folder, threads)
    except InputError:
        return None
    return simulation, record
