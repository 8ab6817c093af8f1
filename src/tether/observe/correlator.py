"""Correlations over lags from one sample to the length of the run, while the run goes: a multiple-tau correlator.

J. Ramirez, S. K. Sukumaran, B. Vorselaars and A. E. Likhtman, J. Chem. Phys. 133, 154103 (2010), doi
10.1063/1.3491098. Level 0 keeps the last p samples and has the lags 0, 1, ..., p - 1; level l takes one sample for m^l
of the series and has the lags p/m, ..., p - 1 in units of m^l. Lags so lie p (1 - 1/m) to a factor m, memory and work
grow with the logarithm of the run.

What a coarser level takes is a choice. Every m-th sample of the level below (`average=False`): exact at every lag; the
only choice for displacements. Or the mean of m samples: less noise where the series has much, but the correlation
comes out smoothed by a triangle of half-width w = m^l samples, C + (w^2 - 1)/12 C'' with C'' per sample^2, a relative
(lag/t)^2 / (12 (p/m)^2) at the first lag of a level for C = exp(-lag/t): 0.1 % at lag = t for p = 16, m = 2.

A level's rows are added up from when it has p samples: all its lags have the same origins in time, so that what is
fitted over the lags of one level has an honest error (`tether.observe.blocks`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tether.observe.blocks import Array, Blocks, Means
from tether.observe.observer import State, part, under

POINTS = 16
"""Samples that a level keeps, p."""

FACTOR = 2
"""How much coarser each level is than the one below, m."""


class MultipleTau:
    """Block means of rows that are made of a sample and of earlier ones.

    row(then, now, *beside): `then` are the samples at the lags of a level, shape (lags, *shape), `now` is the latest,
    shape (*shape,), `beside` is whatever else was given with it; it returns (lags, *row_shape). levels: at most.
    """

    def __init__(
        self,
        shape: tuple[int, ...],
        row: Callable[..., Array],
        row_shape: tuple[int, ...],
        *,
        points: int = POINTS,
        factor: int = FACTOR,
        average: bool = False,
        levels: int | None = None,
    ) -> None:
        if factor < 2 or points < 2 * factor or points % factor != 0:
            raise ValueError(
                f"{points} points and a factor of {factor} make no levels (the coarser one goes on from points/factor);"
                " give a multiple of the factor, at least twice it, for points"
            )
        self.shape = shape
        self.row_shape = row_shape
        self.points = points
        self.factor = factor
        self.average = average
        self.most_levels = levels
        self._row = row
        self._levels: list[_Level] = []
        self.samples = 0

    def add(self, sample: Array, *beside: Array) -> None:
        """Take in the next sample of the series, shape (*shape,)."""
        if self.average:
            assert not beside, "nothing beside the sample is averaged"
        for number in self._taking():
            level = self._level(number)
            level.history.push(level.mean() if self.average and number > 0 else sample)
            if level.history.is_full:
                then, now = level.history.by_lag(level.first), level.history.latest
                level.blocks.add(self._row(then, now, *beside).ravel())
            if self.average and number + 1 != self.most_levels:
                self._level(number + 1).gather(level.history.latest)
        self.samples += 1

    def lags(self, level: int) -> NDArray[np.int64]:
        """Lags of a level, in samples."""
        first = 0 if level == 0 else self.points // self.factor
        return np.asarray(np.arange(first, self.points) * self.factor**level, dtype=np.int64)

    def levels(self) -> list[tuple[NDArray[np.int64], Means]]:
        """Of each level that has anything: its lags in samples, (lags,), and means of its rows, (lags, *row_shape)."""
        return [
            (self.lags(number), level.blocks.values().reshaped(len(self.lags(number)), *self.row_shape))
            for number, level in enumerate(self._levels)
            if level.blocks.samples > 0
        ]

    def state(self) -> State:
        """All that is needed to go on bit for bit."""
        state: State = {"samples": np.array(self.samples), "levels": np.array(len(self._levels))}
        for number, level in enumerate(self._levels):
            state |= under(f"level_{number}", level.state())
        return state

    def restore(self, state: State) -> None:
        """Go on from the state of one that was made with the same arguments."""
        self.samples = int(state["samples"])
        self._levels = []
        for number in range(int(state["levels"])):
            self._level(number).restore(part(f"level_{number}", state))

    def _taking(self) -> Iterator[int]:
        """The levels that take this sample, from the finest; level l takes it where factor^l divides its number.

        The number counts from 0 without averaging, whose levels begin with the first sample that is not number 0 (so
        that they can be made when they are needed), and from 1 with it: a mean ends with its last sample.
        """
        number = self.samples + 1 if self.average else self.samples
        yield 0
        level, spacing = 1, self.factor
        while number > 0 and number % spacing == 0 and level != self.most_levels:
            yield level
            level, spacing = level + 1, spacing * self.factor

    def _level(self, number: int) -> _Level:
        if number == len(self._levels):
            lags = self.lags(number)
            width = len(lags) * int(np.prod(self.row_shape))
            self._levels.append(_Level(self.shape, self.points, self.points - len(lags), width, self.average))
        return self._levels[number]


class Correlator:
    """Autocorrelation <a(t) a(t + lag)> of each component of a series, averaged over members and over time.

    A sample has the shape (components, members), the members group by group (groups: members in each), as velocities
    of all particles; or just (components,). about: what is taken off each component first, its known mean.
    """

    def __init__(
        self,
        components: int = 1,
        groups: Sequence[int] = (1,),
        *,
        about: ArrayLike = 0.0,
        points: int = POINTS,
        factor: int = FACTOR,
        average: bool = True,
        levels: int | None = None,
    ) -> None:
        self.components = components
        self.slices = slices_of(groups)
        self.about = np.broadcast_to(np.asarray(about, dtype=np.float64), (components,))[:, None]
        self._tau = MultipleTau(
            (components, sum(groups)),
            self._products,
            (len(groups), components),
            points=points,
            factor=factor,
            average=average,
            levels=levels,
        )

    @property
    def samples(self) -> int:
        """Number of samples so far."""
        return self._tau.samples

    def add(self, sample: ArrayLike) -> None:
        """Take in the next sample of the series."""
        array = np.asarray(sample, dtype=np.float64)
        self._tau.add(array.reshape(self._tau.shape) - self.about)

    def levels(self) -> list[tuple[NDArray[np.int64], Means]]:
        """Of each level: its lags in samples, (lags,), and the correlations, (lags, groups, components)."""
        return self._tau.levels()

    def lags(self) -> NDArray[np.int64]:
        """All lags that there is anything for, in samples, increasing."""
        return np.concatenate([np.zeros(0, dtype=np.int64), *(lags for lags, _ in self.levels())])

    def correlation(self) -> tuple[Array, Array]:
        """Correlations at `lags()` and their standard errors, (lags, groups, components) each; units of a^2."""
        found = [means for _, means in self.levels()]
        empty = np.zeros((0, len(self.slices), self.components))
        return (
            np.concatenate([empty, *(means.value for means in found)]),
            np.concatenate([empty, *(means.error() for means in found)]),
        )

    def state(self) -> State:
        """All that is needed to go on bit for bit."""
        return self._tau.state()

    def restore(self, state: State) -> None:
        """Go on from the state of one that was made with the same arguments."""
        self._tau.restore(state)

    def _products(self, then: Array, now: Array) -> Array:
        return mean_products(then, now, self.slices)


def slices_of(groups: Sequence[int]) -> list[slice]:
    """Where each group stands among the members."""
    ends = np.cumsum(groups).tolist()
    return [slice(end - size, end) for end, size in zip(ends, groups, strict=True)]


def mean_products(then: Array, now: Array, groups: Sequence[slice]) -> Array:
    """Mean over each group's members of then * now; then: (lags, components, members), now without lags or like it.

    Returns (lags, groups, components). The sum is einsum's own, whose order no number of threads changes.
    """
    form = "lcn,lcn->lc" if now.ndim == 3 else "lcn,cn->lc"
    found = [np.einsum(form, then[..., group], now[..., group]) / (group.stop - group.start) for group in groups]
    return np.stack(found, axis=1)


class _Level:
    """The last samples of one coarseness and what was made of them."""

    def __init__(self, shape: tuple[int, ...], points: int, first: int, width: int, average: bool) -> None:
        self.first = first
        self.history = _History(shape, points)
        self.blocks = Blocks(width)
        self._sum = np.zeros(shape if average else 0)
        self._gathered = 0

    def gather(self, sample: Array) -> None:
        self._sum += sample
        self._gathered += 1

    def mean(self) -> Array:
        """Mean of what was gathered since the last one."""
        mean = self._sum / self._gathered
        self._sum[:] = 0.0
        self._gathered = 0
        return np.asarray(mean)

    def state(self) -> State:
        return {
            "history": self.history.samples.copy(),
            "sum": self._sum.copy(),
            "gathered": np.array(self._gathered),
            **under("blocks", self.blocks.state()),
        }

    def restore(self, state: State) -> None:
        for sample in state["history"]:
            self.history.push(np.asarray(sample, dtype=np.float64))
        self._sum[...] = state["sum"]
        self._gathered = int(state["gathered"])
        self.blocks.restore(part("blocks", state))


class _History:
    """The last `points` samples, always in one piece of memory: twice as many fit, and the last move to the front."""

    def __init__(self, shape: tuple[int, ...], points: int) -> None:
        self._points = points
        self._rows = np.zeros((2 * points, *shape))
        self._end = 0

    @property
    def samples(self) -> Array:
        """In the order of time, shape (at most points, *shape)."""
        return self._rows[max(0, self._end - self._points) : self._end]

    @property
    def latest(self) -> Array:
        return np.asarray(self._rows[self._end - 1])

    @property
    def is_full(self) -> bool:
        return self._end >= self._points

    def push(self, sample: Array) -> None:
        if self._end == len(self._rows):
            kept = self._points - 1
            self._rows[:kept] = self._rows[self._end - kept :]
            self._end = kept
        self._rows[self._end] = sample
        self._end += 1

    def by_lag(self, first: int) -> Array:
        """Samples at the lags first, ..., points - 1."""
        return self.samples[::-1][first:]
