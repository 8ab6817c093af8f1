"""Reproducing exhibits: running what they need, once for all of them, and keeping what came out."""

from __future__ import annotations

import platform
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path

from tether.paper.exhibit import Exhibit, Findings, Part, Size
from tether.study.executors import OpenCrew
from tether.study.folder import StudyFolder
from tether.study.schedule import Schedule
from tether.study.study import Ensemble, Point, Study
from tether.version import __version__

_POINTS = "points"


class Together:
    """Several studies as one: every run once, whichever of them ask for it."""

    stop_when = None

    def __init__(self, studies: Sequence[Study]) -> None:
        self.studies = studies
        self.repeats = max((study.repeats for study in studies), default=1)

    @cached_property
    def points(self) -> list[Point]:
        """Each run once."""
        found = {point.identity: point for study in self.studies for point in study.points}
        return list(found.values())

    @cached_property
    def all_ensembles(self) -> list[Ensemble]:
        """Those that the runs are of."""
        return list({id(point.ensemble): point.ensemble for point in self.points}.values())


class Workshop:
    """The folder of the runs behind exhibits: SIZE/NAME-PART is a study's folder, and all share the runs in points/."""

    def __init__(self, folder: Path, size: Size) -> None:
        self.folder = folder
        self.size = size

    def part(self, exhibit: Exhibit, name: str, study: Study) -> Part:
        """The folder of a study."""
        folder = self.folder / self.size / (f"{exhibit.name}-{name}" if name else exhibit.name)
        return Part(study, StudyFolder.create(folder, study, self.folder / _POINTS))

    def parts(self, exhibit: Exhibit) -> dict[str, Part]:
        """All studies of an exhibit."""
        return {name: self.part(exhibit, name, study) for name, study in exhibit.studies(self.size).items()}

    def schedule(self, wanted: Sequence[Exhibit], threads: int) -> Schedule:
        """All runs that some exhibits need, for one schedule: the longest first, whichever they belong to."""
        studies = [study for exhibit in wanted for study in exhibit.studies(self.size).values()]
        for exhibit in wanted:
            self.parts(exhibit)
        (self.folder / _POINTS).mkdir(parents=True, exist_ok=True)
        return Schedule(Together(studies), StudyFolder(self.folder), threads)

    def run(self, schedule: Schedule, crew: OpenCrew, watch: Callable[[Schedule], None] | None) -> None:
        """Do what is to be done."""
        schedule.run(crew, watch)


def finished(exhibit: Exhibit, workshop: Workshop, into: Path, command: str) -> Findings:
    """Evaluate an exhibit's runs, and keep what they say in a folder."""
    parts = workshop.parts(exhibit)
    findings = exhibit.evaluate(parts)
    made = {
        "command": command,
        "version": __version__,
        "date": datetime.now(UTC).date().isoformat(),
        "size": workshop.size,
        "core_hours": sum(part.core_hours for part in parts.values()),
        "runs": sum(len(part.study.points) for part in parts.values()),
        "seeds": "made from the base's seed, the configuration and the repeat",
        "machine": f"{platform.machine()}, {platform.system()}",
    }
    exhibit.write(findings, into, workshop.size, made)
    return findings
