"""Viscosity of force-driven flow from the force and the velocity that it drives: no formula for the stress is used.

In a steady flow u(y) along x the force on a slab is what the stress on its two sides differs by,

    d S_xy/dy = -f(y),        f: x-force per volume,       S_xy = eta du/dy    (positive in tension)                (1)

so the applied force fixes S_xy up to a constant. `f` is the force really applied, the instantaneous mean that keeps
the box from drifting subtracted; so its integral over the period is zero and S_xy is periodic. The constant is chosen
such that S_xy has zero mean. That is exact where a shift of y changes the sign of f and nothing else, as it does of a
wave (by half its length) and of reverse Poiseuille flow (by L/2), and for any f where eta does not depend on y.

Profiles are means over nb equal bins of a periodic box of height L, rows of samples (or blocks) by bins; bin j spans
[j, j + 1] L/nb. The viscosities are functions of the mean profiles, whose errors come from the rows by the delta
method with all correlations between bins and in time.

**One wave** (kolmogorov), f = f_k sin(k y) and more, k = 2 pi n/L. Times sin(k y) and integrated, (1) gives the first
harmonics of stress and rate exactly, whatever the density does:

    eta(k) = (first harmonic of S_xy)/(first harmonic of du/dy) = f_k/(k^2 u_k),   u = u_k sin(k y) + ...            (2)

With N particles under the force g sin(k y) each, f_k = (2/V) sum_i g sin^2(k y_i) less the mean, n g at uniform density
n, and u_k = (2/N) sum_i v_x,i sin(k y_i) there: averaged per particle. In a fluid of uneven density these two numbers
are not the harmonics of f(y) and u(y); take (2) of the profiles. This is the viscosity at the wavenumber k, lower
than at k = 0 by a part of the order (k times the range of the forces or the size of a body)^2.

**Any force** (reverse Poiseuille; J. A. Backer et al., J. Chem. Phys. 122, 154503 (2005), doi 10.1063/1.1883163). The
power of the force is what viscosity dissipates: <f u> = <S_xy du/dy> = <S_xy^2/eta>, means over y, by parts. So

    eta = <S_xy^2>/<f u>,        1/eta = <S_xy^2 (1/eta(y))>/<S_xy^2>                                               (3)

the projection of (1) on w = S_xy: exact for a uniform eta, else the mean of 1/eta(y) weighted with the stress squared,
without a derivative of measured data. In reverse Poiseuille flow, f = +- n g, it is n g h^2/(12 <u>) with h = L/2 and
<u> the mean velocity in a half, 96/pi^4 = 98.6 % of it is the lowest wavenumber.
"""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether.estimate import Estimate, estimate_function

Rows = NDArray[np.float64]


def stress_of_force(height: float, force_density: Rows) -> Rows:
    """S_xy(y) that momentum balance asks for, means over the bins; its own mean over y is zero (see the module).

    height: L. force_density: means over the bins, (..., nb), force/length^d; its mean over y, which is no shear stress
    of a periodic box, is subtracted. Exact where f is constant in each bin; of a wave the relative error is
    (k L/nb)^2/12.
    """
    edges = stress_at_edges(height, force_density)
    mean: Rows = 0.5 * (edges + np.roll(edges, 1, axis=-1))
    mean -= mean.mean(axis=-1, keepdims=True)
    return mean


def stress_at_edges(height: float, force_density: Rows) -> Rows:
    """The same at the upper edges of the bins, (..., nb): exact there up to the constant, whatever f is."""
    force = np.asarray(force_density, dtype=np.float64)
    width = height / force.shape[-1]
    stress = -width * np.cumsum(force - force.mean(axis=-1, keepdims=True), axis=-1)
    edges: Rows = stress - stress.mean(axis=-1, keepdims=True)
    return edges


def wave_amplitude(height: float, profile: Rows, periods: int = 1) -> Rows:
    """Amplitude of sin(2 pi periods y/L) in the means over bins of a profile, (..., nb) -> (...).

    The mean of a wave over a bin is its value in the middle times sin(k L/(2 nb))/(k L/(2 nb)), which is divided out.
    """
    bins = profile.shape[-1]
    y = (np.arange(bins) + 0.5) * height / bins
    wavenumber = 2.0 * math.pi * periods / height
    half = 0.5 * wavenumber * height / bins
    amplitude: Rows = 2.0 * (profile @ np.sin(wavenumber * y)) / bins * half / math.sin(half)
    return amplitude


