"""Channel: reverse Poiseuille flow of a suspension, its half-channels laid on each other.

The box holds two channels of half-width h = L/4, with the flow up in one and down in the other. What is measured at the
distance xi on either side of either centerline is the same by symmetry, up to the sign of the velocity: a run gives
four half-channels. Their scatter gives the errors, widened by Student's t (`tether.study.means`): bodies take as long
to migrate across a channel as such runs last, so that blocks of a run's own time are not independent.

Momentum balance gives the stress, and with it the local viscosity, without a formula for the stress:

    eta(xi) = integral of f from 0 to xi / -(du/dxi),        f: driving force per volume                            (1)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, ndtri, stdtrit

from tether.estimate import Estimate
from tether.paper.exhibit import Part
from tether.study.means import FEWEST_REPEATS, mean_of

Rows = NDArray[np.float64]

_NINETY_NINE = 0.995
"""The probability below the upper end of an interval that holds 99 %."""


def half_channels(profile: ArrayLike, *, turns: bool = False) -> Rows:
    """The four half-channels of a profile over the box, shape (bins,) -> (4, bins/4), from the centerline to the wall.

    turns: the profile changes its sign from one channel to the other, as velocity and force do; the flow is upward in
    the upper half of the box. Raises ValueError unless the bins are a multiple of four.
    """
    values = np.asarray(profile, dtype=np.float64)
    quarter, rest = divmod(len(values), 4)
    if rest or not quarter:
        raise ValueError(f"{len(values)} bins do not make four half-channels; give a multiple of four")
    sign = -1.0 if turns else 1.0
    lower_left, lower_right, upper_left, upper_right = np.split(values, 4)
    return np.stack([sign * lower_left[::-1], sign * lower_right, upper_left[::-1], upper_right])


def mean_of_rows(values: ArrayLike) -> Estimate:
    """The mean over half-channels, (n,), with the error of their scatter; nan for fewer than three."""
    rows = np.asarray(values, dtype=np.float64)
    mean = mean_of(rows, np.full(len(rows), math.nan), np.ones(len(rows)))
    known = len(rows) >= FEWEST_REPEATS and math.isfinite(mean.error)
    return Estimate(mean.value, mean.error, len(rows), 1.0, converged=known, blocks=len(rows))


def mean_for_verdict(values: ArrayLike) -> Estimate:
    """The same for claims, whose rules ask for two to three errors: a wider one, so that 2.58 of them hold the true
    mean in 99 of 100 cases.

    With the tails of Student's t, 2.58 of the errors of `mean_of_rows`, which are of 68 %, are too few: four
    half-channels would be beyond in 5 of 100 cases.
    """
    mean = mean_of_rows(values)
    if not mean.converged:
        return mean
    freedom = mean.samples - 1
    widening = stdtrit(freedom, _NINETY_NINE) / ndtri(_NINETY_NINE) / stdtrit(freedom, ndtr(1.0))
    return replace(mean, error=float(mean.error * widening))


@dataclass(frozen=True)
class Channel:
    """Half-channels of one or more runs: rows over half-channels, columns over bins from the centerline to the wall."""

    half_width: float
    """h, length."""
    fraction: Rows
    """Particle fraction (eq. 42), which is the volume fraction (eq. 43) where all particles take the same room."""
    density: Rows
    """Of all particles, number/length^d."""
    force_density: Rows
    """Driving force per volume."""
    velocity: Rows
    """Along the flow, positive."""
    temperature: Rows
    """Kinetic, of all particles about the flow."""

    @classmethod
    def of(cls, profiles: Sequence[xr.Dataset]) -> Channel:
        """From the datasets of `tether.observe.profiles` of runs of the same configuration."""

        def laid(name: str, turns: bool = False) -> Rows:
            return np.concatenate([half_channels(each[name].values, turns=turns) for each in profiles])

        y = profiles[0]["y"].values
        return cls(
            half_width=float(y[0]) * 2.0 * len(y) / 4.0,  # the first bin begins at 0
            fraction=laid("particle_fraction"),
            density=laid("density"),
            force_density=laid("driving_force_density", turns=True),
            velocity=laid("velocity", turns=True),
            temperature=laid("temperature"),
        )

    @property
    def bins(self) -> int:
        """Of a half-channel."""
        return int(self.velocity.shape[1])

    @property
    def width(self) -> float:
        """Of a bin."""
        return self.half_width / self.bins

    @property
    def distance(self) -> Rows:
        """xi at the middles of the bins, (bins,)."""
        return np.asarray((np.arange(self.bins) + 0.5) * self.width)

    @property
    def edges(self) -> Rows:
        """xi at the edges between bins, (bins - 1,)."""
        return np.asarray(np.arange(1, self.bins) * self.width)

    @property
    def shear_rate(self) -> Rows:
        """-du/dxi at the edges, (n, bins - 1)."""
        return -np.diff(self.velocity, axis=1) / self.width

    @property
    def viscosity(self) -> Rows:
        """eta at the edges by momentum balance, eq. (1), (n, bins - 1)."""
        stress = np.cumsum(self.force_density, axis=1)[:, :-1] * self.width
        return np.asarray(stress / self.shear_rate)

    @property
    def fraction_at_edges(self) -> Rows:
        """Mean of the two bins at an edge, (n, bins - 1)."""
        return np.asarray(0.5 * (self.fraction[:, 1:] + self.fraction[:, :-1]))

    @property
    def maximum_velocity(self) -> Rows:
        """At the centerline, (n,): the parabola through the means of the two bins next to it, whose mean over the bin
        from 0 to w is u(0) - c w^2/3, over the next one u(0) - 7 c w^2/3."""
        first, second = self.velocity[:, 0], self.velocity[:, 1]
        return np.asarray(first + (first - second) / 6.0)

    def near_center(self, profile: Rows, within: float) -> Rows:
        """Mean of a profile over the bins up to that distance from the centerline, (n,)."""
        return np.asarray(profile[:, : self._count(within)].mean(axis=1))

    def near_wall(self, profile: Rows, within: float) -> Rows:
        """Mean of a profile over the bins up to that distance from the wall, (n,)."""
        return np.asarray(profile[:, -self._count(within) :].mean(axis=1))

    def _count(self, within: float) -> int:
        return max(1, round(within / self.width))


def channels_of(part: Part) -> dict[float, Channel]:
    """By the driving force, "flow.force", from all repeats of a study that sweeps nothing else."""
    profiles: dict[float, list[xr.Dataset]] = {}
    for values, record in part.records:
        profiles.setdefault(values["flow.force"], []).append(record.datasets()["profiles"])
    return {force: Channel.of(found) for force, found in profiles.items()}
