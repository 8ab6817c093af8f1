"""Identity: what makes two runs the same, and the seeds of runs that are to differ in nothing else."""

from __future__ import annotations

import hashlib
import json
from typing import Any

from tether.config import Configuration
from tether.model import Model

_WRITTEN_ONLY = ("checkpoint", "frames", "fields")
"""Keys of [output] that change what is written on the way, and no result."""

_SEED_BITS = 48  # enough never to meet, few enough for every program that reads the tables


def identity(configuration: Configuration) -> str:
    """A name for whatever the results of a run depend on, 16 hexadecimal digits.

    Keys that have their default do not count, so that a run keeps its name when tether learns new ones.
    """
    return _digest(_contents(configuration))[:16]


def seed_of(configuration: Configuration, repeat: int) -> int:
    """The seed of a repeat: of the configuration's seed, of whatever else is in it, and of the repeat's number.

    Runs of different configurations thereby share no noise, and adding runs to a study changes none of the others.
    """
    contents = _contents(configuration)
    seed = contents.pop("seed", 0)
    return int(_digest([contents, seed, repeat])[: _SEED_BITS // 4], 16)


def _contents(configuration: Configuration) -> dict[str, Any]:
    contents: dict[str, Any] = _plain(configuration)
    output = contents.get("output", {})
    for name in _WRITTEN_ONLY:
        output.pop(name, None)
    if not output:
        contents.pop("output", None)
    return contents


def _plain(item: Any) -> Any:
    """Models as tables of the keys whose value is not the default; a `kind` always counts, it says what the rest is."""
    if isinstance(item, Model):
        fields = type(item).model_fields
        values = {name: getattr(item, name) for name in fields}
        return {
            name: _plain(value)
            for name, value in values.items()
            if name == "kind" or value != fields[name].get_default(call_default_factory=True)
        }
    return [_plain(inner) for inner in item] if isinstance(item, list | tuple) else item


def _digest(contents: Any) -> str:
    return hashlib.sha256(json.dumps(contents, sort_keys=True, allow_nan=False).encode()).hexdigest()
