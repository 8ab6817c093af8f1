"""What `--set section.key=value` means."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Sequence
from typing import Any

from tether import toml
from tether.config.lines import split
from tether.errors import InputError, Key

RIVALS = [("noise", "friction"), ("count", "volume_fraction"), ("steps", "strain"), ("seconds", "steps")]
"""Keys that exclude each other: setting one takes the other, if it is in the file, out."""

_WITHOUT_SPRINGS = ("base", "torque_arms", "stiffness")
EXCLUDED = {
    ("model", "rigid"): _WITHOUT_SPRINGS,
    ("model", "single"): (*_WITHOUT_SPRINGS, "shape", "spacing", "sides", "semiaxes", "length", "points"),
    ("base", "massless"): ("torque_arms",),
    ("law", "linear"): ("steepness",),
}
"""Values of keys that exclude other keys: setting one takes those, if they are in the file, out."""


def parse(override: str) -> tuple[list[str], Any]:
    """The parts of the key, and the value (TOML; a word that is no TOML is text). Raises InputError."""
    name, equals, text = override.partition("=")
    try:
        parts = list(split(name.strip())) if equals else []
    except ValueError:
        parts = []
    if not parts:
        problem = "this is not of the form section.key=value"
        raise InputError(problem, "the key says what to change", "write --set flow.shear_rate=0.1, for example")
    return parts, _value(text.strip())


def assign(values: dict[str, Any], parts: Sequence[str], value: Any) -> Key:
    """Put a value where the key says, in tables made if missing; returns the key with numbers for items."""
    holder: Any = values
    key: Key = ()
    for part, following in zip(parts, [*parts[1:], None], strict=True):
        step = _step(holder, key, part)
        key = (*key, step)
        if following is None:
            holder[step] = value
        elif isinstance(holder, dict):
            holder = holder.setdefault(step, [] if following.isdecimal() else {})
        else:
            holder = holder[step]
    return key


def drop_rivals(values: dict[str, Any], keys: Collection[Key]) -> None:
    """Take out of the values what the overridden keys exclude, unless it is an override itself."""
    for *parents, name in keys:
        holder: Any = values
        for part in parents:
            holder = holder[part]
        rivals = [pair[1 - pair.index(str(name))] for pair in RIVALS if name in pair]
        if isinstance(holder, dict) and isinstance(holder[name], str):
            rivals += EXCLUDED.get((str(name), holder[name]), ())
        for rival in rivals:
            if (*parents, rival) not in keys:
                holder.pop(rival, None)


def _value(text: str) -> Any:
    try:
        read = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError) as error:
        if text and text[0] not in "\"'[{" and text.isprintable():
            return text
        why = str(error).split(" (at ")[0].lower() if text else "nothing follows the ="
        raise InputError(f"the value {text!r} is not TOML", why, "put text in quotation marks") from None
    if len(read) != 1:
        raise InputError("there is more than one value", "each --set changes one key", "give several of them")
    return read["value"]


def _step(holder: Any, key: Key, part: str) -> Any:
    """The part as a key of a table, or as the number of a list item."""
    if isinstance(holder, dict):
        return part
    name = toml.dotted((*key, part))
    if not isinstance(holder, list):
        why = f"{toml.dotted(key)} is no table"
        raise InputError(f"{name} cannot be set", why, f"set {toml.dotted(key)} as a whole")
    if not (part.isdecimal() and int(part) < len(holder)):
        why = f"there are {len(holder)}, numbered from 0" if holder else "there are none"
        raise InputError(f"{name} does not exist", why, "give the number of one that there is, or add it to the file")
    return int(part)
