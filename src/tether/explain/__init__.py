"""From what pydantic found to sentences: key, problem, why, remedy."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from tether import toml
from tether.errors import InputError
from tether.explain.keys import missing, similar, unknown, wrong_kind
from tether.explain.place import Place, follow
from tether.explain.values import meaning, shown

__all__ = ["explain"]


def explain(model: type[BaseModel], error: ValidationError) -> list[InputError]:
    """All errors that pydantic found in a `model`, at least one, in pydantic's order."""
    found = error.errors(include_url=False)
    places = [follow(model, details["loc"]) for details in found]
    echoes = _echoes(model, places, found)
    return [
        _fault(model, place, details)
        for number, (place, details) in enumerate(zip(places, found, strict=True))
        if number not in echoes
    ]


def _fault(model: type[BaseModel], place: Place, details: ErrorDetails) -> InputError:
    kind = details["type"]
    if kind == "fault":
        said = details["ctx"]
        key = place.key + said["key"]
        return InputError(f"{toml.dotted(key)} {said['problem']}", said["why"], said["remedy"], key=key)
    if kind == "extra_forbidden":
        return unknown(model, place)
    if kind == "missing":
        return missing(place)
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        return wrong_kind(place, details)
    problem, remedy = meaning(place, details)
    subject = toml.dotted(place.key) or place.name
    return InputError(f"{subject} = {shown(details['input'])} {problem}", place.why, remedy, key=place.key)


def _echoes(model: type[BaseModel], places: Sequence[Place], found: Sequence[ErrorDetails]) -> set[int]:
    """The numbers of the errors that only repeat another one.

    A key is "missing" because it was misspelled; a list is "too short" because an item of it was refused.
    """
    pairs = list(zip(places, found, strict=True))
    meant = {
        (*place.key[:-1], similar(model, place)) for place, details in pairs if details["type"] == "extra_forbidden"
    }
    return {
        number
        for number, (place, details) in enumerate(pairs)
        if (details["type"] == "missing" and place.key in meant)
        or (details["type"] == "too_short" and any(other.is_inside(place) for other in places))
    }
