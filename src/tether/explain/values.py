"""Wrong values: what each of pydantic's error types means, and what to do."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Sequence
from typing import Any

from pydantic_core import ErrorDetails

from tether import toml
from tether.explain.place import Place, table_name, tables_in

Meaning = tuple[str, str]
"""Problem, to be read after "key = value", and remedy."""


def meaning(place: Place, details: ErrorDetails) -> Meaning:
    """What is wrong with a value and what to do."""
    return _MEANINGS.get(details["type"], _other)(place, details)


def _number(place: Place, details: ErrorDetails) -> Meaning:
    given = details["input"]
    if isinstance(given, int) and not isinstance(given, bool):
        return "is beyond any number of a computer", f"give a smaller number{place.example}"
    number = _read(given)
    remedy = f"give a number{place.example}" if number is None else f"write {number!r} without quotation marks"
    return f"is {_type_name(given)}, not a number", remedy


def _read(given: Any) -> float | None:
    """The number that a text holds, if it does."""
    try:
        number = float(given) if isinstance(given, str) else math.nan
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _whole_number(place: Place, details: ErrorDetails) -> Meaning:
    given = details["input"]
    if isinstance(given, float) and given.is_integer() and abs(given) < 1e18:
        return "is not a whole number to TOML, which keeps 1e5 and 1.0 apart from 1", f"write {int(given)}"
    if isinstance(given, str) and re.fullmatch(r"[+-]?\d{1,18}", given, re.ASCII):
        return "is text, not a whole number", f"write {given} without quotation marks"
    return f"is {_type_name(given)}, not a whole number", f"give a whole number{place.example}"


def _finite(place: Place, _details: ErrorDetails) -> Meaning:
    return "is not a finite number", f"give a finite number{place.example}"


def _text(place: Place, details: ErrorDetails) -> Meaning:
    return f"is {_type_name(details['input'])}, not text", f"give text in quotation marks{place.example}"


def _no_text(place: Place, _details: ErrorDetails) -> Meaning:
    return "is empty", f"give text{place.example}, or leave it out"


def _list(place: Place, details: ErrorDetails) -> Meaning:
    if tables_in(place.field):
        return "is not a list of tables", f"write [[{place.name}]], with two brackets, above each of them"
    return f"is {_type_name(details['input'])}, not a list", f"give a list in brackets{place.example}"


def _table(place: Place, details: ErrorDetails) -> Meaning:
    problem = f"is {_type_name(details['input'])}, not a table"
    if place.example:
        return problem, f"give a table in braces{place.example}"
    return problem, f"write {table_name(place.key, place.table)} and its keys on lines below it"


def _literal(_place: Place, details: ErrorDetails) -> Meaning:
    choices = re.findall(r"'([^']*)'", details["ctx"]["expected"])
    return "is none of the values there are", choose(details["input"], choices)


def _bound(limit: str, problem: str, remedy: str) -> Callable[[Place, ErrorDetails], Meaning]:
    def meaning(place: Place, details: ErrorDetails) -> Meaning:
        bound = f"{details['ctx'][limit]}".removesuffix(".0")
        return problem.format(bound), remedy.format(bound) + place.example

    return meaning


def _length(limit: str, remedy: str) -> Callable[[Place, ErrorDetails], Meaning]:
    def meaning(place: Place, details: ErrorDetails) -> Meaning:
        length = len(details["input"])
        problem = f"has {length} {'item' if length == 1 else 'items'}"
        return problem, remedy.format(details["ctx"][limit]) + place.example

    return meaning


def _other(place: Place, details: ErrorDetails) -> Meaning:
    return f"is refused: {details['msg']}", f"give another value{place.example}"


_MEANINGS: dict[str, Callable[[Place, ErrorDetails], Meaning]] = {
    "float_type": _number,
    "int_type": _whole_number,
    "finite_number": _finite,
    "string_type": _text,
    "string_too_short": _no_text,
    "tuple_type": _list,
    "model_type": _table,
    "dict_type": _table,
    "model_attributes_type": _table,
    "literal_error": _literal,
    "greater_than": _bound("gt", "must be greater than {}", "give a number greater than {}"),
    "greater_than_equal": _bound("ge", "must be at least {}", "give {} or more"),
    "less_than": _bound("lt", "must be less than {}", "give a number less than {}"),
    "less_than_equal": _bound("le", "must be at most {}", "give {} or less"),
    "too_short": _length("min_length", "give at least {}"),
    "too_long": _length("max_length", "give at most {}"),
}


def choose(given: Any, choices: Sequence[str]) -> str:
    """A remedy: the choice that is most like what was given, or all of them."""
    close = difflib.get_close_matches(given.lower(), choices, 1, 0.6) if isinstance(given, str) else []
    quoted = [toml.value(choice) for choice in close or choices]
    return f"did you mean {quoted[0]}?" if close else f"give {listed(quoted, 'or')}"


def shown(item: Any) -> str:
    """A value as TOML, cut where it is long."""
    try:
        text = toml.value(item)
    except ValueError:  # Python does not print integers of more than 4300 digits
        return "(thousands of digits)"
    text = " ".join(text.split())
    return text if len(text) <= 40 else f"{text[:36]} ..."


def listed(names: Sequence[str], last: str = "and") -> str:
    """One enumeration: `x, y and z`."""
    return f"{', '.join(names[:-1])} {last} {names[-1]}" if len(names) > 1 else "".join(names)


def _type_name(item: Any) -> str:
    return _TYPE_NAMES.get(type(item), f"a {type(item).__name__}")


_TYPE_NAMES: dict[type, str] = {
    bool: "true or false",
    int: "a whole number",
    float: "a decimal number",
    str: "text",
    list: "a list",
    tuple: "a list",
    dict: "a table",
    type(None): "nothing",
}
