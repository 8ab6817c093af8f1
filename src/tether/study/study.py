"""Study: runs of one configuration with some of its keys varied."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from pydantic import Field, PrivateAttr, ValidationError, field_validator, model_validator

from tether import toml
from tether.config import Configuration, Interval, Source, StopWhen, text
from tether.config import overrides as command_line
from tether.config.schema import without_null
from tether.errors import InputError, Key
from tether.explain import explain
from tether.model import Model, fault
from tether.study.cost import cost
from tether.study.identity import identity, seed_of
from tether.study.sweep import Axis, Parts, Setting, axes_of, parts_of, settings

_MOST_REPEATS = 10_000


@dataclass(frozen=True)
class Ensemble:
    """Runs that differ in nothing but their seed: the repeats of one setting, or of a plain fluid to compare with."""

    configuration: Configuration
    """With the seed of the study's base."""
    label: str
    """The setting in words."""
    is_plain_fluid: bool = False

    def point(self, repeat: int) -> Point:
        """A run, numbered from 0."""
        return Point(self, repeat)


@dataclass(frozen=True)
class Point:
    """One run of a study."""

    ensemble: Ensemble
    repeat: int

    @cached_property
    def configuration(self) -> Configuration:
        """What is run: the ensemble's configuration with this repeat's seed."""
        configuration = self.ensemble.configuration
        return configuration.changed(seed=seed_of(configuration, self.repeat))

    @cached_property
    def identity(self) -> str:
        """The name of its folder: the same for the same configuration, whatever study it is in."""
        return identity(self.configuration)

    @cached_property
    def cost(self) -> float:
        """How long it takes, in proportion to other runs."""
        return cost(self.configuration)

    @property
    def label(self) -> str:
        """Which run this is, in words."""
        return f"{self.ensemble.label}, repeat {self.repeat}"


