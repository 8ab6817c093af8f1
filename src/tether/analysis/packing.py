"""Fits of the viscosity of suspensions against their volume fraction phi: maximum packing, intrinsic viscosity.

What is fitted is the viscosity itself, eta(phi) = eta_0 f(phi), with eta_0 as one more parameter and the plain fluid's
viscosity as one more point, at phi = 0. Relative viscosities all have the error of the one plain fluid that they were
divided by; a fit to them that takes their errors to be independent counts on this error to average out, and gives
parameters errors that are too small. The laws f, from `tether.theory.suspension` (sources there):

    krieger_dougherty       (1 - phi/phi_m)^(-[eta] phi_m), phi_m free, [eta] = (d + 2)/2
    krieger_dougherty_free  the same, phi_m and [eta] free
    quemada                 (1 - phi/phi_m)^(-2), phi_m free
    einstein                1 + [eta] phi, [eta] free, for points with phi <= DILUTE
    second_order            1 + [eta] phi + k phi^2, [eta] and k free, for points with phi <= DILUTE

A straight line through points up to phi is about k phi too steep, 0.6 at phi = 0.1 with the k of about 6 that spheres
have; second_order takes that out, at the price of a larger error.

Least squares weighted by the errors, which are taken as known. Laws with a maximum packing are fitted by 1/phi_m, in
which they are nearly linear (for Krieger and Dougherty's, 1 + [eta] phi + [eta] ([eta] + 1/phi_m) phi^2 / 2 + ...);
phi_m = 1/x has the error dx/x^2. phi_m may come out above 1, which no packing has: phi is what the bodies count for.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import chdtrc

from tether.estimate import Estimate
from tether.theory import suspension

DILUTE = 0.1
"""Greatest volume fraction of the points that einstein and second_order are fitted to, give or take _WHOLE_BODIES."""

SIGNIFICANCE = 0.001
"""Of the chi-square test: a law that fits worse than this by chance is said not to describe the points."""

_LEAST_SHARE = 1.0 / 3.0  # error of 1/phi_m over itself: above, the error of phi_m is no longer symmetric, or bounded
_WHOLE_BODIES = 1.02  # bodies come in whole numbers: who asks for phi = 0.1 gets a little more or less
_ROOM = 1e-6  # phi_m stays above the greatest phi by this fraction, where the laws are finite

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Fit:
    """A law, its parameters, and how well it describes the points."""

    law: str
    """A name of LAWS."""
    dimension: int
    parameters: Mapping[str, Estimate]
    """Those that were free: viscosity_at_zero (eta_0, DPD units), and, without units, maximum_packing (phi_m),
    intrinsic_viscosity ([eta]), second_order (k), as far as the law has them."""
    chi_square: float
    """Sum of squared deviations in standard errors."""
    degrees_of_freedom: int
    """Points less parameters; at 0 the law goes through all points and nothing can be said of it."""
    points: int
    """Number of points that were fitted."""

    @property
    def p_value(self) -> float:
        """Chance that a true law deviates as much as this one; nan without degrees of freedom."""
        return float(chdtrc(self.degrees_of_freedom, self.chi_square)) if self.degrees_of_freedom > 0 else math.nan

    @property
    def is_contradicted(self) -> bool:
        """Whether the points deviate from the law beyond their errors; those of the parameters then mean nothing."""
        return self.p_value < SIGNIFICANCE

    def relative_viscosity(self, phi: ArrayLike) -> Array:
        """f(phi) with the fitted parameters, in the shape of phi; infinite from phi_m on.

        Raises ValueError unless 0 <= phi <= 1.
        """
        law = LAWS[self.law]
        shape = [self.parameters[name].value for name in law.parameters]
        if law.has_packing:
            shape[0] = 1.0 / shape[0]
        return law.formula(np.asarray(phi, dtype=np.float64), self.dimension, *shape)


@dataclass(frozen=True)
class NoFit:
    """A law that could not be fitted, and why."""

    law: str
    """A name of LAWS."""
    reason: str
    """In words, without a full stop."""
    points: int
    """Number of points that there were."""


@dataclass(frozen=True)
class Law:
    """A relative viscosity as a function of the volume fraction, and what of it is fitted."""

    words: str
    """Its name for people."""
    parameters: tuple[str, ...]
    """Free ones beside eta_0; maximum_packing, if any, first."""
    formula: Callable[..., Array]
    """f(phi, dimension, *parameters), with 1/phi_m in the place of phi_m."""
    distinct: int
    """Least number of different volume fractions."""
    limit: float = 1.0
    """Greatest volume fraction of the points that are fitted."""

    @property
    def has_packing(self) -> bool:
        """Whether it ends at a maximum packing."""
        return self.parameters[0] == "maximum_packing"


def _krieger_dougherty(phi: Array, dimension: int, inverse: float) -> Array:
    return suspension.krieger_dougherty(phi, dimension, 1.0 / inverse)


def _krieger_dougherty_free(phi: Array, dimension: int, inverse: float, slope: float) -> Array:
    """The exponent is proportional to [eta]."""
    fixed = suspension.krieger_dougherty(phi, dimension, 1.0 / inverse)
    free: Array = fixed ** (slope / suspension.intrinsic_viscosity(dimension))
    return free


def _quemada(phi: Array, _dimension: int, inverse: float) -> Array:
    return suspension.quemada(phi, 1.0 / inverse)


def _dilute(phi: Array, _dimension: int, slope: float, second: float = 0.0) -> Array:
    return 1.0 + slope * phi + second * phi**2


LAWS = {
    "krieger_dougherty": Law("Krieger-Dougherty", ("maximum_packing",), _krieger_dougherty, 2),
    "krieger_dougherty_free": Law(
        "Krieger-Dougherty, [\N{GREEK SMALL LETTER ETA}] free",
        ("maximum_packing", "intrinsic_viscosity"),
        _krieger_dougherty_free,
        3,
    ),
    "quemada": Law("Quemada", ("maximum_packing",), _quemada, 2),
    "einstein": Law("first order", ("intrinsic_viscosity",), _dilute, 2, DILUTE),
    # One more than it has parameters: a parabola through three points of noise has any curvature.
    "second_order": Law("second order", ("intrinsic_viscosity", "second_order"), _dilute, 4, DILUTE),
}
"""The laws by name."""


def fit(law: str, phi: ArrayLike, viscosity: ArrayLike, error: ArrayLike, dimension: int) -> Fit | NoFit:
    """eta_0 f(phi) fitted to viscosities, the plain fluid's among them.

    law: a name of LAWS. phi, viscosity, error: shape (n,); the plain fluid has phi = 0, and need not be there.
    viscosity and its standard error, which must be independent of the other points', in DPD units (the fit needs but
    that they be the same). A point without a positive, finite error has no weight and is left out, and so is one
    whose viscosity or phi is no number or whose phi is not in [0, 1). dimension: 2 or 3, for [eta].

    NoFit where there are too few different volume fractions, or where the points leave 1/phi_m uncertain by more than
    a third of itself, so that phi_m is anything. Raises ValueError for arrays of different shapes.
    """
    place, mean, deviation = (np.asarray(each, dtype=np.float64) for each in (phi, viscosity, error))
    if not place.shape == mean.shape == deviation.shape or place.ndim != 1:
        raise ValueError(
            f"phi, viscosity and error have the shapes {place.shape}, {mean.shape} and {deviation.shape}"
            " (each point needs all three); give one of each for every point"
        )
    # Senseless numbers and a search gone astray overflow; what comes of it is looked at in the end.
    with np.errstate(all="ignore"):
        return _fit(law, place, mean, deviation, dimension)


def fit_all(phi: ArrayLike, viscosity: ArrayLike, error: ArrayLike, dimension: int) -> list[Fit | NoFit]:
    """All laws, in the order of LAWS; see `fit`."""
    return [fit(law, phi, viscosity, error, dimension) for law in LAWS]


def _fit(name: str, phi: Array, mean: Array, error: Array, dimension: int) -> Fit | NoFit:
    law = LAWS[name]
    used = np.isfinite(mean) & np.isfinite(error) & (error > 0.0)
    used &= (phi >= 0.0) & (phi < 1.0) & (phi <= _WHOLE_BODIES * law.limit)
    phi, mean, error = phi[used], mean[used], error[used]
    distinct = len(np.unique(phi))
    if distinct < law.distinct:
        where = f" up to {law.limit:g}" if law.limit < 1.0 else ""
        counted = f"{distinct} volume fraction{'' if distinct == 1 else 's'}{where}"
        return NoFit(name, f"{counted} with known errors, and it needs {law.distinct}", len(phi))
    found = _least_squares(law, phi, mean, error, dimension)
    fitted = None if found is None else _result(name, phi, mean, error, dimension, found)
    return fitted or NoFit(name, "no curve of this law with a positive viscosity at phi = 0 was found", len(phi))


def _least_squares(law: Law, phi: Array, mean: Array, error: Array, dimension: int) -> tuple[Array, Array] | None:
    """Parameters (eta_0 first, 1/phi_m for phi_m) and their covariance; None where there is no minimum."""
    from scipy.optimize import OptimizeWarning, curve_fit  # takes a while to import, and few runs need it

    scale = float(np.abs(mean).max()) or 1.0

    def model(place: Array, *parameters: float) -> Array:
        return scale * parameters[0] * law.formula(place, dimension, *parameters[1:])

    start, low, high = _start(law, phi, mean / scale, error / scale, dimension)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OptimizeWarning)
        try:
            best, covariance = curve_fit(
                model, phi, mean, start, error, absolute_sigma=True, bounds=(low, high), method="trf", x_scale="jac",
                ftol=1e-12, xtol=1e-12, gtol=1e-12, max_nfev=1000,
            )  # fmt: skip
        except (RuntimeError, ValueError):
            return None
    if not (np.isfinite(covariance).all() and (np.diag(covariance) > 0.0).all() and best[0] > 0.0):
        return None
    best[0] *= scale
    covariance[0, :] *= scale
    covariance[:, 0] *= scale
    return best, covariance


def _start(law: Law, phi: Array, mean: Array, error: Array, dimension: int) -> tuple[list[float], Array, Array]:
    """Where the search starts, and between which bounds it stays.

    Of some 1/phi_m the one with the least chi-square, at the best eta_0 of each and [eta] = (d + 2)/2.
    """
    slope = suspension.intrinsic_viscosity(dimension)
    if not law.has_packing:
        free = [float(mean[np.argmin(phi)]), slope, 0.0][: 1 + len(law.parameters)]
        return free, np.full(len(free), -np.inf), np.full(len(free), np.inf)
    greatest = (1.0 - _ROOM) / float(phi.max())
    shapes = [[inverse, slope][: len(law.parameters)] for inverse in greatest * np.linspace(0.02, 0.98, 25)]
    ranked = []
    for shape in shapes:
        curve = law.formula(phi, dimension, *shape)
        level = float(np.sum(curve * mean / error**2) / np.sum(curve**2 / error**2))
        ranked.append((float(np.sum(((mean - level * curve) / error) ** 2)), [level, *shape]))
    start = min(ranked)[1]
    low, high = [-np.inf, 1e-6, 0.0][: len(start)], [np.inf, greatest, np.inf][: len(start)]
    return start, np.array(low), np.array(high)


def _result(
    name: str, phi: Array, mean: Array, error: Array, dimension: int, found: tuple[Array, Array]
) -> Fit | NoFit | None:
    """What was found, in the law's own parameters; None where it is no number."""
    law, (best, covariance) = LAWS[name], found
    errors = np.sqrt(np.diag(covariance))
    deviations = (mean - best[0] * law.formula(phi, dimension, *best[1:])) / error
    chi_square, free = float(deviations @ deviations), len(phi) - len(best)
    if law.has_packing:
        if errors[1] > _LEAST_SHARE * best[1]:
            told = f"1/phi_m = {best[1]:.2g} +- {errors[1]:.2g}"
            return NoFit(name, f"the points do not determine the maximum packing phi_m, {told}", len(phi))
        best, errors = best.copy(), errors.copy()
        best[1], errors[1] = 1.0 / best[1], errors[1] / best[1] ** 2
    if not (np.isfinite([*best, *errors, chi_square]).all() and (errors > 0.0).all()):
        return None
    parameters = {
        each: Estimate(float(value), float(deviation), samples=len(phi), inefficiency=1.0, converged=True)
        for each, value, deviation in zip(("viscosity_at_zero", *law.parameters), best, errors, strict=True)
    }
    return Fit(name, dimension, parameters, chi_square, free, len(phi))
