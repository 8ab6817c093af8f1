"""Means of correlated series with standard errors that can be trusted, or that say that they can't.

Every number that tether prints is the mean of a time series whose samples are correlated. Its standard
error is

    error^2 = g s^2 / n,    g = 1 + 2 sum over lags t of rho(t)

with n samples of variance s^2 and autocorrelation rho; g, the statistical inefficiency, is the number of
samples that are worth one independent sample. We find g by blocking (H. Flyvbjerg and H. G. Petersen,
J. Chem. Phys. 91, 461 (1989), doi 10.1063/1.457480): the means of blocks of B consecutive samples are less
correlated the longer the blocks, and their scatter gives the error once they are independent.

How long the blocks are is decided by two criteria, the longer of which counts:

1. The variance of blocks of B samples is too small by a fraction of the order g/B, while its own scatter
   grows as sqrt(B/n). The two balance where B^3 = 2 n g^2 (U. Wolff, Comput. Phys. Commun. 156, 143 (2004),
   doi 10.1016/S0010-4655(03)00467-3, for the window of a sum over rho; R. M. Lee et al., Phys. Rev. E 83,
   066706 (2011), doi 10.1103/PhysRevE.83.066706, for blocks). Point 3 removes most of that bias, so blocks
   half as long do: B^3 >= n g^2 / 4.
2. Criterion 1 alone is blind to a slow component beneath fast noise, which is just what the stress of a
   suspension looks like (measured on white noise plus 2 % of an AR(1) series of 1000 samples' memory: an
   error of 0.3 of the true one). So no correlation between neighboring blocks may be left at this or any
   greater length, by the chi-square test at 1 % of M. Jonsson, Phys. Rev. E 98, 043304 (2018), doi
   10.1103/PhysRevE.98.043304.
3. What remains between neighboring blocks of that length, their lag-1 correlation rho_1 where it is positive,
   is put in: error^2 = variance of the blocks (1 + 2 rho_1) / number of blocks.

A series is called too short, and gets no error, when no length satisfies 1 and 2, when fewer than 16 blocks
of the chosen length fit, or when it is worth fewer than 50 independent samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import chdtri

MINIMUM_BLOCKS = 16
"""Fewer blocks than this give no error: it would itself be uncertain by more than a quarter."""

MINIMUM_INDEPENDENT_SAMPLES = 50.0
"""A series worth fewer independent samples than this is called too short."""

_MINIMUM_BLOCKS_OF_A_HALF = 8
_SIGNIFICANCE = 0.01  # of Jonsson's test; his own choice of level
_ROUNDING = 4.0 * float(np.finfo(np.float64).eps)  # relative; scatter below this is arithmetic, not physics


@dataclass(frozen=True)
class Estimate:
    """A mean, its standard error, and how far to trust them.

    Arithmetic (+, -, *, /) with numbers and other estimates propagates the errors to first order and takes
    the two sides to be independent; for several means of one series use `estimate_function`.
    """

    value: float
    """The mean."""
    error: float
    """Standard error of the mean (one sigma); nan where the series was too short to tell."""
    samples: int
    """Number of samples in the series."""
    inefficiency: float
    """Statistical inefficiency g, in samples: samples / g is the number of independent samples."""
    converged: bool
    """Whether the series was long enough, against its own correlation time, for an error."""
    unit: str = ""
    """Unit of value and error; empty for reduced (DPD) units."""
    blocks: int = 0
    """Number of blocks that the error was measured from; 0 where none was."""

    @property
    def error_of_error(self) -> float:
        """Standard error of `error` itself, about error / sqrt(blocks); nan where there is no error."""
        if self.error == 0.0:
            return 0.0
        return self.error / math.sqrt(self.blocks) if self.converged and self.blocks > 0 else math.nan

    @property
    def relative_error(self) -> float:
        """error / |value|; infinite at value 0."""
        return self.error / abs(self.value) if self.value != 0.0 else math.inf

    def as_dict(self) -> dict[str, float | None]:
        """{"value": ..., "error": ...} for JSON, with None for what isn't known."""
        return {"value": _finite_or_none(self.value), "error": _finite_or_none(self.error)}

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        if not math.isfinite(self.value):
            return "no value"
        if not self.converged or not math.isfinite(self.error):
            return f"{f'{self.value:#.2g}'.removesuffix('.')}{unit} (too short for an error)"
        return _value_and_error(self.value, self.error) + unit

    def __neg__(self) -> Estimate:
        return replace(self, value=-self.value)

    def __add__(self, other: Estimate | float) -> Estimate:
        if not isinstance(other, Estimate):
            return replace(self, value=self.value + other)
        unit = self._unit_shared_with(other)
        return self._combined(other, self.value + other.value, 1.0, 1.0, unit)

    def __radd__(self, other: float) -> Estimate:
        return self + other

    def __sub__(self, other: Estimate | float) -> Estimate:
        return self + (-other)

    def __rsub__(self, other: float) -> Estimate:
        return (-self) + other

    def __mul__(self, other: Estimate | float) -> Estimate:
        if not isinstance(other, Estimate):
            return replace(self, value=self.value * other, error=self.error * abs(other))
        unit = " ".join(part for part in (self.unit, other.unit) if part)
        return self._combined(other, self.value * other.value, other.value, self.value, unit)

    def __rmul__(self, other: float) -> Estimate:
        return self * other

    def __truediv__(self, other: Estimate | float) -> Estimate:
        if not isinstance(other, Estimate):
            return replace(self, value=self.value / other, error=self.error / abs(other))
        ratio = self.value / other.value
        return self._combined(
            other, ratio, 1.0 / other.value, -ratio / other.value, _unit_of_ratio(self.unit, other.unit)
        )

    def __rtruediv__(self, other: float) -> Estimate:
        inverse = other / self.value
        return replace(
            self,
            value=inverse,
            error=abs(inverse / self.value) * self.error,
            unit=_unit_of_ratio("", self.unit),
        )

    def _unit_shared_with(self, other: Estimate) -> str:
        if self.unit != other.unit:
            raise ValueError(
                f"estimates in {self.unit or 'DPD units'} and {other.unit or 'DPD units'} cannot be added"
                " (the units differ); convert one of them first"
            )
        return self.unit

    def _combined(self, other: Estimate, value: float, slope: float, other_slope: float, unit: str) -> Estimate:
        """First-order propagation for independent estimates; slopes are the derivatives of `value`.

        Samples, inefficiency and blocks are those of the side whose part of the error is the greater one.
        """
        part, other_part = abs(slope) * self.error, abs(other_slope) * other.error
        leading = other if other_part > part else self
        return replace(
            leading,
            value=value,
            error=math.hypot(part, other_part),
            converged=self.converged and other.converged,
            unit=unit,
        )


