"""Exhibit: a table or figure of the paper, in a folder of its own: the studies behind it, what they say, the picture.

A folder paper/NAME/ holds

    exhibit.py       title and text (its docstring), evaluate(parts) -> Findings, panels(findings) -> panels, and
                     draw(findings, stem) -> paths where panels will not do
    SIZE.toml, SIZE-PART.toml     the studies of each size; none where nothing is simulated

and gets, from `tether paper NAME`, the tables behind it (SIZE-TABLE.csv), its claims and how all was made (SIZE.json),
NAME.png and .svg, and README.md.
"""

from __future__ import annotations

import importlib.util
import inspect
import json
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import pandas as pd

from tether.errors import InputError
from tether.files.whole import whole
from tether.paper.claim import Claim, Verdict
from tether.paper.panel import Panel, draw_panels
from tether.record import Record
from tether.study.folder import StudyFolder
from tether.study.results import Results, results_of
from tether.study.study import Study

Size = Literal["smoke", "quick", "full"]


@dataclass(frozen=True)
class Part:
    """A study of an exhibit that has been run."""

    study: Study
    folder: StudyFolder

    @cached_property
    def results(self) -> Results:
        """Its tables and dataset."""
        return results_of(self.study, self.folder)

    @cached_property
    def records(self) -> list[tuple[dict[str, Any], Record]]:
        """Every finished run of a setting: swept values by dotted name, and "repeat"; and the run's folder."""
        found = []
        for setting, ensemble in zip(self.study.settings, self.study.ensembles, strict=True):
            for repeat in range(self.study.repeats):
                point = ensemble.point(repeat)
                record = Record(self.folder.path(point))
                if record.summary_path.is_file():
                    found.append(({**setting.values, "repeat": repeat}, record))
        return found

    @property
    def core_hours(self) -> float:
        """What its runs have cost."""
        seconds = 0.0
        for point in self.study.points:
            path = Record(self.folder.path(point)).summary_path
            if path.is_file():
                performance = json.loads(path.read_text(encoding="utf-8"))["performance"]
                seconds += performance["seconds"] * performance["threads"]
        return seconds / 3600.0


@dataclass(frozen=True)
class Findings:
    """What an exhibit shows, and what became of the paper's claims."""

    tables: Mapping[str, pd.DataFrame]
    """Small tables, every number with its error; by a word each. They are kept, and the picture is drawn from them."""
    claims: Sequence[Claim]
    notes: Sequence[str] = field(default_factory=list)
    """Sentences for the reader: series that are not available, what is not shown."""


