"""The folder of a study: what was asked, a folder for each run, and what came out."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from tether.errors import InputError
from tether.files.lock import is_locked, locked
from tether.files.whole import whole
from tether.record import Record, reason
from tether.study.study import Point, Study
from tether.version import __version__

_MARK = "# tether study "
"""How study.toml begins: no other folder is written into."""

_PROGRESS = "progress.json"


@dataclass(frozen=True)
class Progress:
    """How far a run has come: written by whoever runs it, read by whoever wants to know."""

    step: int
    """Steps done, equilibration included."""
    end: int
    """Steps in all."""
    seconds: float
    """Wall-clock time since it was begun or resumed, seconds."""
    done: int = 0
    """Steps done in that time."""
    mean: str = ""
    """The running mean that a user looks for, in words; empty while there is none."""
    failure: str = ""
    """Why it failed, in a sentence; empty if it did not."""

    @property
    def fraction(self) -> float:
        """Part of the steps that is done, from 0 to 1."""
        return min(1.0, self.step / self.end) if self.end else 0.0

    @property
    def rate(self) -> float:
        """Steps per second; 0 before anything is known."""
        return self.done / self.seconds if self.seconds > 0 else 0.0

    def write(self, folder: Path) -> None:
        """Put it into a run's folder. It may be lost with the machine's power, and nothing depends on it."""
        path = folder / _PROGRESS
        part = path.with_name(f".{_PROGRESS}.part")
        part.write_text(json.dumps(asdict(self)), encoding="utf-8")
        part.replace(path)

    @staticmethod
    def forget(folder: Path) -> None:
        """Take it out of a run's folder."""
        (folder / _PROGRESS).unlink(missing_ok=True)

    @classmethod
    def read(cls, folder: Path) -> Progress | None:
        """What a run's folder says; None where it says nothing."""
        try:
            return cls(**json.loads((folder / _PROGRESS).read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None


Kind = Literal["waiting", "running", "interrupted", "done", "failed"]


@dataclass(frozen=True)
class State:
    """Where a run stands."""

    kind: Kind
    progress: Progress | None = None


class StudyFolder:
    """A folder that holds study.toml, points/NAME (a run's folder each), results.* and pictures."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.study_path = folder / "study.toml"
        self.points_path = folder / "points"
        self.stop_path = folder / ".stop"

    @classmethod
    def create(cls, folder: Path, study: Study, points: Path | None = None) -> StudyFolder:
        """The folder of a study, new or with what earlier ones have run in it.

        points: a folder of runs that several studies share, if it is not to have one of its own. Raises InputError.
        """
        made = cls(folder)
        try:
            if folder.exists() and not folder.is_dir():
                raise InputError(f"{folder} is a file", "a study writes a folder", "choose another with --out")
            if (
                folder.is_dir()
                and any(path for path in folder.iterdir() if path.name[0] != ".")
                and not made._is_ours()
            ):
                raise InputError(
                    f"{folder} exists and is no folder of a study", "what it holds is left alone",
                    "choose another with --out",
                )  # fmt: skip
            folder.mkdir(parents=True, exist_ok=True)
            text = f"{_MARK}of tether {__version__}: what was asked, with its base.\n{study.to_toml()}"
            if not made.study_path.is_file() or made.study_path.read_text(encoding="utf-8") != text:
                # Not while another study goes on in it.
                with locked(folder), whole(made.study_path) as temporary:
                    temporary.write_text(text, encoding="utf-8")
            if points is not None:
                points.mkdir(parents=True, exist_ok=True)
                if not made.points_path.is_symlink():
                    made.points_path.symlink_to(os.path.relpath(points, folder))
            made.points_path.mkdir(exist_ok=True)
        except OSError as error:
            raise InputError(f"{folder} cannot be written", reason(error), "choose another with --out") from None
        return made

    @classmethod
    def open(cls, folder: Path) -> StudyFolder:
        """The folder of an earlier study. Raises InputError when it is none."""
        made = cls(folder)
        if not made._is_ours():
            raise InputError(
                f"{folder} is no folder of a study",
                "it has no study.toml of tether",
                "name one that tether study wrote",
            )
        return made

    def study(self) -> Study:
        """What was asked."""
        return Study.read(self.study_path)

    def path(self, point: Point) -> Path:
        """The folder of a run."""
        return self.points_path / point.identity

    def state(self, point: Point) -> State:
        """Where a run stands."""
        folder = self.path(point)
        if (folder / "summary.json").is_file():
            return State("done")
        progress = Progress.read(folder)
        if progress is None:
            return State("waiting")
        if is_locked(folder):
            return State("running", progress)
        return State("failed" if progress.failure else "interrupted", progress)

    def summary(self, point: Point) -> dict[str, Any]:
        """What summary.json of a finished run holds."""
        return Record(self.path(point)).summary()

    def states(self, points: list[Point]) -> dict[str, State]:
        """Where runs stand, by their identities."""
        try:
            begun = {entry.name for entry in os.scandir(self.points_path)}
        except FileNotFoundError:
            begun = set()
        return {p.identity: self.state(p) if p.identity in begun else State("waiting") for p in points}

    def others(self, points: list[Point]) -> int:
        """How many runs are here that the study does not ask for now: they are kept, and used if it asks again."""
        asked = {point.identity for point in points}
        return sum(1 for entry in os.scandir(self.points_path) if entry.is_dir() and entry.name not in asked)

    @contextmanager
    def held(self) -> Iterator[None]:
        """Keep a second study out of the folder, and take back a stop that was asked of an earlier one."""
        with locked(self.folder):
            self.stop_path.unlink(missing_ok=True)
            yield

    def ask_to_stop(self) -> None:
        """Let every run of this study that goes on anywhere end at a checkpoint."""
        self.stop_path.write_text(f"{time.time():.0f}\n", encoding="utf-8")

    def _is_ours(self) -> bool:
        try:
            with self.study_path.open(encoding="utf-8") as file:
                return file.readline().startswith(_MARK)
        except (OSError, UnicodeDecodeError):
            return False
