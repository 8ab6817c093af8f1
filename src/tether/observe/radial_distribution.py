"""Radial distribution functions, effective sizes, and the pair distribution of bodies in the flow-gradient plane.

The paper's eq. 39 for a partner at the distance q, d = 3 or 2:

    g(q) = s / (N/V  4 pi q^2 dq)    or    s / (N/A  2 pi q dq)

with s the mean number of partners in the shell from q to q + dq of a particle. Here the shell has its exact volume,
4 pi ((q + dq)^3 - q^3)/3 or pi ((q + dq)^2 - q^2), of which eq. 39 has the first order in dq, and N is the number of
partners that there are: N - 1 for a particle among N of its own kind. So points placed independently and uniformly
have g = 1 exactly, at every q, for any number of them.

Effective sizes (section 4.4 of the paper): q_bar is where g becomes 0.01; that of two solvent particles is the
diameter of one, a_S = q_bar/2, and that of a body's center and a solvent particle is the sum of radii, so
a_C = q_bar - a_S. The rule here: q_bar is where the straight line between the middles of two neighboring bins
passes 0.01, the farther bin being the first from which g stays at or above 0.01 as far as it is measured. Bins
that are empty by chance alone make such a place too. So it counts as q_bar only if the pairs that are closer are
fewer than g = 0.01 would give, by a one-sided Poisson test at 1 % (pairs taken as independent). It fails where g(0)
is above 0.01, as for the solvent at kT = 1: there q_bar is not a number, and the paper's figure is one of
resolution. It is given apart, under a name of its own: the farther edge of that first bin, which depends on the bin
width and, in 3D, on the length of the run.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import pdtr

from tether import _core
from tether.observe.counts import CountBlocks, Ratio
from tether.observe.moment import Moment
from tether.observe.observer import State

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

THRESHOLD = 0.01
"""The g that counts as the first that is not zero, a pure number (the paper, section 4.4)."""

MOST_BODIES = 3000
"""With more bodies, a look at each pair of them would cost more than many a step."""

_FALSE_ALARM = 0.01


@dataclass(frozen=True)
class _Bins:
    """`number` bins of equal `width` from 0 to `end`, length."""

    number: int
    width: float
    end: float

    @classmethod
    def within(cls, limit: float, width: float) -> _Bins:
        """As many whole ones as there are below the limit, which rounding must not pass."""
        number = math.floor(limit / width * (1.0 + 1e-12))
        return cls(number, width, min(number * width, limit))

    @property
    def middles(self) -> Array:
        return np.asarray((np.arange(self.number) + 0.5) * self.width, dtype=np.float64)

    def shells(self, dimension: int) -> Array:
        """Volume between two spheres (3D) or circles (2D) for each bin, length^d."""
        edges = np.arange(self.number + 1) * self.width
        volume = 4.0 / 3.0 * math.pi * edges**3 if dimension == 3 else math.pi * edges**2
        return np.asarray(volume[1:] - volume[:-1], dtype=np.float64)


class RadialDistribution:
    """g(r) of solvent and solvent, bodies' centers and solvent, and bodies' centers, aware of the sheared box.

    interval: steps between samples. kinds: names of the kinds of bodies, one for each [[bodies]] table. bin_width: dq,
    length. reach: up to where pairs with solvent are counted, length, at most a third of the smallest side of
    the box; it should be well beyond the radius of the largest body. Bodies are counted up to half of the smallest
    side; more than MOST_BODIES of them up to three times the reach and a third of the side. map_width, map_reach: side
    of a bin, and greatest distance along x and along y, of the map of pairs of bodies (of all kinds together), length.
    thickness: the map takes pairs with |z_ij| below it, length; at most half of the side in z. threads: to count with;
    counts do not depend on it.

    Errors: see `tether.observe.counts.Ratio`; they are 0 where no pair was ever seen. Those of radii are a jackknife's.
    """

    def __init__(
        self,
        interval: int,
        *,
        kinds: Sequence[str] = (),
        bin_width: float = 0.01,
        reach: float = 2.0,
        map_width: float = 0.1,
        map_reach: float = 3.0,
        thickness: float = 0.5,
        threads: int = 1,
    ) -> None:
        if len(set(kinds)) < len(kinds):
            raise ValueError(f"two kinds of bodies have one name ({', '.join(kinds)}); name them differently")
        self.interval = interval
        self._kinds = tuple(kinds)
        self._bin_width = bin_width
        self._reach = reach
        self._map_width = map_width
        self._map_reach = map_reach
        self._thickness = thickness
        self._threads = threads
        self._blocks: CountBlocks | None = None  # shaped by the first sample, which tells the box and the numbers

    def sample(self, moment: Moment) -> None:
        """Count the pairs of one step."""
        blocks = self._blocks or self._lay_out(np.array(moment.size, np.float64), self._numbers_of(moment))
        blocks.add(
            {
                "solvent": self._pairs_with_solvent(moment),
                "bodies": self._pairs_of_bodies(moment),
                "map": self._map_of_bodies(moment),
            }
        )

    def state(self) -> State:
        """Counts by block of time, the box and the numbers of particles; empty before the first sample."""
        if self._blocks is None:
            return {}
        return {"size": self._size.copy(), "numbers": self._numbers.copy()} | self._blocks.state()

    def restore(self, state: State) -> None:
        """Go on from `state`; ValueError if it was made with other bins."""
        self._blocks = None
        if state:
            self._lay_out(state["size"].astype(np.float64), state["numbers"].astype(np.int64)).restore(state)

    def dataset(self) -> xr.Dataset | None:
        """g and its error by distance (bin middles), the map, and the effective sizes; None before any sample.

        `r` is the distance to solvent, `r_bodies` that of bodies; `g_<kind>_<kind>` is left out where there are no
        two bodies of these kinds.
        """
        if self._blocks is None:
            return None
        found = xr.Dataset(attrs={"samples": self._blocks.samples, "steps_per_sample": self.interval})
        curves = self._curves_of_solvent(self._blocks)
        if any(curves.values()):
            found["r"] = ("r", self._solvent_bins.middles, _length("distance, middle of the bin"))
        for name, curve in curves.items():
            if curve is not None:
                _put(found, f"g_{name}_solvent", "r", curve, f"radial distribution function, {name} and solvent")
        if self._bodies_bins.number > 0:
            self._put_bodies(found, self._blocks)
        if self._map_bins.number > 0:
            self._put_map(found, self._blocks)
        self._put_sizes(found, curves)
        return found

    # What is counted

    def _lay_out(self, size: Array, numbers: Integers) -> CountBlocks:
        """Choose the bins. numbers: of solvent particles and of the bodies of each kind, (1 + kinds,)."""
        self._size, self._numbers = size, numbers
        smallest, bodies = float(size.min()), int(numbers[1:].sum())
        far = smallest / 2 if bodies <= MOST_BODIES else min(smallest / 3, 3 * self._reach)
        aside = min(self._map_reach, float(size[:2].min()) / 2)
        several = 1.0 if bodies > 1 else 0.0
        self._solvent_bins = _Bins.within(min(self._reach, smallest / 3), self._bin_width)
        self._bodies_bins = _Bins.within(several * far, self._bin_width)
        self._map_bins = _Bins.within(several * aside, self._map_width)  # to one side
        self._slab = min(self._thickness, float(size[2]) / 2) if len(size) == 3 else 0.0
        kinds, side = len(numbers) - 1, 2 * self._map_bins.number
        self._blocks = CountBlocks(
            {
                "solvent": (kinds + 1, self._solvent_bins.number),
                "bodies": (kinds, kinds, self._bodies_bins.number),
                "map": (side, side),
            }
        )
        return self._blocks

    def _numbers_of(self, moment: Moment) -> Integers:
        bodies = np.bincount(moment.kind, minlength=len(self._kinds))
        if len(bodies) > len(self._kinds):
            raise ValueError(f"there are {len(bodies)} kinds of bodies (and {len(self._kinds)} names); name every kind")
        return np.concatenate([[moment.solvent], bodies]).astype(np.int64)

    def _pairs_with_solvent(self, moment: Moment) -> Integers:
        """Pairs of solvent with each group of points, every pair once, (1 + kinds, bins)."""
        position = np.concatenate([moment.position[: moment.solvent], moment.center])
        group = np.concatenate([np.zeros(moment.solvent, np.intp), 1 + moment.kind])
        return np.asarray(self._counted(moment, position, group, len(self._numbers), self._solvent_bins)[0])

    def _pairs_of_bodies(self, moment: Moment) -> Integers:
        """Pairs of bodies by their kinds, every pair once, (kinds, kinds, bins)."""
        return self._counted(moment, moment.center, moment.kind, len(self._kinds), self._bodies_bins)

    def _counted(self, moment: Moment, position: Array, group: NDArray[np.intp], groups: int, bins: _Bins) -> Integers:
        if bins.number == 0:
            return np.zeros((groups, groups, 0), np.int64)
        counts = _core.pair_histogram(
            np.ascontiguousarray(position), moment.size, moment.offset, bins.end, bins.number,
            group.astype(np.uint8), groups, self._threads,
        )  # fmt: skip
        return np.asarray(counts, dtype=np.int64)

    def _map_of_bodies(self, moment: Moment) -> Integers:
        """Ordered pairs of bodies by their separation along y and x, (bins, bins)."""
        bins = self._map_bins
        if bins.number == 0:
            return np.zeros((0, 0), np.int64)
        counts = _core.pair_map(
            np.ascontiguousarray(moment.center), moment.size, moment.offset, bins.end, 2 * bins.number,
            self._slab, self._threads,
        )  # fmt: skip
        return np.asarray(counts, dtype=np.int64)

    # What follows from it

    def _ratio(self, blocks: CountBlocks, name: str, entry: tuple[int, ...], pairs: float, region: Array) -> Ratio:
        """g of so many pairs, counted in regions of such volumes: uniform points find pairs region/V in each."""
        return Ratio(*blocks.counts(name, entry), pairs * region / float(self._size.prod()))

    def _curves_of_solvent(self, blocks: CountBlocks) -> dict[str, Ratio | None]:
        """g of solvent with itself and with the bodies of each kind, by name; None where there is no pair."""
        shells = self._solvent_bins.shells(len(self._size))
        solvent = int(self._numbers[0])
        curves: dict[str, Ratio | None] = {}
        for label, name in enumerate(("solvent", *self._kinds)):
            pairs = solvent * (solvent - 1) / 2 if label == 0 else solvent * int(self._numbers[label])
            curves[name] = (
                self._ratio(blocks, "solvent", (label,), pairs, shells) if pairs > 0 and shells.size else None
            )
        return curves

    def _put_bodies(self, found: xr.Dataset, blocks: CountBlocks) -> None:
        bins = self._bodies_bins
        found["r_bodies"] = ("r_bodies", bins.middles, _length("distance of two bodies, middle of the bin"))
        for (a, first), (b, second) in combinations_with_replacement(enumerate(self._kinds), 2):
            here, there = int(self._numbers[1 + a]), int(self._numbers[1 + b])
            pairs = here * (here - 1) / 2 if a == b else here * there
            if pairs > 0:
                curve = self._ratio(blocks, "bodies", (a, b), pairs, bins.shells(len(self._size)))
                told = f"radial distribution function, centers of {first} and {second}"
                _put(found, f"g_{first}_{second}", "r_bodies", curve, told)

    def _put_map(self, found: xr.Dataset, blocks: CountBlocks) -> None:
        bodies, width, right = int(self._numbers[1:].sum()), self._map_bins.width, self._map_bins.middles
        middles = np.concatenate([-right[::-1], right])
        for axis in "xy":
            told = f"separation of two bodies along {axis}, middle of the bin"
            found[f"separation_{axis}"] = (f"separation_{axis}", middles, _length(told))
        region = width**2 * (2 * self._slab if len(self._size) == 3 else 1.0)
        curve = self._ratio(blocks, "map", (), bodies * (bodies - 1.0), np.full((len(middles),) * 2, region))
        slab = f", |z| < {self._slab:g}" if len(self._size) == 3 else ""
        told = f"pair distribution of bodies in the flow-gradient plane{slab}"
        _put(found, "g_bodies_plane", ("separation_y", "separation_x"), curve, told)

    def _put_sizes(self, found: xr.Dataset, curves: dict[str, Ratio | None]) -> None:
        """q_bar and effective radii; a body's takes the solvent's by resolution where that has no other."""
        solvent = curves["solvent"]
        if solvent is None:
            return
        r = self._solvent_bins.middles
        q_bar, q_error = _contact(r, solvent)
        first = _first_above(solvent.mean())
        by_resolution = (first + 1) * self._bin_width / 2 if first < len(r) else math.nan
        _put_size(found, "contact_distance_solvent", q_bar, q_error, "q_bar of two solvent particles")
        _put_size(found, "effective_radius_solvent", q_bar / 2, q_error / 2, "a_S = q_bar/2")
        told = "a_S in the paper's reading: half of the farther edge of the first bin from which g stays above 0.01"
        found["effective_radius_solvent_by_resolution"] = ((), by_resolution, _length(told))
        has_size = math.isfinite(q_bar)
        radius, radius_error = (q_bar / 2, q_error / 2) if has_size else (by_resolution, 0.0)
        for kind in self._kinds:
            if (curve := curves[kind]) is not None:
                q_bar, q_error = _contact(r, curve)
                _put_size(found, f"contact_distance_{kind}", q_bar, q_error, f"q_bar of {kind} and solvent")
                told = "a_C = q_bar - a_S" + ("" if has_size else ", a_S: effective_radius_solvent_by_resolution")
                _put_size(found, f"effective_radius_{kind}", q_bar - radius, math.hypot(q_error, radius_error), told)


def _first_above(g: Array) -> int:
    """The first bin from which g stays at or above the threshold; the number of bins where it never does."""
    below = np.flatnonzero(g < THRESHOLD)
    return int(below[-1]) + 1 if below.size else 0


def _crossing(r: Array, g: Array) -> float:
    """Where the line between the middles of that bin and the one before it passes the threshold; nan without these."""
    k = _first_above(g)
    if k in (0, len(g)):
        return math.nan
    share = (THRESHOLD - g[k - 1]) / (g[k] - g[k - 1])
    return float(r[k - 1] + share * (r[k] - r[k - 1]))


def _contact(r: Array, curve: Ratio) -> tuple[float, float]:
    """q_bar and its error; not numbers where it might be made by bins that chance left empty (see the module)."""
    k = _first_above(curve.mean())
    counted, expected = int(curve.counts()[:k].sum()), THRESHOLD * float(curve.expected()[:k].sum())
    if pdtr(counted, expected) > _FALSE_ALARM:
        return math.nan, math.nan
    return _crossing(r, curve.mean()), curve.jackknife(lambda g: _crossing(r, g))


def _put(found: xr.Dataset, name: str, dims: str | tuple[str, ...], curve: Ratio, told: str) -> None:
    found[name] = (dims, curve.mean(), {"units": "1", "long_name": told})
    found[f"{name}_error"] = (dims, curve.error(), {"units": "1", "long_name": f"standard error of {name}"})


def _put_size(found: xr.Dataset, name: str, value: float, error: float, told: str) -> None:
    found[name] = ((), value, _length(told))
    found[f"{name}_error"] = ((), error, _length(f"standard error of {name}"))


def _length(told: str) -> dict[str, str]:
    return {"units": "length", "long_name": told}
