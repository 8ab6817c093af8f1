"""Model: the base of every table of a configuration, made alike from TOML and from Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn, Self, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError, field_validator, model_validator
from pydantic_core import PydanticCustomError

from tether import toml
from tether.errors import InputError
from tether.explain import explain

Init = TypeVar("Init", bound=Callable[..., None])


def validated_in_place(init: Init) -> Init:
    """Mark an `__init__` that pydantic need not call for a nested table.

    pydantic would otherwise build each nested table by calling it, and the place of an error within the whole
    configuration would be lost.
    """
    init.__pydantic_base_init__ = True  # type: ignore[attr-defined]
    return init


class Model(BaseModel):
    """A table with checked keys: no unknown ones, no silent conversion, finite numbers only, never changed.

    Raises InputError, one sentence, whatever is wrong.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    @validated_in_place
    def __init__(self, /, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            first, *others = explain(type(self), error)
            raise first.at(type(self).__name__, more=len(others)) from None

    def changed(self, **changes: Any) -> Self:
        """A copy with some fields changed, checked like a new one; None takes a field back to its default."""
        given = {name: getattr(self, name) for name in self.model_fields_set}
        return type(self)(**{**given, **changes})

    def __setattr__(self, name: str, value: Any) -> None:
        self._refuse(name)

    def __delattr__(self, name: str) -> None:
        self._refuse(name)

    def _refuse(self, name: str) -> NoReturn:
        raise InputError(
            f"{type(self).__name__}.{name} cannot be changed",
            "it has been checked together with the rest",
            f"make a new one with changed({name}=...)",
        )

    @model_validator(mode="before")
    @classmethod
    def _plain(cls, values: Any) -> Any:
        """NumPy's numbers and arrays become Python's."""
        return _plain(values)

    @field_validator("*")
    @classmethod
    def _of_sensible_size(cls, value: Any) -> Any:
        """Products and quotients of a few quantities stay far from overflow."""
        if isinstance(value, float) and value != 0 and not 1e-30 <= abs(value) <= 1e30:
            problem = f"= {value!r} is absurdly {'small' if abs(value) < 1 else 'large'}"
            why = "in reduced units quantities are not far from 1"
            raise fault((), problem, why, "give a number of a size from 1e-30 to 1e30")
        return value


def fault(key: str | tuple[str | int, ...], problem: str, why: str, remedy: str) -> PydanticCustomError:
    """What a validator raises: the message begins with the key in full, then says `problem`."""
    parts = (key,) if isinstance(key, str) else key
    return PydanticCustomError("fault", "fault", {"key": parts, "problem": problem, "why": why, "remedy": remedy})


def exactly_one(model: Model, first: str, second: str, why: str) -> None:
    """Raise unless exactly one of two fields has a value."""
    given = [getattr(model, name) is not None for name in (first, second)]
    remedy = f"give exactly one of {first} and {second}"
    if all(given):
        raise fault(second, f"= {toml.value(getattr(model, second))} is given beside {first}", why, remedy)
    if not any(given):
        raise fault(first, f"is missing, and so is {second}", why, remedy)


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value
