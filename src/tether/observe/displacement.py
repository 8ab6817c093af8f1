"""Displacement: how particles and bodies wander about the flow, and their diffusion coefficients.

What wanders is the peculiar displacement, the integral of the peculiar velocity along a particle's own path,

    xi(t) = integral of (v - u(y(t')) e_x) dt',    u(y) = rate (y - L_y/2) the imposed profile

which no crossing of a boundary changes. Neither the affine motion is in it nor what the flow makes of a displacement
across it (the integral of rate * (y(t') - y(0)), whose mean square grows as t^3): each axis diffuses as it does at
rest. From two sightings in the box, `peculiar_displacement` finds it to the error stated there.

    mean-square displacement    msd = <|xi(t + lag) - xi(t)|^2>                             length^2
    velocity autocorrelation    vacf = <c(t + lag) . c(t)>,  c = v - u(y) e_x               length^2/time^2
    running diffusion           D(lag) = <c(t) . (xi(t) - xi(t - lag))> / d                 length^2/time

averaged over particles and time. D(lag) is half the slope of msd/d at this lag and the integral of vacf/d from 0 to the
lag, exactly, at rest or in steady flow: it is how the Green-Kubo integral is measured here, free of a quadrature's
error. The diffusion coefficient (the paper's eq. 41, msd -> 2 d D lag) comes by two routes over the same lags,

    diffusion            slope of the least-squares line through msd / (2 d)
    diffusion_velocity   mean of D(lag)

and the lags are those of one level of the correlator, from T to nearly 2 T: the shortest ones with T at least
20 times D/<c^2 per axis>, the time in which the velocity is forgotten, and at least `least_lag`, and whose slope agrees
with those of all longer ones within 1.5 of their combined standard errors (O. V. Lepskii's rule, Theory Probab. Appl.
35, 454 (1991), doi 10.1137/1135065): the velocity's long tail, which the hydrodynamics of the fluid makes, bends msd
long after 20 such times. D belongs to a box only once momentum has gone around it and a particle has felt its images:
least_lag should be twice the time L^2/(4 pi^2 nu) that momentum takes along the longest side. Lags that end beyond a
tenth of the run are not taken, nor those whose slope has no error, which needs about 40 of them in the run. In a run
too short for all that the longest lags from 5 times on are taken: the attributes lag_from, lag_to and velocity_times
(T in such times) tell, and D may then be a few per cent off that its error does not know of.
All is for this box: its images lower D in 3D, and in 2D D grows with the box without end.

Rotational diffusion of bodies, in 2D from the angle, its mean drift (the spin of sheared bodies) taken off:

    <(angle(t + lag) - angle(t))^2> - <angle(t + lag) - angle(t)>^2 -> 2 D_r lag

and in 3D, at rest only, from the axes e_k of the body:   <e_k(t + lag) . e_k(t)> -> exp(-2 D_r lag),
the mean over the three axes, as for a body that turns as easily about each of them; lags with a mean under 0.1 are not
fitted. Under shear axes turn with the flow in 3D, and no mean to take off is the same for all. Lags are chosen by the
same rule.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether.observe.blocks import Array, Means, fitted_slope, over
from tether.observe.correlator import POINTS, Correlator, MultipleTau, mean_products, slices_of
from tether.observe.moment import Moment
from tether.observe.observer import State, part, under

Levels = list[tuple[NDArray[np.int64], Means]]
Found = tuple[Array, Array]
"""Values and their standard errors."""
Variable = tuple[tuple[str, ...], Array, dict[str, str | float]]

VELOCITY_LEVELS = 4
"""Of the velocity's correlator: lags up to 8 * 15 samples. Its integral is measured at all lags, by D(lag)."""

_VELOCITY_TIMES = 20.0  # before a slope is fitted
_LEAST_VELOCITY_TIMES = 5.0  # the same in short runs
_SHARE_OF_RUN = 0.1  # that the longest fitted lag may have
_AGREEMENT = 1.5  # standard errors; where chance exceeds them, longer lags than needed are taken
_LEAST_CORRELATION = 0.1  # of orientations, to be fitted