class Study(Model):
    """Runs of one configuration with some of its keys varied, each so many times."""

    base: dict[str, Any] = Field(
        examples=["couette.toml"],
        description="The configuration that is varied: the path of a file, relative to this one, or a table [base] "
        "that holds its tables.",
    )
    set: dict[str, Any] = Field(
        default={},
        examples=[{"run": {"steps": 100000}}],
        description="Keys of the base that have another value in this study.",
    )
    sweep: dict[str, Any] = Field(
        default={},
        examples=[{"flow": {"shear_rate": [0.1, 0.2]}}],
        description="Keys of the base and the values that they take: a list, {linspace = [first, last, number]}, or "
        "{logspace = [first, last, number]} with the ends themselves. All combinations of keys are run; keys in one "
        "[[sweep.zip]] change together.",
    )
    repeats: int = Field(
        default=1,
        ge=1,
        le=_MOST_REPEATS,
        examples=[4],
        description="How many runs of each combination, which differ in their seed.",
    )
    stop_when: StopWhen | None = Field(
        default=None,
        examples=[{"viscosity": 0.01}],
        description="No more repeats of a combination are begun once the mean over them has these relative standard "
        "errors.",
    )
    relative: bool = Field(
        default=False,
        description="Whether the same fluid without bodies is run too, as often, for the relative viscosity.",
    )

    _places: dict[Key, str] = PrivateAttr(default_factory=dict)
    """Where each key was written, for messages."""

    @classmethod
    def read(cls, path: str | Path, overrides: Sequence[str] = ()) -> Self:
        """Read a study file. overrides: changes to its [set], "section.key=value" each.

        Raises InputError: file, line, key, what is wrong and why, what to do.
        """
        path = Path(path)
        values, lines = text.read(path)
        places = {key: f"{path}, line {line}" for key, line in lines.items()}
        base: Source | None = None
        if isinstance(values.get("base"), str):
            base = _source(path.parent / values["base"], places[("base",)])
            values["base"] = base.values
        for override in overrides:
            key = _override(values, override)
            places[("set", *key)] = f"--set {override}"
        try:
            study = cls.model_validate(values)
            if base is not None:
                places |= {("base", *key): place.words for key, place in base.places.items()}
            study._places.update(places)
            study.check()
        except ValidationError as error:
            first, *others = explain(cls, error)
            raise first.at(_place(places, first.key) or str(path), more=len(others)) from None
        except InputError as error:
            raise error if error.place else error.at(_place(places, error.key) or str(path)) from None
        return study

    @field_validator("base", mode="before")
    @classmethod
    def _base_in_any_form(cls, given: Any) -> Any:
        """Python gives a Configuration or a path as well."""
        if isinstance(given, Configuration):
            return given.given()
        if isinstance(given, str | Path):
            return Source.read(given).values
        if not isinstance(given, dict):
            problem = f"= {toml.value(given)} is neither the path of a configuration nor a table"
            raise fault((), problem, "a study varies a configuration", 'give one, for example base = "couette.toml"')
        return given

    @model_validator(mode="after")
    def _checked(self) -> Self:
        if self.repeats == 1 and self.stop_when is not None:
            why = "the error of a mean over repeats falls with their number"
            remedy = "give repeats, the most there may be, or put it into [set] measure.stop_when to end each run"
            raise fault(("stop_when",), "has one run to look at", why, remedy)
        self.axes  # noqa: B018  # raises InputError where the sweep is none
        return self

    @cached_property
    def axes(self) -> tuple[Axis, ...]:
        """The dimensions of the study, in the order of its sweep."""
        return axes_of(self.sweep)

    @cached_property
    def settings(self) -> list[Setting]:
        """All combinations of values, the last axis changing fastest."""
        return settings(self.axes)

    @cached_property
    def ensembles(self) -> list[Ensemble]:
        """One for each setting, in their order. Raises InputError when one of them cannot be run."""
        return [
            Ensemble(self._configuration(setting), str(setting) or "the base as it is") for setting in self.settings
        ]

    @cached_property
    def plain_fluids(self) -> list[Ensemble | None]:
        """For each setting the same fluid without bodies, where the study compares with it; the same one where it is
        the same."""
        if not self.relative:
            return [None] * len(self.settings)
        found: dict[str, Ensemble] = {}
        plain: list[Ensemble | None] = []
        for ensemble in self.ensembles:
            configuration = ensemble.configuration.plain_fluid()
            if not ensemble.configuration.bodies or configuration.flow.shear_rate == 0:
                plain.append(None)
                continue
            name = identity(configuration)
            label = f"plain fluid, shear rate {configuration.flow.shear_rate:g}"
            label += f", temperature {configuration.fluid.temperature:g}"
            plain.append(found.setdefault(name, Ensemble(configuration, label, is_plain_fluid=True)))
        if not found:
            raise InputError(
                "relative = true needs bodies and a steady shear flow",
                "it divides the viscosity by that of the same fluid without bodies", "take it out", key=("relative",),
            )  # fmt: skip
        return plain

    @cached_property
    def all_ensembles(self) -> list[Ensemble]:
        """The settings' and then the plain fluids', each once."""
        plain = {id(each): each for each in self.plain_fluids if each is not None}
        return [*self.ensembles, *plain.values()]

    @cached_property
    def points(self) -> list[Point]:
        """Every run that is asked for, in the order that `run-point` numbers them: first the first repeat of all."""
        return [each.point(repeat) for repeat in range(self.repeats) for each in self.all_ensembles]

    def check(self) -> None:
        """Raise InputError when something in the study cannot be run, or is in it twice."""
        seen: dict[str, Ensemble] = {}
        for ensemble in self.all_ensembles:
            first = seen.setdefault(identity(ensemble.configuration), ensemble)
            if first is not ensemble:
                raise InputError(
                    f"{ensemble.label} and {first.label} are the same run",
                    "their configurations come out alike", "take one out of the sweep", key=("sweep",),
                )  # fmt: skip

    def to_toml(self) -> str:
        """The study as a file that stands by itself, its base in it."""
        return toml.document(self.model_dump(exclude_unset=True, exclude_none=True))

    def _configuration(self, setting: Setting) -> Configuration:
        """The base with what [set] and the sweep change. Raises InputError that names the place of its cause."""
        values = copy.deepcopy(self.base)
        changes = [*_leaves(self.set), *setting.changes()]
        caused: dict[Key, Key] = {}
        for parts, value, written in changes:
            if parts == ("seed",) and written[0] == "sweep":
                why = "the seeds of repeats are made from the base's"
                raise InputError("seed cannot be swept", why, "give repeats instead", key=written)
            try:
                caused[command_line.assign(values, parts, copy.deepcopy(value))] = written
            except InputError as error:
                raise InputError(error.problem, error.why, error.remedy, key=written) from None
        command_line.drop_rivals(values, caused)
        try:
            return _without_frames(Configuration.model_validate(values))
        except ValidationError as error:
            first, *others = explain(Configuration, error)
        cause = _nearest(caused, first.key)
        where = _place(self._places, cause if cause is not None else ("base", *first.key))
        at = f"at {setting}" if setting.axes else ""
        raise InputError(
            first.problem, first.why, first.remedy, key=cause or ("base", *first.key),
            place=", ".join(each for each in (where, at) if each), more=len(others),
        )  # fmt: skip