@dataclass(frozen=True)
class BlockLevel:
    """The means of all blocks of one length: one point of Flyvbjerg and Petersen's plot."""

    length: int
    """Samples in a block."""
    blocks: int
    """Number of whole blocks; a remainder at the end of the series is left out."""
    variance: float
    """Mean square deviation of the block means from their mean (divided by `blocks`, not by one less)."""
    correlation: float
    """Lag-1 autocorrelation of the block means about their mean, divided by `blocks` likewise."""

    @property
    def variance_of_mean(self) -> float:
        """Estimated variance of the mean of all blocks, were they independent."""
        return self.variance / (self.blocks - 1)

    @property
    def corrected_variance_of_mean(self) -> float:
        """The same with the correlation between neighboring blocks put in, where it is positive.

        The estimator of the lag-1 correlation is 1/blocks too low for independent blocks.
        """
        return self.variance_of_mean * (1.0 + 2.0 * max(0.0, self.correlation + 1.0 / self.blocks))


def estimate(series: ArrayLike, unit: str = "") -> Estimate:
    """The mean of a stationary series with its standard error from blocking (method: see the module).

    series: shape (n,), samples at equal intervals in time. Raises ValueError for other shapes, an empty
    series or a value that isn't finite. A constant series long enough for an error has error 0 and
    inefficiency 1.
    """
    samples = _samples(series)
    value = float(samples.mean())
    if _is_constant(samples):
        long_enough = len(samples) >= MINIMUM_INDEPENDENT_SAMPLES
        return Estimate(
            value=value,
            error=0.0 if long_enough else math.nan,
            samples=len(samples),
            inefficiency=1.0,
            converged=long_enough,
            unit=unit,
            blocks=len(samples) if long_enough else 0,
        )
    levels = block_levels(samples)
    level = _independent_blocks(levels)
    inefficiency = _inefficiency(level or levels[-1], levels)
    if level is None or level.blocks < MINIMUM_BLOCKS or len(samples) < MINIMUM_INDEPENDENT_SAMPLES * inefficiency:
        return Estimate(value, math.nan, len(samples), inefficiency, converged=False, unit=unit)
    error = math.sqrt(level.corrected_variance_of_mean)
    return Estimate(value, error, len(samples), inefficiency, converged=True, unit=unit, blocks=level.blocks)


