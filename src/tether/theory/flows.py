"""Newtonian flows that a force on every particle drives through a periodic box: what momentum balance says.

The force per particle, g_x(y), acts along x. In a steady state the stress balances it, d S_xy/d y = -n g_x,
whatever the fluid; if the fluid is Newtonian, S_xy = eta du/dy. Stress is positive in tension, n is the number
density of all particles that the force acts on, eta the viscosity, L the box's length along y.

    reverse Poiseuille   g_x = +g for y > L/2, -g below: two channels of half-width h = L/4, one up, one down.
                         Nothing slips at y = 0 and L/2, by symmetry, and there are no walls.
                         J. A. Backer et al., J. Chem. Phys. 122, 154503 (2005), doi 10.1063/1.1883163;
                         the paper's section 4.8.
    Kolmogorov           g_x = g sin(k y), k = 2 pi periods/L: the viscosity at the wavenumber k.

Positions are taken modulo L; all arguments may be arrays. Units: any consistent set.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tether.theory.arrays import Numbers, plain


def reverse_poiseuille_velocity(
    position: Numbers, *, force: Numbers, density: Numbers, viscosity: Numbers, length: Numbers
) -> Numbers:
    """u_x(y) = +- n g (h^2 - xi^2)/(2 eta), + for y > L/2; xi = y minus the middle of its half. Length/time."""
    sign, from_middle = _half(position, length)
    room = np.square(length / 4.0) - from_middle**2
    return plain(sign * density * force * room / (2.0 * np.asarray(viscosity)))


def reverse_poiseuille_stress(position: Numbers, *, force: Numbers, density: Numbers, length: Numbers) -> Numbers:
    """S_xy(y) = -+ n g xi, - for y > L/2: of any fluid, Newtonian or not. Energy/length^d."""
    sign, from_middle = _half(position, length)
    return plain(-sign * density * force * from_middle)


def reverse_poiseuille_viscosity(
    *, maximum_velocity: Numbers, force: Numbers, density: Numbers, length: Numbers
) -> Numbers:
    """eta = n g h^2/(2 u_max), h = L/4; stress x time. Of a fluid that is no Newtonian one: an apparent viscosity."""
    return plain(density * force * np.square(length / 4.0) / (2.0 * np.asarray(maximum_velocity)))


def reverse_poiseuille_viscosity_from_mean(
    *, mean_velocity: Numbers, force: Numbers, density: Numbers, length: Numbers
) -> Numbers:
    """eta = n g h^2/(3 u_mean), h = L/4, with u_mean = 2/3 u_max the mean over the upper half; stress x time."""
    return plain(density * force * np.square(length / 4.0) / (3.0 * np.asarray(mean_velocity)))


def kolmogorov_velocity(
    position: Numbers, *, force: Numbers, density: Numbers, viscosity: Numbers, length: Numbers, periods: int = 1
) -> Numbers:
    """u_x(y) = n g/(eta k^2) sin(k y); length/time."""
    k = _wavenumber(length, periods)
    return plain(density * force / (np.asarray(viscosity) * k**2) * np.sin(k * position))


def kolmogorov_stress(
    position: Numbers, *, force: Numbers, density: Numbers, length: Numbers, periods: int = 1
) -> Numbers:
    """S_xy(y) = n g/k cos(k y): of any fluid whose density stays even. Energy/length^d."""
    k = _wavenumber(length, periods)
    return plain(density * force / k * np.cos(k * position))


def kolmogorov_viscosity(
    *, amplitude: Numbers, force: Numbers, density: Numbers, length: Numbers, periods: int = 1
) -> Numbers:
    """eta(k) = n g/(k^2 U), U the amplitude of sin(k y) in u_x; stress x time. eta at k -> 0 is the shear viscosity."""
    return plain(density * force / (_wavenumber(length, periods) ** 2 * np.asarray(amplitude)))


def _wavenumber(length: Numbers, periods: int) -> NDArray[np.float64]:
    return 2.0 * math.pi * periods / np.asarray(length, dtype=np.float64)


def _half(position: Numbers, length: Numbers) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The force's sign where y lies, and y measured from the middle of that half of the box."""
    y = np.mod(position, length)
    upper = y > 0.5 * np.asarray(length)
    return np.where(upper, 1.0, -1.0), y - np.where(upper, 0.75, 0.25) * length
