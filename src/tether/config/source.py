"""Source: a configuration file, what the command line changes in it, and where each key was written."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from tether import toml
from tether.config import overrides as command_line
from tether.config import text
from tether.config.configuration import Configuration
from tether.errors import InputError, Key, TetherError
from tether.explain import explain

Failure = TypeVar("Failure", bound=TetherError)


def load(path: str | Path, overrides: Sequence[str] = (), seed: int | None = None) -> Configuration:
    """Read a configuration file.

    overrides: "section.key=value" each, the value in TOML; a word that is no TOML is text. One of two keys
    that exclude each other (steps and strain, say) replaces the other one.
    seed: replaces the file's.

    Raises InputError: file, line, key, what is wrong and why, what to do.
    """
    return Source.read(path, overrides, seed).configuration()


@dataclass(frozen=True)
class Place:
    """Where a key was written; `line` puts errors in the order of reading."""

    words: str
    line: int


@dataclass(frozen=True)
class Source:
    """What was written (`values`), and where (`places`)."""

    path: Path
    values: dict[str, Any]
    places: dict[Key, Place] = field(repr=False)

    @classmethod
    def read(cls, path: str | Path, overrides: Sequence[str] = (), seed: int | None = None) -> Source:
        """Read a file and apply overrides; nothing but TOML is checked yet. Raises InputError."""
        path = Path(path)
        values, lines = text.read(path)
        _anchor(values, path.parent)
        source = cls(path, values, {key: Place(f"{path}, line {line}", line) for key, line in lines.items()})
        source._override(overrides)
        if seed is not None:
            values["seed"] = seed
            source._moved(("seed",), f"--seed {seed}")
        return source

    def configuration(self) -> Configuration:
        """The checked configuration. Raises InputError."""
        try:
            return Configuration.model_validate(self.values)
        except ValidationError as error:
            faults = explain(Configuration, error)
        first = min(faults, key=lambda fault: self._place(fault.key).line)
        raise first.at(self._place(first.key).words, more=len(faults) - 1)

    def located(self, error: Failure) -> Failure:
        """The same error with the place of its key in front, if it names a key."""
        return error.at(self._place(error.key).words, error.more) if error.key and not error.place else error

    def _override(self, overrides: Sequence[str]) -> None:
        keys = []
        for override in overrides:
            words = f"--set {override if override.isprintable() else toml.value(override)}"
            try:
                parts, value = command_line.parse(override)
                if parts == ["start", "file"] and isinstance(value, str) and value:
                    value = str(Path(value).absolute())
                keys.append(command_line.assign(self.values, parts, value))
            except InputError as error:
                raise error.at(words) from None
            self._moved(keys[-1], words)
        command_line.drop_rivals(self.values, keys)

    def _moved(self, key: Key, words: str) -> None:
        """A key, with all below it, is now somewhere else than in the file."""
        for known in [known for known in self.places if known[: len(key)] == key]:
            del self.places[known]
        self.places[key] = Place(words, sys.maxsize)

    def _place(self, key: Key) -> Place:
        """Where the key, or else the closest table around it, was written."""
        while key and key not in self.places:
            key = key[:-1]
        return self.places.get(key, Place(str(self.path), 0))


def _anchor(values: dict[str, Any], folder: Path) -> None:
    """The start's file is relative to the folder of the configuration."""
    start = values.get("start")
    if isinstance(start, dict) and isinstance(start.get("file"), str) and start["file"]:
        start["file"] = str((folder / start["file"]).absolute())
