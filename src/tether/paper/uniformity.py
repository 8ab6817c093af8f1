"""Is a profile across a periodic box at rest uniform?

Bins across the box are correlated, in time and with each other: as long as bodies take to diffuse across, and since
the number of particles is fixed, one bin has what others lack. A chi-square from the bins' own errors would be wrong.
But no place in such a box is different from another, so the covariance between two bins depends on their distance
only, and the Fourier modes of the profile are independent of each other, with real and imaginary parts of the same
variance. That is measured from independent runs, so no correlation time has to be known.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc


@dataclass(frozen=True)
class Uniformity:
    """Fisher's combination of the modes' p-values: -2 sum ln p is a chi-square of two degrees of freedom for each."""

    chi_square: float
    """nan where there are less than two runs."""
    freedom: int


def uniformity(profiles: NDArray[np.float64]) -> Uniformity:
    """Of the profiles of independent, equally long runs, shape (runs, bins). The mean over the bins is not looked at.

    With the mean over the runs A of a mode's complex amplitude and the variance s^2 of its real and imaginary parts
    together, |A|^2 runs / (2 s^2) has an F distribution of 2 and 2 (runs - 1) degrees of freedom; of 1 and runs - 1
    for the shortest wave, which is real.
    """
    runs, bins = profiles.shape
    if runs < 2 or not np.isfinite(profiles).all():
        return Uniformity(math.nan, 0)
    modes = np.fft.rfft(profiles, axis=1)[:, 1:]
    parts = np.full(modes.shape[1], 2.0)
    if bins % 2 == 0:
        parts[-1] = 1.0
    mean = modes.mean(axis=0)
    variance = (np.abs(modes - mean) ** 2).sum(axis=0) / (parts * (runs - 1))
    p = fdtrc(parts, parts * (runs - 1), runs * np.abs(mean) ** 2 / (parts * variance))
    return Uniformity(float(-2.0 * np.log(p).sum()), 2 * len(parts))


def shared_error(profiles: NDArray[np.float64]) -> float:
    """Standard error of the mean over the runs of any bin, from the scatter of the runs in all bins; nan of one run.

    Bins differ by nothing, so they share it.
    """
    runs = len(profiles)
    if runs < 2:
        return math.nan
    return float(np.sqrt(profiles.var(axis=0, ddof=1).mean() / runs))