def estimate_function(function: Callable[[NDArray[np.float64]], float], columns: ArrayLike, unit: str = "") -> Estimate:
    """function(means) of several means of the same run, with the error that their correlations leave it.

    columns: shape (n, k), k quantities sampled together; `function` takes their k means, shape (k,), and
    returns a number. The delta method: the series z = f(m) + sum_i df/dm_i (x_i - m_i) has the mean and, to
    first order, the error of f, so blocking z gives them with all correlations between the columns and in
    time. Slopes are central differences over one naive standard error of each mean (U. Wolff, 2004, see the
    module). The bias of f, of the order error^2 f''/2, is not taken off.

    Example: the rotational temperature of bodies, the mean spin s taken out, is
    (<L.omega> - 2 s.<L> + s.<I>s) / degrees of freedom with s = <omega>.
    """
    table = np.asarray(columns, dtype=np.float64)
    if table.ndim != 2 or table.shape[0] == 0 or table.shape[1] == 0:
        raise ValueError(f"columns have the shape {table.shape} (not samples by quantities); give two dimensions")
    if not np.isfinite(table).all():
        raise ValueError("a sample is not finite (so neither is the mean); find the step where it began")
    means = table.mean(axis=0)
    steps = table.std(axis=0) / math.sqrt(table.shape[0])
    value = float(function(means))
    linear = np.full(table.shape[0], value)
    for index, step in enumerate(steps):
        if step <= _ROUNDING * abs(means[index]):
            continue  # a constant: however steep f is, it moves nothing
        shift = np.zeros_like(means)
        shift[index] = step
        slope = (function(means + shift) - function(means - shift)) / (2.0 * step)
        linear += slope * (table[:, index] - means[index])
    return replace(estimate(linear, unit), value=value)


def drifts(series: ArrayLike) -> float | None:
    """Second half's mean minus the first half's, in their combined standard error: positive where it rises.

    A stationary series gives a number of about unit variance; |z| > 3 is worth a warning (measured on
    stationary AR(1) series: under 1 % false alarms). None where the halves are too short to tell. A constant
    series gives 0, one that is constant in each half but jumps between them gives +-inf.
    """
    samples = _samples(series)
    middle = len(samples) // 2
    if middle < _MINIMUM_BLOCKS_OF_A_HALF:
        return None
    difference = float(samples[middle:].mean() - samples[:middle].mean())
    variance = 0.0
    for half in (samples[:middle], samples[middle:]):
        if _is_constant(half):
            continue
        level = _independent_blocks(block_levels(half))
        if level is None or level.blocks < _MINIMUM_BLOCKS_OF_A_HALF:
            return None
        variance += level.corrected_variance_of_mean
    if variance > 0.0:
        return difference / math.sqrt(variance)
    return 0.0 if _is_constant(samples) else math.copysign(math.inf, difference)


