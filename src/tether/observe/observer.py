"""Observer: what is measured on sampled steps."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether.observe.moment import Moment

State = dict[str, NDArray[np.generic]]
"""Plain arrays by name, for a checkpoint."""


class Observer(Protocol):
    """Sees the suspension at equal intervals while it runs, and keeps sums, never the samples themselves."""

    @property
    def interval(self) -> int:
        """Steps between samples."""

    def sample(self, moment: Moment) -> None:
        """Take in the suspension at a step; the caller sees to it that samples are `interval` steps apart."""

    def state(self) -> State:
        """All that is needed to go on bit for bit."""

    def restore(self, state: State) -> None:
        """Go on from `state`, which an observer made with the same arguments gave."""

    def dataset(self) -> xr.Dataset | None:
        """What was found: every variable `name` with its standard error `name_error`; None before there is anything.

        An error is nan where the run was too short to tell it.
        """


def under(name: str, state: State) -> State:
    """The state of a part, as it stands in the state of the whole: `name.key` for each key."""
    return {f"{name}.{key}": value for key, value in state.items()}


def part(name: str, state: State) -> State:
    """The state of the part that `under` put there."""
    return {key.removeprefix(f"{name}."): value for key, value in state.items() if key.startswith(f"{name}.")}
