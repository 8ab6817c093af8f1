"""`tether paper`: the tables and figures of the paper, and what becomes of its claims."""

from __future__ import annotations

import shlex
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from tether.cli.study import crew, interruptible
from tether.cli.study_progress import duration, study_progress
from tether.errors import InputError
from tether.paper.claim import Claim, Verdict
from tether.paper.exhibit import Exhibit, Size, exhibits
from tether.paper.reproduce import Workshop, finished
from tether.study.cost import makespan, trial
from tether.study.executors import processors
from tether.study.run import failure
from tether.study.schedule import Schedule

_STYLES = {Verdict.HOLDS: "green", Verdict.REMARK: "yellow", Verdict.FAILS: "red", Verdict.UNDECIDED: "dim"}


def paper(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME]...", help='Tables and figures, fig10 for example, or "all"; none lists them.'),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="An hour on two cores for all of them (the default).")] = False,
    full: Annotated[bool, typer.Option("--full", help="The paper's own lengths, for a big machine.")] = False,
    smoke: Annotated[bool, typer.Option("--smoke", help="Seconds each: whether it works, no physics.")] = False,
    report: Annotated[bool, typer.Option("--report", help="Write one page with all that was asked for.")] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print what it would run, and how long.")] = False,
    folder: Annotated[
        Path, typer.Option("--paper", metavar="DIR", help="The folder `paper` of tether's source.")
    ] = Path("paper"),
    runs: Annotated[Path, typer.Option(metavar="DIR", help="Where the runs go, and are kept.")] = Path("paper-runs"),
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Where tables and figures go: into --paper if not given; of --smoke into --runs.",
            show_default=False,
        ),
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Runs at a time here.", show_default=False)] = None,
    threads: Annotated[int, typer.Option(min=1, help="Threads of each run.")] = 1,
    dask: Annotated[str | None, typer.Option("--dask", metavar="SCHEDULER", help="As in tether study.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:  # fmt: skip
    """Reproduce tables and figures of the paper: run what they need, draw them, and judge what the paper says."""
    size = _size(quick, full, smoke)
    all_of_them = exhibits(folder)
    into = out or (runs / "smoke-results" if size == "smoke" else folder)
    if not names:
        _console().print(_list(all_of_them, into, size))
        return
    wanted = _wanted(names, all_of_them)
    workshop = Workshop(runs, size)
    workers = workers or max(1, processors() // threads)
    schedule = workshop.schedule(wanted, threads)
    if dry_run:
        _print_cost(schedule, workers, threads)
        return
    with interruptible(f"tether paper {' '.join(names)}"), study_progress(quiet) as watch:
        workshop.run(schedule, crew(dask, workers), watch)
    command = shlex.join(["tether", "paper", *names, f"--{size}"])
    for exhibit in wanted:
        findings = finished(exhibit, workshop, into / exhibit.name, command)
        if not quiet:
            _console().print(_claims(exhibit, findings.claims))
    if len(wanted) > 1 and not quiet:
        _console().print(_list(wanted, into, size))
    if report:
        from tether.paper.page import write_page  # plotly takes a moment

        path = write_page(wanted, into, size)
        print(path)
    if error := failure(schedule):
        raise error


def _size(quick: bool, full: bool, smoke: bool) -> Size:
    if quick + full + smoke > 1:
        raise InputError("--quick, --full and --smoke exclude each other", "each is a size", "give one of them")
    return "full" if full else "smoke" if smoke else "quick"


def _wanted(names: list[str], known: list[Exhibit]) -> list[Exhibit]:
    if "all" in names:
        return known
    by_name = {exhibit.name: exhibit for exhibit in known}
    for name in names:
        if name not in by_name:
            raise InputError(
                f"{name} is no table or figure here", f"there are {', '.join(by_name)}", "give one of these"
            )
    return [by_name[name] for name in dict.fromkeys(names)]


def _list(wanted: list[Exhibit], into: Path, size: Size) -> Table:
    """Every exhibit, and what became of its claims where it has been made."""
    table = Table(pad_edge=False)
    for name in ("name", "what", *Verdict):
        table.add_column(str(name), justify="left" if name in ("name", "what") else "right")
    totals: Counter[Verdict] = Counter()
    for exhibit in wanted:
        try:
            findings, _ = exhibit.kept(into / exhibit.name, size)
        except InputError:
            table.add_row(exhibit.name, exhibit.title, "not made yet")
            continue
        counts = Counter(claim.verdict for claim in findings.claims)
        totals += counts
        table.add_row(exhibit.name, exhibit.title, *(str(counts[verdict] or "") for verdict in Verdict))
    table.add_section()
    table.add_row("", f"{sum(totals.values())} claims", *(str(totals[verdict]) for verdict in Verdict))
    return table


def _claims(exhibit: Exhibit, claims: Sequence[Claim]) -> Table:
    table = Table(title=f"{exhibit.name}: {exhibit.title}", title_justify="left", pad_edge=False, show_lines=True)
    for name in ("the paper", "measured", "verdict"):
        table.add_column(name)
    for claim in claims:
        verdict = f"[{_STYLES[claim.verdict]}]{claim.verdict}[/]" + (
            f": {escape(claim.remark)}" if claim.remark else ""
        )
        if claim.verdict is Verdict.UNDECIDED and claim.core_hours is not None:
            verdict += f" ({claim.core_hours:.2g} core-hours would decide)"
        table.add_row(escape(f"{claim.text} ({claim.source})"), escape(claim.measured), verdict)
    return table


def _print_cost(schedule: Schedule, workers: int, threads: int) -> None:
    if not schedule.points:
        print("nothing to run")
        return
    if schedule.speed == 0:
        middle = sorted(schedule.points, key=lambda point: point.cost)[len(schedule.points) // 2]
        schedule.assume(trial(middle.configuration, threads))
    to_do = [point for point in schedule.points if point.identity not in schedule.summaries]
    seconds = [schedule.seconds_of(point, left=True) for point in to_do]
    print(
        f"{len(schedule.points)} runs, {len(to_do)} to do: {sum(seconds) / 3600:.2g} hours of computing, about "
        f"{duration(makespan(seconds, workers) if seconds else 0.0)} with {workers} at a time"
    )


def _console() -> Console:
    return Console(highlight=False, width=None if sys.stdout.isatty() else 160)
