"""Goal: when the means of a run are good enough for it to end ([measure] stop_when)."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from tether.config import Configuration

if TYPE_CHECKING:
    from tether.result import Result

_FIRST, _GROWTH = 100, 1.1
"""Samples before the first look at the means, and by how much more each time after: looking costs little in all."""


class Goal:
    """Relative errors to be reached, and the steps at which to look whether they are.

    Those steps depend on the configuration alone, so that a run ends at the same step in whatever portions it goes. A
    mean that is looked at again and again until its error happens to be small has an error that is a little too small;
    looks that are a tenth of the run apart, at means whose error is itself known to some per cent, keep that harmless.
    """

    def __init__(self, configuration: Configuration, measured_from: int) -> None:
        stop_when = configuration.measure.stop_when
        self._targets = stop_when.targets if stop_when is not None else {}
        interval = configuration.series_interval
        most = configuration.steps / (interval * _FIRST)
        rounds = math.ceil(math.log(max(most, 1)) / math.log(_GROWTH)) + 1 if self._targets else 0
        samples = np.round(_FIRST * _GROWTH ** np.arange(rounds)).astype(np.int64)
        self._looks = measured_from + interval * samples

    def next_look(self, step: int) -> list[int]:
        """The next step after `step` to look at, if there is one."""
        return [int(look) for look in self._looks[self._looks > step][:1]]

    def is_met(self, step: int, result: Callable[[], Result]) -> bool:
        """Whether this is a step to look at and every mean has an error, one that is small enough."""
        if step not in self._looks:
            return False
        found = result()
        means = [(getattr(found, name), target) for name, target in self._targets.items()]
        return all(mean is not None and mean.converged and mean.relative_error <= target for mean, target in means)
