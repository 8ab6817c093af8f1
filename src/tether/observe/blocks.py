"""Blocks: running means of many quantities, with errors, in memory that does not grow with the run.

Rows of numbers come in, one a sample, and only means over blocks of consecutive rows are kept. When their number
reaches MOST_BLOCKS, neighboring blocks are merged, and blocks are twice as long from then on: the blocking of
H. Flyvbjerg and H. G. Petersen, J. Chem. Phys. 91, 461 (1989), doi 10.1063/1.457480, while the run goes (compare
D. R. Kent IV, R. P. Muller, A. G. Anderson, W. A. Goddard III and M. T. Feldmann, J. Comput. Chem. 28, 2309 (2007),
doi 10.1002/jcc.20746). The block means are themselves a series at equal intervals, so `tether.estimate` tells their
error, further blocking included.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tether.estimate import Estimate, estimate
from tether.observe.observer import State

Array = NDArray[np.float64]

MOST_BLOCKS = 256
"""Half as many are left after a merger, and estimates ask for the worth of 50 independent ones: of 64 that is often too
much. With 128 to 256 errors come out about 6 % high, for estimates put in what correlation seems left between the few
blocks that they end with, where it is positive."""

_SHARE_CONTENT = 0.9  # of the components, that the blocks of a covariance matrix must be long enough for


@dataclass(frozen=True, eq=False)
class Means:
    """Means of one run and what is computed from them, with errors to first order and all correlations.

    value: shape (...,). deviation: of the blocks from it, shape (blocks, ...). For a function f of means m the
    deviation is sum_i df/dm_i (block's m_i - m_i), the delta method, so that its blocking gives the error of f
    whatever the correlations of the m_i. The bias of f, of the order error^2 f''/2, is not taken off.
    """

    value: Array
    deviation: Array

    __array_ufunc__ = None  # array * means is __rmul__'s

    def __getitem__(self, index: Any) -> Means:
        """The part of the values that a NumPy index chooses."""
        index = index if isinstance(index, tuple) else (index,)
        return Means(self.value[index], self.deviation[(slice(None), *index)])

    def __add__(self, other: Means) -> Means:
        return Means(self.value + other.value, self.deviation + other.deviation)

    def __sub__(self, other: Means) -> Means:
        return self + (-1.0) * other

    def __mul__(self, other: Means) -> Means:
        return Means(self.value * other.value, other.value * self.deviation + self.value * other.deviation)

    def __truediv__(self, other: Means) -> Means:
        """Not a number where the other is zero, as the mean velocity of a place where nothing ever was."""
        divisor = np.where(other.value != 0.0, other.value, np.nan)
        ratio = self.value / divisor
        return Means(ratio, (self.deviation - ratio * other.deviation) / divisor)

    def __rmul__(self, number: float | Array) -> Means:
        return Means(number * self.value, number * self.deviation)

    def log(self) -> Means:
        """Natural logarithm; not a number where the value is not positive."""
        positive = np.where(self.value > 0.0, self.value, np.nan)
        return Means(np.log(positive), self.deviation / positive)

    def sum(self, axis: int) -> Means:
        """Sum over one axis of the values, counted from the last: -1, -2, ..."""
        if axis >= 0:
            raise ValueError(f"axis {axis} is counted from the first (which is the blocks' here); count from the last")
        return Means(self.value.sum(axis=axis), self.deviation.sum(axis=axis))

    def weighted(self, weights: ArrayLike) -> Means:
        """Sum over the first axis of the values with weights, such as those of the slope of a fitted line."""
        chosen = np.asarray(weights, dtype=np.float64)
        return Means(np.tensordot(chosen, self.value, axes=(0, 0)), np.tensordot(chosen, self.deviation, axes=(0, 1)))

    def reshaped(self, *shape: int) -> Means:
        """The same values in another shape."""
        return Means(self.value.reshape(shape), self.deviation.reshape(len(self.deviation), *shape))

    def error(self) -> Array:
        """Standard error of each value by `tether.estimate.estimate`; nan where the run was too short to tell."""
        return np.array([_error(column) for column in self._series().T]).reshape(self.value.shape)

    def covariance(self) -> tuple[Array, int]:
        """Covariance matrix of the values, shape (values, values), and the number of blocks it was measured from.

        Blocks are as long as nine in ten of the values ask for, of those that have an error. n blocks tell n - 1
        directions, and not exactly: for k values that are z away from the expected ones, z C^-1 z is no chi-square but
        Hotelling's T^2, and (n - k) T^2 / (k (n - 1)) has an F distribution of k and n - k degrees of freedom. Not a
        number, and 0 blocks, where less than half of the values have an error.
        """
        series = self._series()
        width = series.shape[1]
        blocks = [found.blocks for found in map(_estimate, series.T) if found is not None and found.converged]
        if width == 0 or 2 * len(blocks) < width:
            return np.full((width, width), np.nan), 0
        fewest = int(np.quantile(blocks, 1.0 - _SHARE_CONTENT, method="lower"))
        length = 2 ** round(np.log2(len(series) / fewest))
        whole = len(series) // length
        longer = series[: whole * length].reshape(whole, length, width).mean(axis=1)
        return np.atleast_2d(np.cov(longer.T)) / whole, whole

    def _series(self) -> Array:
        return self.deviation.reshape(len(self.deviation), self.value.size)


class Blocks:
    """Means over blocks of consecutive rows, `width` numbers each."""

    def __init__(self, width: int) -> None:
        self.width = width
        self._means = np.zeros((MOST_BLOCKS, width))
        self._blocks = 0
        self._length = 1
        self._sum = np.zeros(width)
        self._rows = 0

    @property
    def samples(self) -> int:
        """Number of rows so far."""
        return self._blocks * self._length + self._rows

    @property
    def length(self) -> int:
        """Rows in a block."""
        return self._length

    @property
    def means(self) -> Array:
        """Means of the whole blocks, shape (blocks, width), in the order of time."""
        return self._means[: self._blocks].copy()

    def add(self, row: Array) -> None:
        """Take in a sample, shape (width,)."""
        self._sum += row
        self._rows += 1
        if self._rows < self._length:
            return
        self._means[self._blocks] = self._sum / self._length
        self._blocks += 1
        self._sum[:] = 0.0
        self._rows = 0
        if self._blocks == MOST_BLOCKS:
            self._merge()

    def mean(self) -> Array:
        """Mean of all rows, those of the unfinished block included, shape (width,); nan before the first."""
        if self.samples == 0:
            return np.full(self.width, np.nan)
        return np.asarray((self._means[: self._blocks].sum(axis=0) * self._length + self._sum) / self.samples)

    def values(self) -> Means:
        """The means, to compute with."""
        mean = self.mean()
        return Means(mean, self._means[: self._blocks] - mean)

    def error(self) -> Array:
        """Standard error of each mean, shape (width,); nan where the run was too short to tell."""
        return self.values().error()

    def covariance(self) -> tuple[Array, int]:
        """Covariance of the means, shape (width, width), and the number of blocks behind it; see `Means.covariance`."""
        return self.values().covariance()

    def ratio(self, numerator: slice, denominator: slice) -> tuple[Array, Array]:
        """<numerator>/<denominator>, component by component, and its standard error by the delta method.

        So the mean velocity of a bin is <sum of m v>/<sum of m>, whether or not the bin was empty at times; nan where
        the denominator is zero.
        """
        values = self.values()
        ratio = values[numerator] / values[denominator]
        return ratio.value, ratio.error()

    def state(self) -> State:
        """All that is needed to go on bit for bit."""
        return {
            "means": self.means,
            "length": np.array(self._length),
            "sum": self._sum.copy(),
            "rows": np.array(self._rows),
        }

    def restore(self, state: State) -> None:
        """Go on from a state of blocks of the same width."""
        means = state["means"]
        if means.shape[1:] != (self.width,) or len(means) >= MOST_BLOCKS:
            raise ValueError(
                f"saved block means have the shape {means.shape} (rows here have {self.width} numbers, in less than"
                f" {MOST_BLOCKS} blocks); measure what was measured before"
            )
        self._blocks = len(means)
        self._means[: self._blocks] = means
        self._length = int(state["length"])
        self._sum[:] = state["sum"]
        self._rows = int(state["rows"])

    def _merge(self) -> None:
        self._blocks = MOST_BLOCKS // 2
        self._means[: self._blocks] = 0.5 * (self._means[0::2] + self._means[1::2])
        self._length *= 2


def fitted_slope(x: ArrayLike) -> Array:
    """Weights w with sum_i w_i y_i the slope of the line that fits y(x) best by least squares."""
    away = np.asarray(x, dtype=np.float64)
    away = away - away.mean()
    return np.asarray(away / (away @ away))


def over(parts: list[Means], function: Callable[[Means], Means]) -> tuple[Array, Array]:
    """function(part) and its errors, of parts that were blocked apart, one after the other along the first axis."""
    found = [function(part) for part in parts]
    return np.concatenate([each.value for each in found]), np.concatenate([each.error() for each in found])


def _error(column: Array) -> float:
    found = _estimate(column)
    return found.error if found is not None else np.nan


def _estimate(column: Array) -> Estimate | None:
    return estimate(column) if len(column) > 0 and np.isfinite(column).all() else None