def kolmogorov_viscosity(
    height: float, force_density: Rows, velocity: Rows, periods: int = 1, *, unit: str = ""
) -> Estimate:
    """eta(k) = f_k/(k^2 u_k) from profiles, eq. (2) of the module, at the wavenumber k = 2 pi periods/height.

    force_density, velocity: means over the bins, rows of samples, (n, nb) each.
    """
    _check(force_density, velocity)
    modes = [wave_amplitude(height, np.asarray(rows), periods) for rows in (force_density, velocity)]
    return viscosity_of_modes(2.0 * math.pi * periods / height, *modes, unit=unit)


def viscosity_of_modes(wavenumber: float, force_mode: Rows, velocity_mode: Rows, *, unit: str = "") -> Estimate:
    """eta(k) = f_k/(k^2 u_k) from series of the two amplitudes, (n,) each.

    force_mode: (2/V) sum_i F_x,i sin(k y_i) over all particles, F the force really applied. velocity_mode: (2/N) sum_i
    v_x,i sin(k y_i), averaged per particle (uniform density), or that of the velocity's profile.
    """
    columns = np.stack([force_mode, velocity_mode], axis=1)
    return estimate_function(lambda mean: _ratio(mean[0], wavenumber**2 * mean[1]), columns, unit)


def work_viscosity(height: float, force_density: Rows, velocity: Rows, *, unit: str = "") -> Estimate:
    """eta = <S_xy^2>/<f u> from profiles under any force, eq. (3) of the module.

    force_density, velocity: means over the bins, rows of samples, (n, nb) each. S_xy is taken linear within a bin:
    exact where f is constant in each bin, as in reverse Poiseuille flow with an even number of bins; of a wave eta is
    low by the part (k L/nb)^2/12.
    """
    _check(force_density, velocity)
    columns = np.hstack([force_density, velocity])

    def of(mean: Rows) -> float:
        force, speed = np.split(mean, 2)
        upper = stress_at_edges(height, force)
        lower = np.roll(upper, 1)
        upper, lower = (edge - 0.5 * (upper + lower).mean() for edge in (upper, lower))
        squared = (upper**2 + upper * lower + lower**2).mean() / 3.0
        return _ratio(float(squared), float(((force - force.mean()) * speed).mean()))

    return estimate_function(of, columns, unit)


def local_viscosity(height: float, force_density: Rows, velocity: Rows, *, least: float = 0.2) -> xr.Dataset:
    """S_xy(y)/(du/dy) at the edges between bins, from profiles; dims y, the edges.

    force_density, velocity: means over the bins, rows of samples, (n, nb) each. The rate is the difference of
    neighboring bins over their distance. Variables: viscosity, viscosity_error, stress, shear_rate; viscosity is nan
    where |S_xy| is below `least` of its maximum, where both it and the rate cross zero.
    """
    _check(force_density, velocity)
    bins = force_density.shape[1]
    width = height / bins
    stress = stress_at_edges(height, force_density)  # linear in f: the mean of the rows' is that of the mean
    rate = (np.roll(velocity, -1, axis=1) - velocity) / width
    mean_stress = stress.mean(axis=0)
    value, error = np.full(bins, math.nan), np.full(bins, math.nan)
    for edge in np.flatnonzero(np.abs(mean_stress) >= least * np.abs(mean_stress).max()):
        found = estimate_function(lambda mean: _ratio(mean[0], mean[1]), np.stack([stress[:, edge], rate[:, edge]], 1))
        value[edge], error[edge] = found.value, found.error
    return xr.Dataset(
        {
            "viscosity": ("y", value),
            "viscosity_error": ("y", error),
            "stress": ("y", mean_stress),
            "shear_rate": ("y", rate.mean(axis=0)),
        },
        coords={"y": ("y", width * np.arange(1, bins + 1), {"units": "length", "long_name": "edge between two bins"})},
        attrs={"title": "viscosity by momentum balance"},
    )


def _ratio(numerator: float, denominator: float) -> float:
    return float(numerator / denominator) if denominator != 0.0 else math.inf


def _check(force_density: Rows, velocity: Rows) -> None:
    if force_density.ndim != 2 or force_density.shape != velocity.shape:
        raise ValueError(
            f"profiles of force and velocity have the shapes {force_density.shape} and {velocity.shape} (not samples by"
            " bins, the same for both); give rows of samples"
        )