def peculiar_displacement(
    before: Array, after: Array, *, size: tuple[float, ...], offset: float, strain: float
) -> Array:
    """What particles moved against the imposed flow between two sightings in the box; shape (d, n), length.

    before, after: positions in the box, (d, n). offset: of the image above, at the later time. strain: integral of the
    shear rate in between. A particle that left through the top r times more than through the bottom is now, on its
    continuous path, at y' = y + r L_y and x + r offset. The affine part of its path is strain * ((y_before + y')/2 -
    L_y/2), by the trapezoid rule, and what x moved beyond it is taken as that of the nearest image.

    Each peculiar displacement must be less than half of each side. The trapezoid rule errs by random numbers of mean
    square rate^2 D_yy h^3 / 6 for an interval h, independent of each other and of xi, because y wanders in between:
    D_xx comes out high by a relative (rate h)^2 / 12 (D_yy / D_xx).
    """
    moved = after - before
    for axis in range(1, len(size)):
        periods = np.rint(moved[axis] / size[axis])
        moved[axis] -= periods * size[axis]
        if axis == 1:
            moved[0] -= periods * offset
    middle = before[1] + 0.5 * moved[1]
    moved[0] -= strain * (middle - 0.5 * size[1])
    moved[0] -= size[0] * np.rint(moved[0] / size[0])
    return moved


