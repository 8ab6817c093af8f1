"""Writing values and tables as TOML, by tomlkit (reading is the standard library's tomllib)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError


def dotted(key: Iterable[str | int]) -> str:
    """A key as it is written in messages and after --set, for example `bodies.0.count`."""
    return ".".join(tomlkit.key(str(part)).as_string() for part in key)


def value(item: Any) -> str:
    """One value, on one line; what is no TOML as Python writes it."""
    try:
        if isinstance(item, Mapping):
            table = tomlkit.inline_table()
            table.update(item)
            return str(table.as_string())
        if isinstance(item, list | tuple):
            return f"[{', '.join(value(inner) for inner in item)}]"
        return str(tomlkit.item(item).as_string())
    except (TOMLKitError, TypeError, ValueError):
        return str(item)


def document(tables: Mapping[str, Any]) -> str:
    """A whole file."""
    return tomlkit.dumps(tables)
