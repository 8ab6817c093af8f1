"""What each command does."""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from tether.cli.paper import paper
from tether.cli.progress import progress
from tether.cli.relative import relative_viscosity
from tether.cli.report import report
from tether.cli.study import app as study
from tether.cli.table import table
from tether.config import Source, json_schema, template
from tether.drive import Stopped, drive
from tether.engines import instruction_set, instruction_sets, mathematics
from tether.errors import InputError, TetherError
from tether.record import Record
from tether.resume import resume as resumed
from tether.simulation import Simulation
from tether.study.study import json_schema as study_schema
from tether.version import __version__

app = typer.Typer(
    name="tether",
    help="The rheology of particulate suspensions, by dissipative particle dynamics.",
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    rich_markup_mode=None,
)

app.add_typer(study)
app.command()(report)
app.command()(paper)

Threads = Annotated[
    int | None,
    typer.Option(min=1, help="Threads to run on; the results do not depend on it.", show_default=False),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")]
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="The folder of a run.")]


class FlowKind(StrEnum):
    """Flows that `tether init` writes a file for."""

    couette = "couette"
    rest = "rest"
    oscillatory = "oscillatory"
    stages = "stages"
    poiseuille = "poiseuille"
    kolmogorov = "kolmogorov"


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"tether {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


@app.command()
def run(
    config: Annotated[Path, typer.Argument(metavar="CONFIG", help="The configuration, a TOML file.")],
    out: Annotated[
        Path | None, typer.Option(help="Folder for the results; the file's name without .toml if not given.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Change a key, for example flow.shear_rate=0.1."),
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Change the seed.", show_default=False)] = None,
    threads: Threads = None,
    relative: Annotated[
        bool,
        typer.Option(
            "--relative",
            help="Run the same file without its bodies too (once, then kept), and print the relative viscosity.",
        ),
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the results of an earlier run.")] = False,
    quiet: Quiet = False,
) -> None:
    """Run a configuration and measure the suspension."""
    source = Source.read(config, set_ or [], seed)
    configuration = source.configuration()
    if relative and (not configuration.bodies or configuration.flow.shear_rate == 0):
        raise InputError(
            "--relative needs bodies and a steady shear flow",
            "it divides the viscosity S_xy / rate by that of the same fluid without bodies",
            "run without --relative",
        )
    folder = out or Path(config.stem)
    with _stoppable():
        try:
            Record(folder).check_free(force)
            simulation = Simulation.from_configuration(configuration, threads)
            simulation.place()  # before the folder: bodies that find no room leave none behind
            record = Record.create(folder, configuration, force)
            _finish(simulation, record, quiet)
        except TetherError as error:
            raise source.located(error) from None
        if relative:
            relative_viscosity(simulation.result(), record, threads, quiet)


@app.command()
def resume(
    folder: Folder,
    steps: Annotated[
        int | None, typer.Option(min=1, help="Measured steps to add to the run's length.", show_default=False)
    ] = None,
    threads: Threads = None,
    quiet: Quiet = False,
) -> None:
    """Go on with a run that was stopped, or make a finished one longer."""
    simulation, record, remarks = resumed(folder, threads, steps or 0)
    if not quiet:
        for remark in remarks:
            Console(stderr=True).print(f"note: {remark}", highlight=False, markup=False, soft_wrap=True)
    if simulation.is_finished and record.summary_path.is_file():
        if not quiet:
            _print_summary(record)
            print(f"The run in {folder} has ended; --steps N makes it longer.")
        return
    with _stoppable():
        _finish(simulation, record, quiet)


@app.command()
def show(
    folder: Folder,
    as_json: Annotated[bool, typer.Option("--json", help="Print summary.json instead of the table.")] = False,
) -> None:
    """Print the results of a run again."""
    record = Record.open(folder)
    if as_json:
        print(json.dumps(record.summary(), indent=2))
    else:
        _print_summary(record)


@app.command()
def plot(folder: Folder) -> None:
    """Draw what was measured, as PNG and SVG: stress and temperature over time, and a picture for each measurement."""
    from tether.plot.pictures import draw  # matplotlib takes longer to import than everything else

    for path in draw(Record.open(folder)):
        print(path)


@app.command()
def init(
    path: Annotated[
        Path | None,
        typer.Argument(
            metavar="[FILE]", help="Where to write; FLOW.toml if not given, - to print.", show_default=False
        ),
    ] = None,
    flow: Annotated[FlowKind, typer.Option(help="The flow.")] = FlowKind.couette,
    dimension: Annotated[int, typer.Option(min=2, max=3, help="Two or three dimensions.")] = 3,
) -> None:
    """Write a commented configuration to start from."""
    text = template(flow.value, 2 if dimension == 2 else 3)
    if path == Path("-"):
        print(text, end="")
        return
    path = path or Path(f"{flow.value}.toml")
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(f"{path} exists", "it would be overwritten", "name another file") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(f"{path} cannot be written", reason, "name another file") from None
    print(f"Wrote {path}; run it with: tether run {path}")


@app.command()
def info() -> None:
    """Print the version, the engine, its instruction set and threads."""
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    sets = ", ".join(
        f"{name}{'' if is_here else ' (not on this processor)'}" for name, is_here in instruction_sets().items()
    )
    table.add_row("tether", __version__)
    table.add_row("engine", "cpu; mixed precision, double on request (run.precision)")
    table.add_row("instruction set", f"{instruction_set()}, of {sets}")
    table.add_row("threads", f"{len(os.sched_getaffinity(0))}, one for each 4000 particles")
    table.add_row("mathematics", mathematics())
    Console(highlight=False).print(table, soft_wrap=True)


@app.command()
def schema(
    of_study: Annotated[bool, typer.Option("--study", help="Of study files.")] = False,
) -> None:
    """Print the JSON schema of configurations, with which editors complete and check them."""
    print(json.dumps(study_schema() if of_study else json_schema(), indent=2))


@contextmanager
def _stoppable() -> Iterator[None]:
    """End a command that is stopped by a signal with a word on it, and 128 + the signal."""
    try:
        yield
    except Stopped as stop:
        print(stop, file=sys.stderr)
        raise typer.Exit(128 + stop.signal_number) from None
    except KeyboardInterrupt:
        print("stopped at once; what came after the last checkpoint is lost", file=sys.stderr)
        raise typer.Exit(128 + signal.SIGINT) from None


def _finish(simulation: Simulation, record: Record, quiet: bool) -> None:
    with progress(simulation, quiet) as watch:
        drive(simulation, record, watch)
    if not quiet:
        _print_summary(record)
        print(f"Results: {record.folder}")


def _print_summary(record: Record) -> None:
    summary = record.summary()
    console = Console(highlight=False, width=None if sys.stdout.isatty() else 100)
    try:
        console.print(table(summary))
        for warning in summary["warnings"]:
            console.print(f"warning: {warning}", markup=False, soft_wrap=True)
    except (KeyError, TypeError, ValueError):
        raise InputError(
            f"{record.summary_path} is damaged", "it lacks what a summary has", "run the configuration again"
        ) from None
