"""Sweep: what a study varies, and in which combinations."""

from __future__ import annotations

import difflib
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tether import toml
from tether.config.lines import split
from tether.errors import InputError, Key

Parts = tuple[str, ...]
"""A key of a configuration, for example ("bodies", "0", "count")."""

_SPACINGS = ("linspace", "logspace")
_ZIP = "zip"
_MOST_VALUES = 100_000


@dataclass(frozen=True)
class Axis:
    """One dimension of a study: keys that change together, and the values that they take one after the other."""

    keys: tuple[Parts, ...]
    values: tuple[tuple[Any, ...], ...]
    """One tuple a key, all of the same length."""
    written: tuple[Key, ...]
    """Where each key's values stand in the study: ("sweep", "flow", "shear_rate"), for example."""

    def __len__(self) -> int:
        return len(self.values[0])

    @property
    def names(self) -> tuple[str, ...]:
        """The keys, dotted. The first names the dimension."""
        return tuple(toml.dotted(key) for key in self.keys)

    @property
    def name(self) -> str:
        """The name of the dimension: its first key, dotted."""
        return self.names[0]


@dataclass(frozen=True)
class Setting:
    """One combination of values: a place on every axis."""

    axes: tuple[Axis, ...]
    places: tuple[int, ...]

    def changes(self) -> Iterator[tuple[Parts, Any, Key]]:
        """Each key, its value, and where the value stands in the study."""
        for axis, place in zip(self.axes, self.places, strict=True):
            for key, values, written in zip(axis.keys, axis.values, axis.written, strict=True):
                yield key, values[place], (*written, place)

    @property
    def values(self) -> dict[str, Any]:
        """The value of every swept key, by its dotted name."""
        return {toml.dotted(key): value for key, value, _ in self.changes()}

    def __str__(self) -> str:
        return ", ".join(f"{name.split('.')[-1]} = {_short(value)}" for name, value in self.values.items())


def settings(axes: Sequence[Axis]) -> list[Setting]:
    """All combinations, the last axis changing fastest. Without axes that is one."""
    ranges = [range(len(axis)) for axis in axes]
    return [Setting(tuple(axes), places) for places in itertools.product(*ranges)]


def axes_of(sweep: Mapping[str, Any]) -> tuple[Axis, ...]:
    """The axes of a [sweep] table, in its order: a key is one, and so is each [[sweep.zip]]. Raises InputError."""
    axes = []
    for name, item in sweep.items():
        if name != _ZIP:
            axes += [_single(key, values, written) for key, values, written in _ranges({name: item}, ())]
        else:
            axes += [_zipped(table, number) for number, table in enumerate(_tables(item))]
    _check_once(axes)
    if math.prod(len(axis) for axis in axes) > _MOST_VALUES:
        number = math.prod(len(axis) for axis in axes)
        raise InputError(
            f"sweep makes {number} combinations", f"a study has at most {_MOST_VALUES}",
            "take out values, or let keys change together in [[sweep.zip]]", key=("sweep",),
        )  # fmt: skip
    return tuple(axes)


def _tables(item: Any) -> list[dict[str, Any]]:
    tables = [item] if isinstance(item, dict) else item
    if not isinstance(tables, list) or not tables or not all(isinstance(table, dict) and table for table in tables):
        raise InputError(
            "sweep.zip holds no tables of keys", "it lets keys change together",
            "write [[sweep.zip]] and the keys with their lists below it", key=("sweep", _ZIP),
        )  # fmt: skip
    return tables


def _single(key: Parts, values: tuple[Any, ...], written: Key) -> Axis:
    for number, value in enumerate(values):
        if value in values[:number]:
            problem = f"{toml.dotted(key)} has {toml.value(value)} twice"
            raise InputError(problem, "both would be the same point", "take one out", key=(*written, number))
    return Axis((key,), (values,), (written,))


def _zipped(table: dict[str, Any], number: int) -> Axis:
    ranges = list(_ranges(table, (_ZIP, number)))
    keys, values, written = zip(*ranges, strict=True)
    for key, each, place in zip(keys, values, written, strict=True):
        if len(each) != len(values[0]):
            raise InputError(
                f"{toml.dotted(key)} has {len(each)} values and {toml.dotted(keys[0])} has {len(values[0])}",
                "keys in one [[sweep.zip]] change together", "give lists of the same length", key=place,
            )  # fmt: skip
    together = list(zip(*values, strict=True))
    for number, combination in enumerate(together):
        if combination in together[:number]:
            problem = f"{toml.dotted(keys[0])} and the keys beside it have {toml.value(combination)} twice"
            raise InputError(problem, "both would be the same point", "take one out", key=(*written[0], number))
    return Axis(keys, values, written)


