"""Profiles across the gradient: density, velocity, kinetic temperature and particle fraction in bins of y.

In each bin the sums over the particles of a sample of 1, m, m c and m c_k^2 are averaged over time, c = v - u(y) e_x
being the velocity against the imposed profile u(y) = rate (y - L_y/2) at the particle's own place. With <> for these
averages, over the bin of volume V_b:

    number density      n = <sum 1> / V_b                                                   1/length^d
    velocity            u_x = <sum m c_x> / <sum m> + <rate> (y - L_y/2)                    length/time
    temperature         kT = (<sum m c^2> - |<sum m c>|^2 / <sum m>) / (d (<sum f> - <sum m>/M))    energy
    particle fraction   <constituents> / (<constituents> + <solvent>)                       a pure number

The velocity is that of the paper's eq. 19-20, momentum over mass, with y the middle of the bin; the last is its eq. 42
in the bin. The temperature is about the measured velocity of the bin, averaged over the whole run: an instantaneous
one would take out a degree of freedom for every bin. f is 1, or the part of d degrees of freedom that a constituent of
a rigid body has. M is the mass of all particles, whose momentum does not fluctuate
(<m c^2> = d kT (1 - m/M) for one of them). Where the measured velocity bends away from the imposed one by a slope g
within a bin of width w, as it does in force-driven flow, kT comes out high by m (g w)^2 / (12 d). That of constituents
includes the mean rotation of their bodies.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr

from tether.observe.blocks import Array, Blocks, Means
from tether.observe.moment import Moment
from tether.observe.observer import State


class Profiles:
    """Averages in `bins` equal bins across y; kinds: the names of the [[bodies]] tables, in their order.

    driven: a force on every particle drives the flow; its density is then a profile too. freedom: degrees of freedom of
    each particle over d, (n,): less than 1 for constituents of rigid bodies, which share those of their body; 1 of all
    if not given.
    """

    def __init__(
        self,
        bins: int,
        interval: int,
        size: Sequence[float],
        kinds: Sequence[str] = (),
        *,
        driven: bool = False,
        freedom: Array | None = None,
    ) -> None:
        self.bins = bins
        self.interval = interval
        self.size = tuple(size)
        self.kinds = tuple(kinds)
        self._d = len(self.size)
        self._mass = 0.0  # of all particles; known from the first sample on
        self._freedom = freedom
        self._sums = 3 + 2 * self._d  # for solvent and constituents each: 1, m, m c, m c_k^2, freedom
        self._driven = driven
        self._blocks = Blocks((2 * self._sums + len(self.kinds) + driven) * bins + 1)

    @property
    def samples(self) -> int:
        """Number of samples so far."""
        return self._blocks.samples

    @property
    def y(self) -> Array:
        """Middles of the bins, shape (bins,)."""
        return np.asarray((np.arange(self.bins) + 0.5) * (self.size[1] / self.bins))

    def sample(self, moment: Moment) -> None:
        """Take in the suspension at a step."""
        self._mass = float(moment.mass.sum())
        rate = np.array([moment.shear_rate])
        parts = [self._of_particles(moment), self._of_bodies(moment)]
        if self._driven:
            parts.append(self._of_force(moment))
        self._blocks.add(np.concatenate([*parts, rate]))

    def state(self) -> State:
        """All that is needed to go on bit for bit."""
        return {"mass": np.array(self._mass), **self._blocks.state()}

    def restore(self, state: State) -> None:
        """Go on from the state of profiles in as many bins, of as many kinds of bodies."""
        self._mass = float(state["mass"])
        self._blocks.restore(state)

    def dataset(self) -> xr.Dataset | None:
        """Profiles over y (temperature_axes: over y and axis), each with its standard error; None before a sample."""
        if self._blocks.samples == 0:
            return None
        variables = {}
        for name, means in self._means().items():
            units, long_name = _meaning(name, self._d)
            dims = ("y", "axis")[: means.value.ndim]
            variables[name] = (dims, means.value, {"units": units, "long_name": long_name})
            of_error = {"units": units, "long_name": f"standard error of {long_name}"}
            variables[f"{name}_error"] = (dims, means.error(), of_error)
        middle = {"units": "length", "long_name": "height of the middle of the bin"}
        return xr.Dataset(
            variables,
            coords={"y": ("y", self.y, middle), "axis": list("xyz"[: self._d])},
            attrs={"title": "tether: profiles across the gradient", "samples": self._blocks.samples},
        )

    def flow_energy(self) -> dict[str, float]:
        """Twice the kinetic energy of the mean flow against the imposed one, sum over bins of <sum m c_x>^2 / <sum m>,
        of all particles ("all"), the solvent and the constituents.

        The square of a mean that is known to an error e is e^2 too large, which is taken off.
        """
        if self._blocks.samples == 0:
            return {}
        groups = self._blocks.values()[: 2 * self._sums * self.bins].reshaped(2, self._sums, self.bins)
        found = {}
        for name, sums in {"all": groups.sum(axis=-3), "solvent": groups[0], "constituents": groups[1]}.items():
            mass, momentum = sums[1].value, sums[2]
            square = momentum.value**2 - np.nan_to_num(momentum.error()) ** 2
            found[name] = float(np.divide(square, mass, out=np.zeros(self.bins), where=mass > 0).sum())
        return found

    def rows(self, name: str) -> Array:
        """A profile in each block of time, linearized about its mean, (blocks, bins)."""
        means = self._means()[name]
        return np.asarray(means.value + means.deviation)

    def covariance(self, name: str) -> tuple[Array, int]:
        """Covariance of a profile between its bins, (bins, bins), and the blocks behind it; see `Means.covariance`.

        Momentum is conserved and particles are, so bins are correlated: a chi-square from their errors alone is wrong.
        """
        return self._means()[name].covariance()

    def _of_particles(self, moment: Moment) -> Array:
        """Sums over solvent and over constituents: (2, sums, bins), flat."""
        peculiar = moment.velocity.T.copy()
        peculiar[0] -= moment.shear_rate * (moment.position[:, 1] - 0.5 * self.size[1])
        place = self._bin(moment.position[:, 1])
        place[moment.solvent :] += self.bins
        momentum = moment.mass * peculiar
        weights = [None, moment.mass, *momentum, *(momentum * peculiar), self._freedom]
        sums = [np.bincount(place, weight, minlength=2 * self.bins) for weight in weights]
        return np.array(sums, dtype=np.float64).reshape(self._sums, 2, self.bins).swapaxes(0, 1).ravel()

    def _of_bodies(self, moment: Moment) -> Array:
        """Number of centers of each kind: (kinds, bins), flat."""
        place = moment.kind * self.bins + self._bin(moment.center[:, 1])
        return np.bincount(place, minlength=len(self.kinds) * self.bins).astype(np.float64)

    def _of_force(self, moment: Moment) -> Array:
        """Sum of the driving force: (bins,)."""
        assert moment.driving_force is not None
        place = self._bin(moment.position[:, 1])
        return np.bincount(place, moment.driving_force, minlength=self.bins).astype(np.float64)

    def _bin(self, y: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.intp]]:
        found = (y * (self.bins / self.size[1])).astype(np.intp)
        return np.clip(found, 0, self.bins - 1, out=found)  # y/L_y may round to 1

    def _means(self) -> dict[str, Means]:
        """Every profile by name."""
        values = self._blocks.values()
        split = 2 * self._sums * self.bins
        groups = values[:split].reshaped(2, self._sums, self.bins)
        end = split + len(self.kinds) * self.bins
        bodies = values[split:end].reshaped(len(self.kinds), self.bins)
        imposed = values[np.full(self.bins, -1)]  # the rate, once for every bin
        solvent, constituents = groups[0], groups[1]
        every = solvent + constituents
        by_name = {"": every, "_solvent": solvent, "_constituents": constituents}
        if not self.kinds:
            by_name = {"": every}
        per_volume = self.bins / math.prod(self.size)
        found = {f"density{of}": per_volume * sums[0] for of, sums in by_name.items()}
        if self.kinds:
            found["density_bodies"] = per_volume * bodies.sum(axis=-2)
            found |= {f"density_bodies_{kind}": per_volume * bodies[k] for k, kind in enumerate(self.kinds)}
            found["particle_fraction"] = constituents[0] / every[0]
        if self._driven:
            found["driving_force_density"] = per_volume * values[end:-1]
        height = _constant(self.y - 0.5 * self.size[1], imposed)
        found |= {f"velocity{of}": sums[2] / sums[1] + imposed * height for of, sums in by_name.items()}
        found |= {f"temperature{of}": self._temperature(sums) for of, sums in by_name.items()}
        axes = [self._temperature(every, axis) for axis in range(self._d)]
        stacked = Means(np.stack([each.value for each in axes], -1), np.stack([each.deviation for each in axes], -1))
        found["temperature_axes"] = stacked
        return found

    def _temperature(self, sums: Means, axis: int | None = None) -> Means:
        """From sums of the shape (sums, bins); of one axis, or the mean over all."""
        axes = range(self._d) if axis is None else (axis,)
        mass, freedom = sums[1], len(axes) * (sums[-1] - (1.0 / self._mass) * sums[1])
        energy = [sums[2 + self._d + k] - sums[2 + k] * sums[2 + k] / mass for k in axes]
        total = energy[0]
        for more in energy[1:]:
            total = total + more
        return total / freedom


def _constant(value: Array, like: Means) -> Means:
    return Means(value, np.zeros_like(like.deviation))


def _meaning(name: str, d: int) -> tuple[str, str]:
    """Unit and description of a profile."""
    quantity, _, of = name.partition("_")
    if name == "particle_fraction":
        return "1", "constituents over constituents and solvent"
    if name == "driving_force_density":
        return f"force/length^{d}", "density of the driving force along x, its mean over all particles taken off"
    if name == "temperature_axes":
        return "energy", "kinetic temperature of all particles along each axis"
    whose = f"centers of {of}" if of.startswith("bodies") else of or "all particles"
    units, what = {
        "density": (f"1/length^{d}", "number density"),
        "velocity": ("length/time", "velocity along x"),
        "temperature": ("energy", "kinetic temperature about the measured velocity"),
    }[quantity]
    return units, f"{what} of {whose.replace('_', ' ')}"