class Exhibit:
    """A folder of paper/."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.name = folder.name

    @cached_property
    def module(self) -> ModuleType:
        """Its exhibit.py."""
        path = self.folder / "exhibit.py"
        spec = importlib.util.spec_from_file_location(f"tether_paper_{self.name}", path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module  # where dataclasses look for it
        spec.loader.exec_module(module)
        return module

    @property
    def title(self) -> str:
        """The first line of its docstring."""
        return (self.module.__doc__ or self.name).strip().splitlines()[0].rstrip(".")

    @property
    def text(self) -> str:
        """The rest of its docstring, Markdown."""
        return "\n".join(inspect.cleandoc(self.module.__doc__ or "").splitlines()[1:]).strip()

    def studies(self, size: Size) -> dict[str, Study]:
        """The studies behind it, by their parts; "" where there is only one. Raises InputError."""
        paths = sorted(self.folder.glob(f"{size}*.toml"))
        return {path.stem.removeprefix(size).removeprefix("-"): Study.read(path) for path in paths}

    def evaluate(self, parts: Mapping[str, Part]) -> Findings:
        """What its runs say."""
        findings: Findings = self.module.evaluate(parts)
        return findings

    def panels(self, findings: Findings) -> list[Panel]:
        """What its figure shows, where panels do."""
        panels: list[Panel] = self.module.panels(findings) if hasattr(self.module, "panels") else []
        return panels

    def draw(self, findings: Findings, folder: Path) -> list[Path]:
        """Draw the figure, if it has one; returns the paths."""
        if hasattr(self.module, "draw"):
            paths: list[Path] = self.module.draw(findings, folder / self.name)
            return paths
        panels = self.panels(findings)
        return draw_panels(panels, folder / self.name) if panels else []

    # --- what is kept ---

    def write(self, findings: Findings, folder: Path, size: Size, made: Mapping[str, Any]) -> list[Path]:
        """Write tables, claims, figure and README into a folder."""
        folder.mkdir(parents=True, exist_ok=True)
        for path in folder.glob(f"{size}-*.csv"):
            path.unlink()
        for name, table in findings.tables.items():
            with whole(folder / f"{size}-{name}.csv") as temporary:
                table.to_csv(temporary, index=False, float_format="%.6g")
        kept = {
            "made": dict(made),
            "tables": list(findings.tables),
            "claims": [claim.as_dict() for claim in findings.claims],
            "notes": list(findings.notes),
        }
        with whole(folder / f"{size}.json") as temporary:
            temporary.write_text(json.dumps(kept, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        paths = self.draw(findings, folder)
        for path in paths:
            if path.suffix == ".png":
                _shrink(path)
        with whole(folder / "README.md") as temporary:
            temporary.write_text(self._readme(findings, made, paths), encoding="utf-8")
        return paths

    def kept(self, folder: Path, size: Size) -> tuple[Findings, dict[str, Any]]:
        """What `write` has kept, and how it was made. Raises InputError where there is none."""
        path = folder / f"{size}.json"
        if not path.is_file():
            raise InputError(
                f"{path} does not exist", f"{self.name} has not been made at this size", f"tether paper {self.name}"
            )
        kept = json.loads(path.read_text(encoding="utf-8"))
        tables = {name: pd.read_csv(folder / f"{size}-{name}.csv") for name in kept["tables"]}
        claims = [Claim.from_dict(entry) for entry in kept["claims"]]
        return Findings(tables, claims, kept["notes"]), kept["made"]

    def _readme(self, findings: Findings, made: Mapping[str, Any], pictures: Sequence[Path]) -> str:
        lines = [f"# {self.title}", "", self.text, ""]
        lines += [f"![{self.title}]({path.name})\n" for path in pictures if path.suffix == ".png"]
        lines += ["## What we get", "", *_claims(findings.claims), ""]
        lines += [f"- {note}" for note in findings.notes]
        if findings.notes:
            lines.append("")
        lines.append(
            f"Made by `{made['command']}`, tether {made['version']}, {made['date']}; "
            f"{made['core_hours']:.2g} core-hours."
        )
        return "\n".join(lines) + "\n"


def _shrink(path: Path) -> None:
    """Give a picture 256 colors, which is enough for lines and points, and a third of the bytes to keep."""
    from PIL import Image

    with Image.open(path) as picture:
        picture.convert("RGB").quantize(256).save(path, optimize=True)


def _claims(claims: Sequence[Claim]) -> list[str]:
    rows = ["| the paper | | measured | verdict | rule |", "|---|---|---|---|---|"]
    for claim in claims:
        verdict = f"**{claim.verdict}**" + (f": {claim.remark}" if claim.remark else "")
        if claim.verdict is Verdict.UNDECIDED and claim.core_hours is not None:
            verdict += f" ({claim.core_hours:.2g} core-hours would decide)"
        cells = (claim.text, claim.source, claim.measured, verdict, claim.rule)
        rows.append("| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |")
    return rows


def exhibits(folder: Path) -> list[Exhibit]:
    """All exhibits in the folder `paper`, in the paper's order. Raises InputError when it is none."""
    found = [Exhibit(path.parent) for path in folder.glob("*/exhibit.py")]
    if not found:
        raise InputError(
            f"{folder} holds no tables and figures of the paper", "they come with tether's source, not its package",
            "go to the checkout, or name its folder: --paper DIR",
        )  # fmt: skip
    return sorted(found, key=lambda exhibit: _order(exhibit.name))


def _order(name: str) -> tuple[int, float, str]:
    """Tables, then figures by their numbers, then sections."""
    kinds = ("table", "fig", "section")
    kind = next((number for number, each in enumerate(kinds) if name.startswith(each)), len(kinds))
    digits = "".join(each for each in name if each.isdigit() or each == ".")
    return kind, float(digits.strip(".")) if digits.strip(".") else math.inf, name
