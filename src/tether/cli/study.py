"""`tether study`: many runs, from one file."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Annotated, Any

import pandas as pd
import typer
from rich.console import Console
from typer.core import TyperGroup

from tether.cli import study_tables
from tether.cli.study_progress import duration, study_progress
from tether.errors import InputError, RunError
from tether.files.whole import whole
from tether.study.cost import makespan, trial
from tether.study.executors import OpenCrew, dask, is_under_mpi, mpi, processes, processors
from tether.study.folder import StudyFolder
from tether.study.ledger import Ledger
from tether.study.results import Results, results_of
from tether.study.run import failure
from tether.study.schedule import Schedule
from tether.study.study import Study
from tether.study.work import Task, work


class _RunsByDefault(TyperGroup):
    """`tether study STUDY.toml` is short for `tether study run STUDY.toml`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put `run` in front of what is no command."""
        if args and args[0] not in self.commands and args[0] not in ("--help", "-h"):
            args = ["run", *args]
        return super().parse_args(ctx, args)


app = typer.Typer(
    name="study",
    cls=_RunsByDefault,
    help="Many runs from one file: `tether study STUDY.toml` runs it (short for `tether study run STUDY.toml`).",
    no_args_is_help=True,
    rich_markup_mode=None,
)

StudyFile = Annotated[Path, typer.Argument(metavar="STUDY", help="The study, a TOML file, or the folder of one.")]
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="The folder of a study.")]
Out = Annotated[Path | None, typer.Option(help="Folder for the runs; the file's name without .toml if not given.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the base, for example run.steps=1000."),
]
Threads = Annotated[int, typer.Option(min=1, help="Threads of each run; the results do not depend on it.")]


@app.command()
def run(
    study: StudyFile,
    out: Out = None,
    set_: Set = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1, help="Runs at a time on this machine; as many as there are processors if not given.",
            show_default=False,
        ),
    ] = None,
    threads: Threads = 1,
    dask_: Annotated[
        str | None,
        typer.Option(
            "--dask", metavar="SCHEDULER",
            help='Run on Dask: the address or file of a scheduler, or "local" for a cluster on this machine.',
        ),
    ] = None,
    adaptive: Annotated[
        bool, typer.Option("--adaptive", help="Then add repeats where the error is worst, until --hours are over.")
    ] = False,
    hours: Annotated[float, typer.Option(min=0.0, help="Wall-clock time for --adaptive.")] = 1.0,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print the plan and what it costs; run nothing.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:  # fmt: skip
    """Run a study, or what is left of it: finished runs are kept, interrupted ones go on."""
    asked, folder = _asked(study, out, set_)
    workers = workers or max(1, processors() // threads)
    if dry_run:
        _print_plan(asked, folder, workers, threads)
        return
    until = time.monotonic() + 3600.0 * hours if adaptive else None
    schedule = Schedule(asked, StudyFolder.create(folder, asked), threads, until)
    with interruptible(f"tether study {folder}"), study_progress(quiet) as watch:
        schedule.run(crew(dask_, workers), watch)
    _finish(asked, schedule, quiet)


@app.command()
def status(folder: Folder) -> None:
    """Print where the runs of a study stand, also while it goes on."""
    found = StudyFolder.open(folder)
    ledger = Ledger(found.study(), found)
    console = _console()
    console.print(study_tables.status(ledger))
    kinds = [ledger.states[point.identity].kind for point in ledger.points]
    counts = {kind: kinds.count(kind) for kind in ("done", "running", "interrupted", "waiting", "failed")}
    console.print(", ".join(f"{number} {kind}" for kind, number in counts.items() if number or kind == "done"))
    for point in ledger.points:
        state = ledger.states[point.identity]
        if state.kind == "failed" and state.progress is not None:
            console.print(f"failed: {point.label}: {state.progress.failure}", markup=False, soft_wrap=True)
    if others := found.others(ledger.points):
        console.print(f"{others} more in {found.points_path} are of earlier studies and kept", soft_wrap=True)


@app.command()
def collect(folder: Folder) -> None:
    """Write results.csv, .parquet and .nc from the runs that are done so far, and print their means."""
    found = StudyFolder.open(folder)
    _collect(found.study(), found, quiet=False)


@app.command()
def plot(
    folder: Folder,
    quantity: Annotated[
        str | None, typer.Option(help="Draw this quantity instead of the usual pictures.", show_default=False)
    ] = None,
    against: Annotated[
        str | None, typer.Option(help="Against this swept key or number.", show_default=False)
    ] = None,
) -> None:  # fmt: skip
    """Draw what the runs that are done so far have found: relative viscosity, flow curves, normal stresses."""
    from tether.plot.against import plot_against
    from tether.plot.study_pictures import draw_study

    found = StudyFolder.open(folder)
    study = found.study()
    dataset = results_of(study, found).dataset
    dataset.attrs["title"] = f"tether: {folder.resolve().name}"  # the file has no place in it: its bytes are the same
    if (quantity is None) != (against is None):
        raise InputError("--quantity and --against go together", "a picture has two axes", "give both, or neither")
    if quantity is not None and against is not None:
        name = f"{quantity}-{against.split('.')[-1]}"
        paths = plot_against(dataset, quantity, against, folder / name)
    else:
        paths = draw_study(dataset, folder)
    for path in paths:
        print(path)


@app.command()
def count(study: StudyFile, set_: Set = None) -> None:
    """Print how many runs a study has: the tasks of a job array."""
    print(len(_asked(study, None, set_)[0].points))


@app.command()
def run_point(
    study: StudyFile,
    number: Annotated[int, typer.Argument(metavar="K", help="The number of the run, from 0; --dry-run lists them.")],
    out: Out = None,
    set_: Set = None,
    threads: Threads = 1,
) -> None:
    """Do one run of a study, or what is left of it: a task of a job array."""
    asked, path = _asked(study, out, set_)
    if not 0 <= number < len(asked.points):
        why = f"this study has {len(asked.points)} runs, numbered from 0"
        raise InputError(f"there is no run {number}", why, f"give a number up to {len(asked.points) - 1}")
    folder = StudyFolder.create(path, asked)
    point = asked.points[number]
    task = Task(str(folder.path(point).absolute()), point.configuration, threads, "")
    outcome = work(task)
    if outcome.kind == "failed":
        raise RunError(f"{point.label}: {outcome.failure}")
    if outcome.kind == "stopped":
        print(f"stopped; the same command goes on with it: {point.label}", file=sys.stderr)
        raise typer.Exit(128 + signal.SIGTERM)


def _asked(path: Path, out: Path | None, overrides: list[str] | None) -> tuple[Study, Path]:
    """The study, and its folder."""
    if path.is_dir():
        if overrides:
            raise InputError("--set needs the study's file", "a folder holds what was asked before", "give the file")
        return StudyFolder.open(path).study(), out or path
    return Study.read(path, overrides or []), out or Path(path.stem)


def crew(scheduler: str | None, workers: int) -> OpenCrew:
    """What does the runs: the other processes of MPI if there are any, Dask if asked for, else processes here."""
    if is_under_mpi():
        return mpi
    if scheduler is not None:
        return partial(dask, scheduler, workers)
    return partial(processes, workers)


@contextmanager
def interruptible(command: str) -> Iterator[None]:
    """End a study that is stopped with a word on how to go on; a SIGTERM is a Ctrl-C that others can give."""

    def interrupt(_: int, __: FrameType | None) -> None:
        raise KeyboardInterrupt

    former = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    except KeyboardInterrupt:
        print(f"stopped; the same command goes on with it (or: {command})", file=sys.stderr)
        raise typer.Exit(128 + signal.SIGINT) from None
    finally:
        signal.signal(signal.SIGTERM, former)


def _print_plan(study: Study, path: Path, workers: int, threads: int) -> None:
    folder = StudyFolder(path)
    ledger = Ledger(study, folder)
    from_runs = ledger.speed > 0
    if not from_runs:
        smallest = min(study.points, key=lambda point: point.cost)
        ledger.assume(trial(smallest.configuration, threads))
    to_do = [point for point in ledger.points if ledger.states[point.identity].kind != "done"]
    seconds = [ledger.seconds_of(point, left=True) for point in to_do]
    console = _console()
    console.print(study_tables.plan(ledger))
    at_a_time = f"{workers} at a time" if workers > 1 else "one after the other"
    console.print(
        f"{len(ledger.points)} runs, {len(to_do)} to do: {sum(seconds) / 3600:.2g} hours of computing, about "
        f"{duration(makespan(seconds, workers) if seconds else 0.0)} {at_a_time} "
        f"({'from the runs that are done' if from_runs else 'from half a second of one of them on this machine'})",
        soft_wrap=True,
    )


def _finish(study: Study, schedule: Schedule, quiet: bool) -> None:
    folder = schedule.folder
    if schedule.summaries:
        _collect(study, folder, quiet)
    if error := failure(schedule):
        raise error


def _collect(study: Study, folder: StudyFolder, quiet: bool) -> None:
    results = results_of(study, folder)
    if not len(results.runs):
        raise InputError(f"no run in {folder.folder} is done", "there is nothing to gather", "run the study first")
    paths = results.write(folder.folder)
    if quiet:
        return
    console = _console()
    console.print(study_tables.means(results.means, [name for axis in study.axes for name in axis.names]))
    if (apart := results.disagreement) is not None:
        console.print(f"warning: {apart}", markup=False, soft_wrap=True)
    warned = int((results.runs["warnings"] != "").sum())
    if warned:
        console.print(f"note: {warned} runs have warnings (column warnings of results.csv)", soft_wrap=True)
    fits = _fits(results, folder.folder)
    if fits:
        console.print(study_tables.fits(fits, [name for axis in study.axes for name in axis.names]))
        paths.append(folder.folder / "fits.csv")
    console.print(f"Results: {', '.join(str(path) for path in paths)}", soft_wrap=True)


def _fits(results: Results, folder: Path) -> list[dict[str, Any]]:
    """Fit viscosity against volume fraction, where that varies, and write fits.csv."""
    if results.means["volume_fraction"].nunique() < 2:
        return []
    from tether.plot.study_pictures import fits_of  # matplotlib takes longer to import than everything else

    fits = fits_of(results.dataset)
    with whole(folder / "fits.csv") as temporary:
        pd.DataFrame(fits).to_csv(temporary, index=False)
    return fits


def _console() -> Console:
    return Console(highlight=False, width=None if sys.stdout.isatty() else 140)