def json_schema() -> dict[str, Any]:
    """The JSON schema of study files, draft 2020-12. What is swept is checked by the configuration that it makes."""
    schema: dict[str, Any] = without_null(Study.model_json_schema())
    base = schema["properties"]["base"]
    schema["properties"]["base"] = {
        "anyOf": [{"type": "string"}, {"type": "object"}],
        **{name: item for name, item in base.items() if name not in ("type", "additionalProperties")},
    }
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "tether study"}


def _without_frames(configuration: Configuration) -> Configuration:
    """The first and the last frame of the trajectory only, unless asked for: a study has many runs."""
    output = configuration.output
    if output.frames is not None:
        return configuration
    return configuration.changed(output=output.changed(frames=Interval(steps=configuration.steps)))


def _source(path: Path, place: str) -> Source:
    try:
        return Source.read(path)
    except InputError as error:
        raise error if error.place else error.at(place) from None


def _override(values: dict[str, Any], override: str) -> Key:
    """Put an override into the [set] of a study's values."""
    try:
        parts, value = command_line.parse(override)
        table = values.setdefault("set", {})
        if not isinstance(table, dict):
            raise InputError("set is not a table", "it holds keys of the base", "write [set]", key=("set",))
        # [set] is all tables, whatever the base has there: bodies.0.count is a key in a table "0".
        for part in parts[:-1]:
            inner = table.setdefault(part, {})
            table[part] = table = inner if isinstance(inner, dict) else {}
        table[parts[-1]] = value
    except InputError as error:
        raise error.at(f"--set {override}") from None
    return tuple(parts)


def _leaves(table: Mapping[str, Any], key: Parts = (), place: Key = ("set",)) -> Iterator[tuple[Parts, Any, Key]]:
    """Every key below a table, its value, and its place. A table with a `kind` is a value: kinds differ in keys."""
    for name, item in table.items():
        inner, there = (*key, *parts_of(name)), (*place, name)
        if not isinstance(item, dict) or not item or "kind" in item:
            yield inner, item, there
        else:
            yield from _leaves(item, inner, there)


def _nearest(caused: Mapping[Key, Key], key: Key) -> Key | None:
    """Where the value of a key, or of what is around it or within it, was set by the study; None if it was not."""
    for length in range(len(key), 0, -1):
        if key[:length] in caused:
            return caused[key[:length]]
    return next((written for known, written in caused.items() if known[: len(key)] == key and key), None)


def _place(places: Mapping[Key, str], key: Key) -> str:
    """Where the key, or else the closest table around it, was written."""
    while key and key not in places:
        key = key[:-1]
    return places.get(key, "")