def block_levels(series: ArrayLike) -> list[BlockLevel]:
    """Variance and lag-1 correlation of the means of blocks of 1, 2, 4, ... samples, down to two blocks."""
    means = _samples(series)
    means = means - means.mean()  # no digits lost to a large mean
    levels = []
    length = 1
    while len(means) >= 2:
        deviation = means - means.mean()
        variance = float(deviation @ deviation) / len(means)
        neighbors = float(deviation[:-1] @ deviation[1:]) / len(means)
        correlation = neighbors / variance if variance > 0.0 else 0.0
        levels.append(BlockLevel(length, len(means), variance, correlation))
        whole = len(means) - len(means) % 2
        means = 0.5 * (means[0:whole:2] + means[1:whole:2])
        length *= 2
    return levels


def _independent_blocks(levels: list[BlockLevel]) -> BlockLevel | None:
    """The shortest blocks that satisfy criteria 1 and 2 of the module, or None."""
    samples = levels[0].blocks
    long_enough = next(
        (
            index
            for index, level in enumerate(levels)
            if level.length**3 >= 0.25 * samples * _inefficiency(level, levels) ** 2
        ),
        None,
    )
    uncorrelated = _first_uncorrelated(levels)
    if long_enough is None or uncorrelated is None:
        return None
    return levels[max(long_enough, uncorrelated)]


def _first_uncorrelated(levels: list[BlockLevel]) -> int | None:
    """Jonsson's test: the first level from which on no level shows a correlation between neighboring blocks.

    Under independence the lag-1 correlation of N block means has mean -(N - 1)/N^2 and variance 1/N, so the
    sum over the K levels from here on of N (correlation + (N - 1)/N^2)^2 is chi-square with K degrees of
    freedom.
    """
    excess = [level.blocks * (level.correlation + (level.blocks - 1) / level.blocks**2) ** 2 for level in levels]
    for index in range(len(levels)):
        threshold = float(chdtri(len(levels) - index, _SIGNIFICANCE))
        if sum(excess[index:]) < threshold:
            return index
    return None


def _inefficiency(level: BlockLevel, levels: list[BlockLevel]) -> float:
    """Variance of the mean by this level over what independent samples would give."""
    naive = levels[0].variance_of_mean
    return level.corrected_variance_of_mean / naive if naive > 0.0 else 1.0


def _samples(series: ArrayLike) -> NDArray[np.float64]:
    samples = np.asarray(series, dtype=np.float64)
    if samples.ndim != 1:
        raise ValueError(f"a series has one dimension, not {samples.ndim}; give one quantity at a time")
    if len(samples) == 0:
        raise ValueError("an empty series has no mean; run at least one step of measurement")
    if not np.isfinite(samples).all():
        raise ValueError("a sample is not finite (so neither is the mean); find the step where it began")
    return samples


def _is_constant(samples: NDArray[np.float64]) -> bool:
    return bool(np.ptp(samples) <= _ROUNDING * np.abs(samples).max())


def _finite_or_none(number: float) -> float | None:
    return float(number) if math.isfinite(number) else None


def _unit_of_ratio(numerator: str, denominator: str) -> str:
    if numerator == denominator:
        return ""
    return f"{numerator or '1'}/{denominator}" if denominator else numerator


def _value_and_error(value: float, error: float) -> str:
    """`4.07 +- 0.03`: the error to one digit, two if it begins with 1 or 2; the value to that place."""
    if error == 0.0:
        return f"{value:.6g} +- 0"
    size = max(abs(value), error)
    power = 0 if 1e-3 <= size < 1e6 else math.floor(math.log10(size))
    value, error = value / 10.0**power, error / 10.0**power
    first = math.floor(math.log10(float(f"{error:.0e}")))  # decimal place of the first digit, once rounded
    digits = 2 if float(f"{error:.1e}") < 2.95 * 10.0**first else 1
    places = digits - 1 - first
    text = f"{_fixed(value, places)} +- {_fixed(error, places)}"
    return text if power == 0 else f"({text})e{power:+03d}"


def _fixed(number: float, places: int) -> str:
    text = f"{round(number, places):.{max(places, 0)}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text  # no "-0.00"
