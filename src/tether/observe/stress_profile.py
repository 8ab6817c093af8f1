"""Stress in bins across the gradient and through planes, and the configurational temperature.

The core (core/observe/local_stress.hpp) follows each force along a straight line from one end to the other: from
particle to particle, and from the center of a body to its constituent. Stress is positive in tension. With V_b the
volume of a bin and A the area of a plane of normal k,

    bins     S_kl = -(1/V_b) (<sum m c_k c_l> - <sum m c_k> <sum m c_l> / <sum m>) - (1/V_b) <sum r_k F_l, inside>
    planes   S_kl = -(1/A) <sum m c_l sign(c_k) / dt of what crosses> - (1/A) <sum F_l sign(r_k) of lines that cross>

The first line is that of J. H. Irving and J. G. Kirkwood, J. Chem. Phys. 18, 817 (1950), doi 10.1063/1.1747782, the
second the method of planes of B. D. Todd, D. J. Evans and P. J. Daivis, Phys. Rev. E 52, 1627 (1995), doi
10.1103/PhysRevE.52.1627: the force on a wall. c is the velocity against the imposed profile; what is left of a mean in
a bin, the measured profile of a driven flow, is taken off. Planes see the velocities of half a step ago, which carry
momentum across them in this scheme; where a flow is driven their kinetic part along the flow has the flow in it, while
S_xy, the x-force through planes normal to y, has not: nothing flows across those on average.

pairwise is kinetic + conservative + dissipative (the paper's eq. 16), total has what holds the bodies' constituents
too. Random forces have no mean and are left out, but for rigid bodies, whose constraints feel them.

Configurational temperature, of the solvent (H. H. Rugh, Phys. Rev. Lett. 78, 772 (1997), doi
10.1103/PhysRevLett.78.772):

    kT = <sum |F_C,i|^2> / <sum div_i(-F_C,i)>

with F_C,i the conservative force on particle i.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr

from tether.estimate import Estimate, estimate
from tether.observe.blocks import Array, Blocks, Means
from tether.observe.moment import Moment
from tether.observe.observer import State

BOTH = ("pairwise", "total")


class StressProfile:
    """Averages in `bins` equal bins across y, through planes at their lower edges, and through as many normal to x."""

    def __init__(self, bins: int, interval: int, size: Sequence[float]) -> None:
        self.bins = bins
        self.interval = interval
        self.size = tuple(size)
        self._d = len(self.size)
        d = self._d
        self._of_bin = 1 + d + 3 * d * d  # m, m c, m c c, pairs, what holds constituents
        self._of_plane = 3 * d  # what crosses, pairs, what holds constituents
        self._blocks = Blocks(bins * (self._of_bin + 2 * self._of_plane) + 2)

    @property
    def samples(self) -> int:
        """Number of steps seen so far."""
        return self._blocks.samples

    @property
    def y(self) -> Array:
        """Middles of the bins, shape (bins,)."""
        return np.asarray((np.arange(self.bins) + 0.5) * (self.size[1] / self.bins))

    @property
    def plane_y(self) -> Array:
        """Heights of the planes normal to y, the lower edges of the bins, shape (bins,)."""
        return np.asarray(np.arange(self.bins) * (self.size[1] / self.bins))

    def sample(self, moment: Moment) -> None:
        """Take in a step that the core looked at."""
        assert moment.local_stress is not None
        self._blocks.add(moment.local_stress)

    def state(self) -> State:
        """All that is needed to go on bit for bit."""
        return self._blocks.state()

    def restore(self, state: State) -> None:
        """Go on from the state of a profile in as many bins."""
        self._blocks.restore(state)

    def dataset(self) -> xr.Dataset | None:
        """Stress over (y, normal, force) and planes over (plane_y or plane_x, force); None before a sample."""
        if self._blocks.samples == 0:
            return None
        axes = list("xyz"[: self._d])
        unit = "energy/length^3" if self._d == 3 else "energy/length^2"
        variables = {}
        for name in BOTH:
            for dims, means, where in (
                (("y", "normal", "force"), self.in_bins(name), "in bins across y"),
                (("plane_y", "force"), self.through_planes("y", name), "through planes normal to y"),
                (("plane_x", "force"), self.through_planes("x", name), "through planes normal to x"),
            ):
                key = f"stress_{name}" + ("" if dims[0] == "y" else f"_{dims[0]}")
                words = {"units": unit, "long_name": f"{name} stress {where}, positive in tension"}
                variables[key] = (dims, means.value, words)
                words = {**words, "long_name": f"standard error of {words['long_name']}"}
                variables[f"{key}_error"] = (dims, means.error(), words)
        return xr.Dataset(
            variables,
            coords={
                "y": ("y", self.y, {"units": "length", "long_name": "height of the middle of the bin"}),
                "plane_y": ("plane_y", self.plane_y, {"units": "length", "long_name": "height of the plane"}),
                "plane_x": ("plane_x", self._plane_x, {"units": "length", "long_name": "place of the plane"}),
                "normal": axes,
                "force": axes,
            },
            attrs={"title": "tether: stress across the gradient", "samples": self._blocks.samples},
        )

    def in_bins(self, name: str) -> Means:
        """Pairwise or total stress, shape (bins, normal, force)."""
        d, values = self._d, self._values()
        bins = values[: self.bins * self._of_bin].reshaped(self.bins, self._of_bin)
        mass, momentum = bins[:, :1], bins[:, 1 : 1 + d]
        flux, pairs, held = (
            bins[:, 1 + d + part * d * d : 1 + d + (part + 1) * d * d].reshaped(self.bins, d, d) for part in range(3)
        )
        along = [momentum[:, k : k + 1] for k in range(d)]
        mean_flow = _stacked([[first * second / mass for second in along] for first in along], self.bins, d)
        stress = (-self.bins / math.prod(self.size)) * (flux - mean_flow) + pairs
        return stress + held if name == "total" else stress

    def through_planes(self, normal: str, name: str) -> Means:
        """Pairwise or total force per area through planes of that normal, shape (bins, force)."""
        first = self.bins * self._of_bin + (self.bins * self._of_plane if normal == "x" else 0)
        planes = self._values()[first : first + self.bins * self._of_plane].reshaped(self.bins, 3, self._d)
        stress = planes[:, 0] + planes[:, 1]
        return stress + planes[:, 2] if name == "total" else stress

    def plane_stress(self, normal: str, force: str, name: str = "total") -> Estimate:
        """Mean over the planes of a normal of the force per area along an axis: "y", "x" is the shear stress S_xy."""
        of_planes = self.through_planes(normal, name)[:, "xyz".index(force)]
        return _estimate((1.0 / self.bins) * of_planes.sum(-1))

    def first_normal_stress_difference(self, name: str = "total") -> Estimate:
        """N1 = S_xx - S_yy, the former through planes normal to x, the latter normal to y: the pressure falls out."""
        difference = self.through_planes("x", name)[:, 0] - self.through_planes("y", name)[:, 1]
        return _estimate((1.0 / self.bins) * difference.sum(-1))

    def configurational_temperature(self) -> Estimate:
        """Of the solvent, energy."""
        values = self._values()
        return _estimate(values[-2] / values[-1])

    def _values(self) -> Means:
        return self._blocks.values()

    @property
    def _plane_x(self) -> Array:
        return np.asarray(np.arange(self.bins) * (self.size[0] / self.bins))


def _stacked(parts: Sequence[Sequence[Means]], bins: int, d: int) -> Means:
    """From means of the shape (bins, 1) for each pair of axes, (bins, d, d)."""
    flat = [part for row in parts for part in row]
    value = np.concatenate([part.value for part in flat], axis=1)
    deviation = np.concatenate([part.deviation for part in flat], axis=2)
    return Means(value, deviation).reshaped(bins, d, d)


def _estimate(means: Means) -> Estimate:
    """A single mean as an estimate, from its blocks."""
    rows = np.asarray(means.deviation + means.value).ravel()
    if len(rows) == 0 or not np.isfinite(rows).all():
        return Estimate(float("nan"), float("nan"), len(rows), float("nan"), converged=False)
    return estimate(rows)
