"""Writing values and tables as TOML (reading is the standard library's tomllib)."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def dotted(key: Iterable[str | int]) -> str:
    """A key as it is written in messages and after --set, for example `bodies.0.count`."""
    return ".".join(_key(str(part)) for part in key)


def value(item: Any) -> str:
    """One value, on one line."""
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, str):
        # A JSON string is a TOML string, but for one control character.
        return json.dumps(item, ensure_ascii=False).replace("\x7f", "\\u007F")
    if isinstance(item, Mapping):
        pairs = ", ".join(f"{_key(name)} = {value(inner)}" for name, inner in item.items())
        return f"{{ {pairs} }}" if pairs else "{}"
    if isinstance(item, list | tuple):
        return f"[{', '.join(value(inner) for inner in item)}]"
    return repr(item) if isinstance(item, int | float) else str(item)


def document(tables: Mapping[str, Any]) -> str:
    """A whole file: plain keys first, then a [table] a mapping and a [[table]] for each mapping in a list."""
    plain: list[str] = []
    blocks: list[str] = []
    for name, item in tables.items():
        if isinstance(item, Mapping):
            blocks.append(_block(f"[{_key(name)}]", item))
        elif isinstance(item, list | tuple) and item and all(isinstance(inner, Mapping) for inner in item):
            blocks.extend(_block(f"[[{_key(name)}]]", inner) for inner in item)
        else:
            plain.append(f"{_key(name)} = {value(item)}\n")
    return "\n".join(["".join(plain), *blocks])


def _block(header: str, table: Mapping[str, Any]) -> str:
    return "".join([f"{header}\n", *(f"{_key(name)} = {value(item)}\n" for name, item in table.items())])


def _key(name: str) -> str:
    return name if _BARE_KEY.fullmatch(name) else value(name)
