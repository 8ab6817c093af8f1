"""Numbers of tables as estimates, and the mean over repeats of what a run's folder tells."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tether.estimate import Estimate
from tether.study.means import mean_of


def number(value: float, error: float = 0.0) -> Estimate:
    """A number and its standard error; 0 of one that is computed, nan where it is not known."""
    return Estimate(float(value), float(error), 0, 1.0, converged=math.isfinite(error))


def mean(estimates: Sequence[Estimate]) -> Estimate:
    """The mean over repeats of equal length, by the rules of `tether.study.means`."""
    found = mean_of([each.value for each in estimates], [each.error for each in estimates], [1] * len(estimates))
    return number(found.value, found.error)
