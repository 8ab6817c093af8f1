"""Keys that are unknown or missing."""

from __future__ import annotations

import difflib

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from tether import toml
from tether.errors import InputError
from tether.explain.place import Place, table_name, tables_in, tag
from tether.explain.values import choose, listed, shown

SYMBOLS = {
    "kt": "temperature",
    "t": "temperature",
    "gamma": "friction",
    "sigma": "noise",
    "a": "repulsion",
    "rho": "density",
    "n": "density",
    "s": "exponent",
    "m": "mass",
    "rc": "cutoff",
    "r_c": "cutoff",
    "phi": "volume_fraction",
    "h": "stiffness",
    "dt": "timestep",
    "time_step": "timestep",
    "rate": "shear_rate",
    "gamma_dot": "shear_rate",
    "type": "kind",
    "number": "count",
}
"""What people of the field may type instead of the word."""


def unknown(model: type[BaseModel], place: Place) -> InputError:
    """A key that its table does not have."""
    if meant := similar(model, place):
        remedy = f"did you mean {meant}?"
    elif home := _home(model, place.name):
        remedy = f"{place.name} belongs {home}"
    else:
        remedy = f"the keys there are {listed(list(place.table.model_fields))}"
    problem = f"{toml.dotted(place.key)} is not a key of {table_name(place.key[:-1], place.table)}"
    why = "keys are checked so that a typing error cannot change the run"
    return InputError(problem, why, remedy, key=place.key)


def similar(model: type[BaseModel], place: Place) -> str | None:
    """The key of the same table that was probably meant, unless this one has its place in another table."""
    name, fields = place.name.lower(), place.table.model_fields
    if SYMBOLS.get(name) in fields:
        return SYMBOLS[name]
    if _home(model, place.name):
        return None
    return next(iter(difflib.get_close_matches(name, fields, 1, 0.6)), None)


def _home(model: type[BaseModel], name: str) -> str:
    """Where a key of this name belongs."""
    if name in model.model_fields and not tables_in(model.model_fields[name]):
        return "above the first [table] of the file"
    for section, field in model.model_fields.items():
        for table in tables_in(field):
            if name in table.model_fields:
                return f"in {table_name((section,), table)}"
    return ""


def missing(place: Place) -> InputError:
    """A key, or a whole table, that has to be there."""
    if tables := tables_in(place.field):
        required = [name for name, field in tables[0].model_fields.items() if field.is_required()]
        remedy = f"add a table [{place.name}] with {listed(required)}"
    else:
        remedy = f"give {place.name}{place.example}"
    return InputError(f"{toml.dotted(place.key)} is missing", place.why, remedy, key=place.key)


def wrong_kind(place: Place, details: ErrorDetails) -> InputError:
    """A table whose `kind` is missing or none of those there are."""
    key = (*place.key, "kind")
    kinds = [str(tag(table)) for table in tables_in(place.field)]
    if details["type"] == "union_tag_not_found":
        given, problem = None, "is missing"
    else:
        table = details["input"]
        given = table["kind"] if isinstance(table, dict) else details["ctx"]["tag"]
        problem = f"= {shown(given)} is none of the kinds there are"
    return InputError(f"{toml.dotted(key)} {problem}", place.why, choose(given, kinds), key=key)