class Displacement:
    """Wandering of up to `solvent_sample` solvent particles, of evenly spread ids, and of all bodies.

    solvent: number of solvent particles. bodies: number of bodies of each [[bodies]] table, in their order, by a name
    for it. driven: in a flow that a force drives nothing takes its velocity off, and x is left out of the total and of
    diffusion; msd_axes has it.
    """

    def __init__(
        self,
        interval: int,
        dimension: int,
        solvent: int,
        bodies: Mapping[str, int] | None = None,
        *,
        solvent_sample: int = 2000,
        driven: bool = False,
        least_lag: float = 0.0,
        points: int = POINTS,
    ) -> None:
        self.interval = interval
        self._least_lag = least_lag
        self._d = dimension
        self._bodies = {name: count for name, count in (bodies or {}).items() if count > 0}
        tracked = min(solvent_sample, solvent)
        self._solvent = np.arange(tracked) * solvent // max(tracked, 1)
        self._groups = {**({"solvent": tracked} if tracked else {}), **self._bodies}
        self._slices = slices_of(list(self._groups.values()))
        self._axes = list(range(1 if driven else 0, dimension))
        self._points = points
        count = sum(self._groups.values())
        self._wander = MultipleTau(
            (dimension, count), self._wandered, (len(self._groups), 2 * dimension), points=points
        )
        self._velocity = Correlator(
            dimension, list(self._groups.values()), average=False, levels=VELOCITY_LEVELS, points=points
        )
        self._turns = slices_of(list(self._bodies.values()))
        self._angles = MultipleTau((1, sum(self._bodies.values())), self._turned, (len(self._bodies), 2), points=points)
        self._frames = Correlator(9, list(self._bodies.values()), average=False, points=points)
        self._last: _Sighting | None = None
        self._path = np.zeros((dimension, count))
        self._angle = np.zeros(sum(self._bodies.values()))
        self._time = np.zeros(2)  # of the first sample and the last
        self._sheared = False

    def sample(self, moment: Moment) -> None:
        """Take in the suspension at a step, `interval` steps after the sample before."""
        position = np.ascontiguousarray(np.concatenate([moment.position[self._solvent], moment.center]).T)
        velocity = np.concatenate([moment.velocity[self._solvent], moment.center_velocity]).T.copy()
        velocity[0] -= moment.shear_rate * (position[1] - 0.5 * moment.size[1])
        now = _Sighting(moment.step, moment.strain, position, moment.rotation.copy())
        if self._last is None:
            self._time[0] = moment.time
        else:
            self._move(self._last, now, moment)
        self._time[1] = moment.time
        self._sheared |= moment.shear_rate != 0.0
        self._wander.add(self._path, velocity)
        self._velocity.add(velocity)
        if self._bodies and self._d == 2:
            self._angles.add(self._angle[None])
        elif self._bodies and not self._sheared:
            self._frames.add(moment.rotation.transpose(2, 1, 0).reshape(9, -1))  # axis by axis
        self._last = now

    def state(self) -> State:
        """All that is needed to go on bit for bit."""
        state = {
            "time": self._time.copy(),
            "sheared": np.array(self._sheared),
            "path": self._path.copy(),
            "angle": self._angle.copy(),
            **under("wander", self._wander.state()),
            **under("velocity", self._velocity.state()),
            **under("angles", self._angles.state()),
            **under("frames", self._frames.state()),
        }
        return state if self._last is None else state | under("last", self._last.state())

    def restore(self, state: State) -> None:
        """Go on from the state of one that was made with the same arguments."""
        if state["path"].shape != self._path.shape or state["angle"].shape != self._angle.shape:
            raise ValueError(
                f"the saved paths have the shape {state['path'].shape} (those here have {self._path.shape});"
                " track as many particles and bodies as before"
            )
        self._time[:] = state["time"]
        self._sheared = bool(state["sheared"])
        self._path[:] = state["path"]
        self._angle[:] = state["angle"]
        self._wander.restore(part("wander", state))
        self._velocity.restore(part("velocity", state))
        self._angles.restore(part("angles", state))
        self._frames.restore(part("frames", state))
        last = part("last", state)
        self._last = _Sighting.of(last) if last else None

    def dataset(self) -> xr.Dataset | None:
        """Mean squares over lag, diffusion coefficients, each with its standard error; None before there are lags."""
        if not self._wander.levels():
            return None
        made = _Variables(self._d, self._period)
        for index, name in enumerate(self._groups):
            self._add_wandering(made, index, name)
        for index, name in enumerate(self._bodies):
            add_rotation = self._add_angle if self._d == 2 else self._add_axes
            add_rotation(made, index, name)
        return made.dataset(samples=self._wander.samples)

    @property
    def _period(self) -> float:
        """Time between samples."""
        return float(self._time[1] - self._time[0]) / max(1, self._wander.samples - 1)

    def _move(self, last: _Sighting, now: _Sighting, moment: Moment) -> None:
        if now.step - last.step != self.interval:
            raise ValueError(
                f"samples of the displacement were taken at steps {last.step} and {now.step} (its lags count intervals"
                f" of {self.interval} steps); take one at every interval"
            )
        strain = now.strain - last.strain
        self._sheared |= strain != 0.0
        self._path += peculiar_displacement(
            last.position, now.position, size=moment.size, offset=moment.offset, strain=strain
        )
        if self._d == 2:
            (a, b), (c, d) = last.rotation[:, :, 0].T, now.rotation[:, :, 0].T
            self._angle += np.arctan2(a * d - b * c, a * c + b * d)  # less than half a turn

    def _wandered(self, then: Array, now: Array, velocity: Array) -> Array:
        """xi^2 and c xi along each axis: (lags, groups, 2 d)."""
        moved = now - then
        squares = mean_products(moved, moved, self._slices)
        return np.concatenate([squares, mean_products(moved, velocity, self._slices)], axis=2)

    def _turned(self, then: Array, now: Array) -> Array:
        """Change of the angle and its square: (lags, kinds, 2)."""
        moved = now - then
        means = [
            np.stack([moved[:, 0, kind].mean(axis=1), (moved[:, 0, kind] ** 2).mean(axis=1)]) for kind in self._turns
        ]
        return np.stack(means).transpose(2, 0, 1)

    def _add_wandering(self, made: _Variables, index: int, name: str) -> None:
        d, axes = self._d, self._axes
        made.add_lags("lag", self._wander.levels())
        levels = [means[:, index] for _, means in self._wander.levels()]
        made.add(f"msd_{name}", ("lag",), over(levels, lambda m: m[:, axes].sum(axis=-1)))
        made.add(f"msd_axes_{name}", ("lag", "axis"), over(levels, lambda m: m[:, :d]))
        made.add(f"diffusion_running_{name}", ("lag",), over(levels, self._running))
        made.add_lags("velocity_lag", self._velocity.levels())
        levels = [means[:, index] for _, means in self._velocity.levels()]
        made.add(f"vacf_{name}", ("velocity_lag",), over(levels, lambda m: m[:, axes].sum(axis=-1)))
        made.add(f"vacf_axes_{name}", ("velocity_lag", "axis"), over(levels, lambda m: m))
        fit = self._fit(self._wander.levels(), index, index, self._mean_square, self._least_lag)
        made.add_fit(f"diffusion_{name}", (), fit, lambda fit: fit.slope(self._mean_square))
        known = np.where(np.isin(np.arange(d), axes), 0.5, np.nan)
        made.add_fit(f"diffusion_axes_{name}", ("axis",), fit, lambda fit: fit.slope(lambda m: known * m[:, :d]))
        made.add_fit(f"diffusion_velocity_{name}", (), fit, lambda fit: fit.mean(self._running))

    def _add_angle(self, made: _Variables, index: int, name: str) -> None:
        levels = [means[:, index] for _, means in self._angles.levels()]
        made.add(f"msd_angle_{name}", ("lag",), over(levels, lambda m: 2.0 * _half_variance(m)))
        fit = self._fit(self._angles.levels(), index, self._group(name), _half_variance)
        made.add_fit(f"diffusion_rotational_{name}", (), fit, lambda fit: fit.slope(_half_variance))
        made.add_fit(f"spin_{name}", (), fit, lambda fit: fit.slope(lambda m: m[:, 0]))

    def _add_axes(self, made: _Variables, index: int, name: str) -> None:
        if self._sheared:
            made.omitted[f"diffusion_rotational_{name}"] = "axes turn with the flow, and no mean spin is common to them"
            return
        levels = [means[:, index] for _, means in self._frames.levels()]
        made.add(f"orientation_{name}", ("lag",), over(levels, _mean_of_axes))
        made.add(f"orientation_axes_{name}", ("lag", "body_axis"), over(levels, _each_axis))
        fit = self._fit(self._frames.levels(), index, self._group(name), _decay)
        made.add_fit(f"diffusion_rotational_{name}", (), fit, lambda fit: fit.slope(_decay))

    def _group(self, body: str) -> int:
        return list(self._groups).index(body)

    def _mean_square(self, means: Means) -> Means:
        """msd / (2 d): its slope is the diffusion coefficient."""
        return (0.5 / len(self._axes)) * means[:, self._axes].sum(axis=-1)

    def _running(self, means: Means) -> Means:
        """D(lag)."""
        return (1.0 / len(self._axes)) * means[:, [self._d + axis for axis in self._axes]].sum(axis=-1)

    def _fit(
        self, levels: Levels, index: int, group: int, rising: Callable[[Means], Means], least_lag: float = 0.0
    ) -> _Fit | None:
        """The lags where `rising` has become a line whose slope is a diffusion coefficient; see the module.

        levels: of the quantity; index: its row in them. group: whose velocity tells how fast it is forgotten.
        """
        run = float(self._time[1] - self._time[0])
        (_, velocities), *_ = self._velocity.levels()
        square = velocities.value[0, group, self._axes].mean()
        fits = []
        for (lags, means), (_, wandered) in zip(levels, self._wander.levels(), strict=False):
            kept = slice(len(lags) - self._points // 2, None)
            times = np.asarray(lags[kept] * self._period)
            forgotten = abs(self._running(wandered[kept, group]).value.mean()) / square
            velocity_times = times[0] / forgotten if forgotten > 0.0 else np.inf
            is_enough = bool(velocity_times >= _VELOCITY_TIMES and times[0] >= least_lag)
            fit = _Fit(times, means[kept, index], velocity_times, is_enough)
            slope, error = fit.slope(rising)
            if (
                np.isfinite(slope + error)
                and fit.velocity_times >= _LEAST_VELOCITY_TIMES
                and times[-1] <= _SHARE_OF_RUN * run
            ):
                fits.append((fit, slope, error))
        return _chosen(fits)


@dataclass(frozen=True, eq=False)
class _Sighting:
    """Where everything tracked was at a step."""

    step: int
    strain: float
    position: Array
    rotation: Array

    def state(self) -> State:
        return {
            "step": np.array(self.step),
            "strain": np.array(self.strain),
            "position": self.position,
            "rotation": self.rotation,
        }

    @classmethod
    def of(cls, state: State) -> _Sighting:
        position, rotation = (np.array(state[name], dtype=np.float64) for name in ("position", "rotation"))
        return cls(int(state["step"]), float(state["strain"]), position, rotation)


@dataclass(frozen=True, eq=False)
class _Fit:
    """Means at the lags (in time) of one level: one row of samples, so that sums over lags have honest errors."""

    lags: Array
    means: Means
    velocity_times: float
    """The first lag in times in which the velocity is forgotten."""
    is_enough: bool
    """Whether it is long enough for what was asked."""

    def slope(self, function: Callable[[Means], Means]) -> Found:
        """Slope over lag of the least-squares line through function(means)."""
        return _found(function(self.means).weighted(fitted_slope(self.lags)))

    def mean(self, function: Callable[[Means], Means]) -> Found:
        """Mean over the lags of function(means)."""
        return _found(function(self.means).weighted(np.full(len(self.lags), 1.0 / len(self.lags))))


class _Variables:
    """The variables of the dataset as they are made."""

    def __init__(self, d: int, period: float) -> None:
        self._d = d
        self._period = period
        self._made: dict[str, Variable] = {}
        self._coordinates: dict[str, Variable] = {}
        self.omitted: dict[str, str] = {}

    def add_lags(self, name: str, levels: Levels) -> None:
        lags = np.concatenate([lags for lags, _ in levels]) * self._period
        self._coordinates[name] = ((name,), lags, {"units": "time", "long_name": "lag"})

    def add(self, name: str, dims: tuple[str, ...], found: Found, **attributes: str | float) -> None:
        units, long_name = _meaning(name, self._d)
        self._made[name] = (dims, found[0], {"units": units, "long_name": long_name, **attributes})
        self._made[f"{name}_error"] = (dims, found[1], {"units": units, "long_name": f"standard error of {long_name}"})

    def add_fit(self, name: str, dims: tuple[str, ...], fit: _Fit | None, of: Callable[[_Fit], Found]) -> None:
        """What comes from a fit, with the lags that it was made over; nan where there was no fit."""
        if fit is None:
            none = np.full((self._d,) * len(dims), np.nan)
            why = "the run is too short for lags that the rule of tether.observe.displacement takes"
            self.add(name, dims, (none, none), no_value=why)
        else:
            begin, end, times = float(fit.lags[0]), float(fit.lags[-1]), float(fit.velocity_times)
            self.add(name, dims, of(fit), lag_from=begin, lag_to=end, velocity_times=times)

    def dataset(self, samples: int) -> xr.Dataset:
        axes = {"axis": list("xyz"[: self._d])}
        if any("body_axis" in dims for dims, _, _ in self._made.values()):
            axes["body_axis"] = list("xyz")
        title = "tether: displacement about the imposed flow, velocity autocorrelation, diffusion"
        omitted = {f"no_{name}": why for name, why in self.omitted.items()}
        return xr.Dataset(
            self._made, coords={**self._coordinates, **axes}, attrs={"title": title, "samples": samples, **omitted}
        )


def _chosen(fits: list[tuple[_Fit, Array, Array]]) -> _Fit | None:
    """Of fits, slopes and errors, from the shortest lags to the longest: the first that the longer ones agree with."""
    enough = [found for found in fits if found[0].is_enough] or fits[-1:]
    for number, (fit, slope, error) in enumerate(enough):
        longer = enough[number + 1 :]
        if all(abs(slope - other) <= _AGREEMENT * np.hypot(error, its_error) for _, other, its_error in longer):
            return fit
    return None


def _half_variance(means: Means) -> Means:
    """Half the variance of the angle's change; means: (lags, 2), the change and its square."""
    return 0.5 * (means[:, 1] - means[:, 0] * means[:, 0])


def _each_axis(means: Means) -> Means:
    """<e_k(t + lag) . e_k(t)>, (lags, 3), from (lags, 9), axis by axis."""
    return means.reshaped(len(means.value), 3, 3).sum(axis=-1)


def _mean_of_axes(means: Means) -> Means:
    return (1.0 / 3.0) * means.sum(axis=-1)


def _decay(means: Means) -> Means:
    """-log(mean over axes)/2: its slope is the rotational diffusion coefficient. Not a number below the least."""
    mean = _mean_of_axes(means)
    return -0.5 * Means(np.where(mean.value >= _LEAST_CORRELATION, mean.value, np.nan), mean.deviation).log()


def _found(means: Means) -> Found:
    return means.value, means.error()


def _meaning(name: str, d: int) -> tuple[str, str]:
    """Unit and description; the longest beginning of the name that is known tells."""
    meanings = {
        "msd": ("length^2", "mean-square displacement about the imposed flow"),
        "msd_axes": ("length^2", "mean-square displacement about the imposed flow along each axis"),
        "msd_angle": ("1", "mean-square angle about its mean drift"),
        "vacf": ("length^2/time^2", "velocity autocorrelation about the imposed flow"),
        "vacf_axes": ("length^2/time^2", "velocity autocorrelation about the imposed flow along each axis"),
        "orientation": ("1", "autocorrelation of the body's axes"),
        "orientation_axes": ("1", "autocorrelation of each of the body's axes"),
        "spin": ("1/time", "mean spin about z"),
        "diffusion": ("length^2/time", f"diffusion coefficient from the slope of msd/{2 * d}"),
        "diffusion_axes": ("length^2/time", "diffusion coefficient along each axis from the slope of msd/2"),
        "diffusion_velocity": ("length^2/time", "diffusion coefficient from the integral of vacf"),
        "diffusion_running": ("length^2/time", "integral of vacf up to the lag, a running diffusion coefficient"),
        "diffusion_rotational": ("1/time", "rotational diffusion coefficient"),
    }
    known = max((key for key in meanings if name.startswith(f"{key}_")), key=len)
    units, what = meanings[known]
    return units, f"{what}, {name.removeprefix(known).strip('_').replace('_', ' ')}"
