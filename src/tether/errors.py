"""What tether raises: every message is one sentence, "<place>: <problem> (<why it is one>); <remedy>"."""

from __future__ import annotations

from typing import ClassVar, Self

Key = tuple[str | int, ...]
"""The place of a value in a configuration, for example ("bodies", 0, "count")."""


class TetherError(Exception):
    """Base of everything that tether raises on purpose.

    `key` is the configuration key at fault, if there is one; whoever knows the file adds the place by `at`.
    `exit_code` is what the command line ends with.
    """

    exit_code: ClassVar[int] = 1

    def __init__(
        self, problem: str, why: str = "", remedy: str = "", *, key: Key = (), place: str = "", more: int = 0
    ) -> None:
        self.problem = problem
        self.why = why
        self.remedy = remedy
        self.key = key
        self.place = place
        self.more = more
        super().__init__(self._sentence())

    def at(self, place: str, more: int = 0) -> Self:
        """The same error with the place where the user finds it, and how many more errors there are."""
        return type(self)(self.problem, self.why, self.remedy, key=self.key, place=place, more=more)

    def _sentence(self) -> str:
        place = f"{self.place}: " if self.place else ""
        why = f" ({self.why})" if self.why else ""
        remedy = f"; {self.remedy}" if self.remedy else ""
        more = f" (and {self.more} more {'error' if self.more == 1 else 'errors'})" if self.more else ""
        return f"{place}{self.problem}{why}{remedy}{more}"


class InputError(TetherError):
    """Something that the user wrote or asked for cannot be."""

    exit_code = 2


class RunError(TetherError):
    """A run that was rightly asked for has failed."""

    exit_code = 1