def _ranges(table: Mapping[str, Any], prefix: Key) -> Iterator[tuple[Parts, tuple[Any, ...], Key]]:
    """Every key below a table with its values, and where these stand."""
    written: Key = ("sweep", *prefix)

    def walk(item: Any, key: Parts, place: Key) -> Iterator[tuple[Parts, tuple[Any, ...], Key]]:
        if isinstance(item, dict) and item and not _is_spacing(item):
            for name, inner in item.items():
                yield from walk(inner, (*key, *parts_of(name)), (*place, name))
        else:
            yield key, _values(item, key, place), place

    for name, item in table.items():
        yield from walk(item, parts_of(name), (*written, name))


def _is_spacing(table: Mapping[str, Any]) -> bool:
    """Whether a table tells a range, well or misspelled, rather than keys."""
    return any(difflib.get_close_matches(name, _SPACINGS, 1, 0.7) for name in table)


def parts_of(name: str) -> Parts:
    """The parts of a name: a quoted "flow.shear_rate" is the key that it looks like."""
    try:
        return tuple(split(name))
    except ValueError:
        return (name,)


def _values(item: Any, key: Parts, place: Key) -> tuple[Any, ...]:
    name = toml.dotted(key)
    if isinstance(item, dict):
        return _spaced(item, name, place)
    if not isinstance(item, list):
        raise InputError(
            f"{name} = {toml.value(item)} is not a list", "a sweep goes through the values of a list",
            f"write [{toml.value(item)}] and more values, or move it to the table [set]", key=place,
        )  # fmt: skip
    if not item:
        raise InputError(f"{name} has no values", "a sweep goes through them", "give some, or take it out", key=place)
    return tuple(item)


def _spaced(table: dict[str, Any], name: str, place: Key) -> tuple[Any, ...]:
    """Values from one end to the other, for `{linspace = [first, last, number]}` and logspace, which takes ends too."""
    kind = next((each for each in _SPACINGS if each in table), None)
    given = table[kind] if kind else None
    if given is None or len(table) > 1 or not _is_range(given):
        raise InputError(
            f"{name} = {toml.value(table)} is no range", "a range is told by its ends and the number of its values",
            f"write {{{kind or 'linspace'} = [first, last, number]}}", key=place,
        )  # fmt: skip
    first, last, number = given
    if not 2 <= number <= _MOST_VALUES:
        problem = f"{name} asks for {number} values"
        raise InputError(problem, f"a range has from 2 to {_MOST_VALUES}", "give another number", key=place)
    if first == last:
        raise InputError(f"{name} ends where it begins", "all values would be the same", "give two ends", key=place)
    if kind == "logspace" and not first * last > 0:
        problem = f"{name} goes from {first:g} to {last:g}"
        why = "a logarithmic range has ends of one sign, neither of them 0 (they are the ends, not exponents)"
        raise InputError(problem, why, "use linspace, or other ends", key=place)
    space = np.linspace if kind == "linspace" else np.geomspace
    # 0.1 + 0.2 is meant to be 0.3: what is printed is what is run.
    values = [float(f"{value:.12g}") for value in space(first, last, number)]
    if isinstance(first, int) and isinstance(last, int) and all(value.is_integer() for value in values):
        return tuple(int(value) for value in values)
    return tuple(values)


def _is_range(given: Any) -> bool:
    """Two finite numbers and a whole one."""
    if not isinstance(given, list) or len(given) != 3:
        return False
    numbers = all(isinstance(each, int | float) and not isinstance(each, bool) for each in given)
    return numbers and isinstance(given[2], int) and all(math.isfinite(each) for each in given)


def _check_once(axes: Sequence[Axis]) -> None:
    """No key is swept twice, and none within another one."""
    seen: list[Parts] = []
    for axis in axes:
        for key, written in zip(axis.keys, axis.written, strict=True):
            for other in seen:
                shorter = min(len(key), len(other))
                if key[:shorter] == other[:shorter]:
                    problem = f"{toml.dotted(key)} is swept beside {toml.dotted(other)}"
                    why = "one would replace what the other one sets"
                    raise InputError(problem, why, "sweep one of them, or both in one list of tables", key=written)
            seen.append(key)


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else toml.value(value)
