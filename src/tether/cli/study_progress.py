"""What is shown while a study goes: a table that lives in a terminal, a line now and then in a log."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta

from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from tether.study.schedule import Schedule

_SECONDS_BETWEEN_LINES = 30.0
_MOST_ROWS = 16

Watch = Callable[[Schedule], None]


@contextmanager
def study_progress(quiet: bool) -> Iterator[Watch | None]:
    """Runs done and under way, their rates and running means, time left; gives what to call a few times a second."""
    if quiet:
        yield None
    elif not sys.stderr.isatty():
        yield _Lines()
    else:
        with Live(console=Console(stderr=True), transient=True, auto_refresh=False) as live:
            yield lambda schedule: live.update(picture(schedule), refresh=True)


def picture(schedule: Schedule) -> Group:
    """The table of runs under way, below a bar for the whole study."""
    bar = Table.grid(padding=(0, 1))
    bar.add_row(ProgressBar(total=1.0, completed=schedule.fraction, width=40), Text(summary(schedule)))
    rows = Table(box=None, pad_edge=False)
    for name in ("run", "", "", "time left", "so far"):
        rows.add_column(name, justify="right" if name == "time left" else "left")
    under_way = [p for name, p in schedule.running.items() if schedule.states[name].kind == "running"]
    for point in under_way[:_MOST_ROWS]:
        progress = schedule.states[point.identity].progress
        assert progress is not None
        left = (progress.end - progress.step) / progress.rate if progress.rate else math.nan
        rows.add_row(
            point.label, ProgressBar(total=1.0, completed=progress.fraction, width=16), f"{progress.fraction:.0%}",
            duration(left), progress.mean,
        )  # fmt: skip
    if len(under_way) > _MOST_ROWS:
        rows.add_row(f"and {len(under_way) - _MOST_ROWS} more")
    failed = [Text(f"failed: {name}: {why}", style="red") for name, why in list(schedule.failures.items())[:3]]
    return Group(bar, rows, *failed)


def summary(schedule: Schedule) -> str:
    """Where the study stands, in a line."""
    done, total = len(schedule.summaries), len(schedule.points)
    under_way = sum(1 for name in schedule.running if schedule.states[name].kind == "running")
    parts = [f"{done} of {total} runs done", f"{under_way} under way"]
    if schedule.failures:
        parts.append(f"{len(schedule.failures)} failed")
    if schedule.until is not None:
        parts.append(f"adaptive for another {duration(max(0.0, schedule.until - time.monotonic()))}")
    elif math.isfinite(left := schedule.seconds_left):
        parts.append(f"about {duration(left)} left")
    return ", ".join(parts)


def duration(seconds: float) -> str:
    """Hours, minutes and seconds; days where it takes them."""
    return str(timedelta(seconds=round(seconds))) if math.isfinite(seconds) else "?"


class _Lines:
    """A line for the log, every so many seconds."""

    def __init__(self) -> None:
        self._last = time.monotonic()

    def __call__(self, schedule: Schedule) -> None:
        if time.monotonic() - self._last >= _SECONDS_BETWEEN_LINES:
            self._last = time.monotonic()
            print(summary(schedule), file=sys.stderr, flush=True)
