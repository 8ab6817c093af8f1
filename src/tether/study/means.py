"""The mean over repeats of one setting, with an error that can be defended.

Repeats are independent runs of the same configuration, of n_i measured steps, each with a value x_i and, where it was
long enough for one, a standard error s_i from blocking. The mean is

    x = sum w_i x_i,    w_i = n_i / sum n

Steps weigh, not 1/s_i^2: an error that is itself uncertain, and smallest where its run happened to fluctuate least,
would pull the mean to one side. Two estimates of the error of x stand beside each other:

    within^2  = sum w_i^2 s_i^2                                       what the runs say of themselves
    between^2 = sum w_i (x_i - x)^2 / (n - 1)                         what their scatter says

`within` is the better known of the two, and it is taken unless the repeats contradict it: chi^2 = sum of
(x_i - x)^2 / s_i^2 beyond its 99 % point for n - 1 degrees of freedom. Then something differs from run to run that a
run does not see (a structure that lasts as long as the run, too short an equilibration), and the error is within times
sqrt(chi^2/(n - 1)), the scale factor of the Particle Data Group (Phys. Rev. D 110, 030001 (2024), sec. 5.2.2).

Where a run has no error of its own the scatter is all there is. It takes 3 repeats, and is widened by Student's t
for n - 1 degrees of freedom, so that the value is within one error in 68 % of all cases, as one expects of an error.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import bdtrc, chdtri, stdtrit

FEWEST_REPEATS = 3
"""That give an error by their scatter alone."""

SIGNIFICANCE = 0.01
"""Of the test whether repeats agree: this part of all means of good runs is given too large an error."""

_ONE_SIGMA = 0.8413447460685429
"""The probability below +1 sigma of a normal variable."""


@dataclass(frozen=True)
class Mean:
    """A mean over repeats."""

    value: float
    error: float
    """Standard error; nan where the runs are too few or too short to tell."""
    repeats: int
    agree: bool = True
    """False where the repeats scatter more than their errors allow; the error then has their scatter in it."""


def mean_of(values: ArrayLike, errors: ArrayLike, steps: ArrayLike) -> Mean:
    """The mean over repeats. values, errors, steps: shape (n,); errors nan where a run has none.

    Repeats without a value are left out; the mean of none is nan.
    """
    x, s, n = (np.asarray(each, dtype=np.float64) for each in (values, errors, steps))
    there = np.isfinite(x) & (n > 0)
    x, s, n = x[there], s[there], n[there]
    if not len(x):
        return Mean(math.nan, math.nan, 0)
    w = n / n.sum()
    value = float(w @ x)
    if not np.isfinite(s).all():
        return Mean(value, _between(x, w, value), len(x))
    within = math.sqrt(float(w**2 @ s**2))
    if len(x) == 1 or not (s > 0).all():
        return Mean(value, within, len(x))
    freedom = len(x) - 1
    # About the mean of weights 1/s^2 this is chi^2; about x it is no smaller, and as large where all errors are alike.
    best = float(np.average(x, weights=1 / s**2))
    chi2 = float((((x - best) / s) ** 2).sum())
    if chi2 <= float(chdtri(freedom, SIGNIFICANCE)):
        return Mean(value, within, len(x))
    return Mean(value, within * math.sqrt(chi2 / freedom), len(x), agree=False)


def chance_of_disagreement(disagreeing: int, means: int) -> float:
    """The probability that so many of so many means, or more, disagree where nothing is wrong."""
    return float(bdtrc(disagreeing - 1, means, SIGNIFICANCE)) if disagreeing else 1.0


def _between(x: NDArray[np.float64], w: NDArray[np.float64], value: float) -> float:
    """The error from the scatter. With x_i of variance v/w_i, v is that of x, and E sum w_i (x_i - x)^2 = (n - 1) v."""
    if len(x) < FEWEST_REPEATS:
        return math.nan
    freedom = len(x) - 1
    variance = float(w @ (x - value) ** 2) / freedom
    return float(stdtrit(freedom, _ONE_SIGMA)) * math.sqrt(variance)
