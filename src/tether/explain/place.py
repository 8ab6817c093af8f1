"""Where in a configuration an error is."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from tether import toml
from tether.errors import Key


@dataclass(frozen=True)
class Place:
    """The key as the user writes it, the table that it is in, and the field of the table, if it has it."""

    key: Key
    table: type[BaseModel]
    field: FieldInfo | None

    @property
    def name(self) -> str:
        """The last part of the key."""
        return str(self.key[-1]) if self.key else self.table.__name__

    @property
    def why(self) -> str:
        """What the field is: the first sentence of its documentation."""
        if self.field is None or self.field.description is None:
            return ""
        first = re.split(r"[.:] ", self.field.description)[0].rstrip(".")
        # Abbreviations (GSD, DPD) keep their case.
        return first[0].lower() + first[1:] if first[1].islower() else first

    @property
    def example(self) -> str:
        """The end of a remedy: ", for example temperature = 1.0", if the field has an example."""
        if self.field is None or not self.field.examples or not isinstance(self.key[-1], str):
            return ""
        return f", for example {self.name} = {toml.value(self.field.examples[0])}"

    def is_inside(self, other: Place) -> bool:
        """Whether the other place is a list or table around this one."""
        return len(self.key) > len(other.key) and self.key[: len(other.key)] == other.key


def follow(model: type[BaseModel], location: Sequence[str | int]) -> Place:
    """Walk from the model to the error; a union's tag, which is no key of the file, is left out."""
    key: Key = ()
    owner, field = model, None
    tables = [model]
    for part in location:
        tagged = [table for table in tables if tag(table) == part]
        if len(tables) > 1 and tagged:
            tables = tagged
            continue
        key = (*key, part)
        if isinstance(part, str) and tables:
            owner = tables[0]
            field = owner.model_fields.get(part)
            tables = tables_in(field)
    return Place(key, owner, field)


def tables_in(field: FieldInfo | None) -> list[type[BaseModel]]:
    """The models that a field may hold, for example Rest and Couette in `flow`."""
    return _models(field.annotation) if field else []


def _models(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [table for inner in get_args(annotation) for table in _models(inner)]


def tag(table: type[BaseModel]) -> Any:
    """What `kind` says in a table of one of several kinds, else None."""
    kind = table.model_fields.get("kind")
    return kind.default if kind else None


def table_name(key: Key, table: type[BaseModel]) -> str:
    """How a table is called in a message: [fluid], [flow] of kind "rest", [[bodies]], the top level."""
    if not key:
        return "the top level" if table.__name__ in ("Configuration", "Study") else table.__name__
    names = ".".join(str(part) for part in key if isinstance(part, str))
    kind = f' of kind "{tag(table)}"' if tag(table) else ""
    return (f"[[{names}]]" if isinstance(key[-1], int) else f"[{names}]") + kind
