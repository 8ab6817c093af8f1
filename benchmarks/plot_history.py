"""Draw the results in benchmarks/history: `python -m benchmarks.plot_history [FILE.png]`.

Left: how many times as fast as LAMMPS, with the spread over turns and what we aim at. Right: the time that a particle
takes in one step, over the number of particles. The newest result is in colour, older ones are grey.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from benchmarks.cases import SIZES

_ROOT = Path(__file__).parent.parent
_HISTORY = Path(__file__).parent / "history"
_PICTURE = _ROOT / "docs" / "_static" / "benchmarks.png"

# Two of Okabe and Ito's colours, which everyone can tell apart; the markers differ as well.
_STYLE = {"mixed": ("#0072B2", "o"), "double": ("#D55E00", "s")}
_OLDER = "#BBBBBB"

Result = dict[str, Any]


def results() -> list[Result]:
    """Those with a table, the oldest first."""
    files = [json.loads(file.read_text(encoding="utf-8")) for file in sorted(_HISTORY.glob("*.json"))]
    return sorted((result for result in files if result.get("rows")), key=lambda result: result["date"])


def _draw_ratios(axes: Axes, newest: Result, older: list[Result]) -> None:
    rows = [row for row in newest["rows"] if row["baseline"] == "LAMMPS"]
    names = [f"{row['case'].partition(';')[0]}, {row['detail']}" for row in rows]
    for result in older:
        before = {(row["case"], row["detail"]): row["ratio"] for row in result["rows"] if row["baseline"] == "LAMMPS"}
        for height, row in enumerate(rows):
            if ratio := before.get((row["case"], row["detail"])):
                axes.plot(ratio, height, "o", color=_OLDER, markersize=4)
    for height, row in enumerate(rows):
        color, marker = _STYLE[row["manner"]["precision"]]
        axes.plot(row["spread"], [height, height], color=color, linewidth=2)
        axes.plot(row["ratio"], height, marker, color=color)
        if row["least_ratio"]:
            axes.plot([row["least_ratio"]] * 2, [height - 0.35, height + 0.35], color="black", linewidth=1)
    axes.set_yticks(range(len(rows)), names)
    axes.invert_yaxis()
    axes.set_xlim(left=0)
    axes.set_xlabel("speed of tether / speed of LAMMPS, one core (bar: aim)")
    axes.grid(axis="x", alpha=0.3)


def _draw_sizes(axes: Axes, newest: Result, older: list[Result]) -> None:
    for result in [*older, newest]:
        rows = [row for row in result["rows"] if row["case"].startswith(SIZES)]
        color, marker = _STYLE["mixed"] if result is newest else (_OLDER, "o")
        nanoseconds = [1e3 / row["speed"] for row in rows]
        axes.plot([row["particles"] for row in rows], nanoseconds, f"{marker}-", color=color)
    axes.set_xscale("log")
    axes.set_ylim(bottom=0)
    axes.set_xlabel("particles (plain 3D fluid, s = 1/2, mixed precision, one core)")
    axes.set_ylabel("time per particle and step (ns)")
    axes.grid(alpha=0.3)


def draw(to: Path) -> None:
    """Write the picture. Raises SystemExit when there is no result."""
    all_results = results()
    if not all_results:
        raise SystemExit(f"there is no result with a table in {_HISTORY.name}/")
    *older, newest = all_results
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.5), layout="constrained")
    _draw_ratios(left, newest, older)
    _draw_sizes(right, newest, older)
    figure.suptitle(f"{newest['date']}, {newest['cpu']}, tether {newest['commit']}, LAMMPS {newest['lammps']}")
    figure.savefig(to, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m benchmarks.plot_history", description=__doc__)
    parser.add_argument("file", type=Path, nargs="?", default=_PICTURE, help="where the picture goes")
    draw(parser.parse_args().file)
