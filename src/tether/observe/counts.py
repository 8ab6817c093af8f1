"""Counts: how often things were found in each bin, by block of time, against how often they were to be expected."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tether.observe.observer import State

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_BLOCKS = 64
"""Blocks of time that counts are kept of; when they are full, neighbors are merged, and 32 are left."""

FEWEST_BLOCKS = 16
"""Fewer whole blocks than this give no error."""


class CountBlocks:
    """Counts of several names summed over blocks of time, all but the last one equally long.

    Counts are integers, so neither mergers nor the order of anything rounds them.
    """

    def __init__(self, shapes: dict[str, tuple[int, ...]]) -> None:
        self._counts = {name: np.zeros((MOST_BLOCKS, *shape), np.int64) for name, shape in shapes.items()}
        self._samples = np.zeros(MOST_BLOCKS, np.int64)
        self._length = 1  # samples in a block

    @property
    def samples(self) -> int:
        return int(self._samples.sum())

    def add(self, counts: dict[str, Integers]) -> None:
        """Take in one sample."""
        block = self.samples // self._length
        if block == MOST_BLOCKS:
            self._merge()
            block = MOST_BLOCKS // 2
        self._samples[block] += 1
        for name, count in counts.items():
            self._counts[name][block] += count

    def counts(self, name: str, entry: tuple[int, ...]) -> tuple[Integers, Integers]:
        """Counts of an entry by block and the samples in each, the unfinished block included."""
        used = self._samples > 0
        return self._counts[name][(used, *entry)], self._samples[used]

    def state(self) -> State:
        used = self._samples > 0
        counts = {f"counts_{name}": count[used] for name, count in self._counts.items()}
        return {"samples": self._samples[used], "length": np.array(self._length)} | counts

    def restore(self, state: State) -> None:
        used = len(state["samples"])
        self._samples[:used] = state["samples"]
        self._length = int(state["length"])
        for name, count in self._counts.items():
            saved = state[f"counts_{name}"]
            if saved.shape[1:] != count.shape[1:]:
                raise ValueError(
                    f"saved counts have bins of shape {saved.shape[1:]} (here they are {count.shape[1:]});"
                    " use the bins that the run began with"
                )
            count[:used] = saved

    def _merge(self) -> None:
        for array in (self._samples, *self._counts.values()):
            array[: MOST_BLOCKS // 2] = array[0::2] + array[1::2]
            array[MOST_BLOCKS // 2 :] = 0
        self._length *= 2


class Ratio:
    """g = counts/(samples ideal) over bins. counts: (blocks, ...), samples: of each block, ideal: a sample's at g = 1.

    Errors are standard errors from the whole blocks, 32 to 64 in a long run. What correlation neighboring blocks have
    left is put in as in `tether.estimate`, by the factor 1 + 2 rho_1 of the variance, with one rho_1 for all bins:
    their mean, which is known far better than that of one bin.
    """

    def __init__(self, counts: Integers, samples: Integers, ideal: Array) -> None:
        self._counts, self._samples, self.ideal = counts, samples, ideal
        whole = samples == samples[0]  # all but the unfinished block
        self._whole_counts, self._whole_samples = counts[whole], samples[whole]

    def mean(self) -> Array:
        return np.asarray(self.counts() / self.expected())

    def counts(self) -> Integers:
        """Of all samples."""
        return np.asarray(self._counts.sum(axis=0))

    def expected(self) -> Array:
        """The counts of all samples if g were 1."""
        return np.asarray(self._samples.sum() * self.ideal)

    def error(self) -> Array:
        """Standard error of the mean, of its shape; nan from too few blocks."""
        blocks = len(self._whole_counts)
        if blocks < FEWEST_BLOCKS:
            return np.full(self.ideal.shape, np.nan)
        variance = self._deviations().var(axis=0)
        return np.asarray(np.sqrt(variance * self._correlation_factor() / (blocks - 1)))

    def jackknife(self, function: Callable[[Array], float]) -> float:
        """Standard error of function(g) from leaving out one block after the other; nan from too few blocks.

        error^2 = (n - 1)/n sum_b (f_b - mean of f)^2, with f_b = function(g without block b).
        """
        blocks = len(self._whole_counts)
        if blocks < FEWEST_BLOCKS:
            return math.nan
        rest = self._whole_counts.sum(axis=0) - self._whole_counts
        samples = self._whole_samples.sum() - self._whole_samples
        values = np.array([function(counts / (n * self.ideal)) for counts, n in zip(rest, samples, strict=True)])
        return math.sqrt((blocks - 1) * float(values.var()) * self._correlation_factor())

    def _deviations(self) -> Array:
        g = self._whole_counts / (self._whole_samples[0] * self.ideal)
        return np.asarray(g - g.mean(axis=0))

    def _correlation_factor(self) -> float:
        """1 + 2 rho_1, rho_1 the correlation of neighboring blocks where it is positive, averaged over the bins.

        The estimator of it is 1/blocks too low for independent blocks.
        """
        deviations = self._deviations()
        variance = deviations.var(axis=0)
        seen = variance > 0
        if not seen.any():
            return 1.0
        blocks = len(deviations)
        covariance = (deviations[1:] * deviations[:-1]).sum(axis=0) / blocks
        return 1.0 + 2.0 * max(0.0, float((covariance[seen] / variance[seen]).mean()) + 1.0 / blocks)
