"""Diffusivity of a sphere in a viscous fluid, and what a periodic box makes of it.

    D   = kT / (6 pi eta a)                                      Stokes and Einstein, 3D (the paper's eq. 40)
    D_L = D - 2.837297 kT / (6 pi eta L)                         in a periodic cube of side L
    D_L = kT / (4 pi eta) (ln(L/a) - 1.3105 + pi a^2/L^2)        of a disc in a periodic square, 2D

kT: energy; eta: viscosity of the fluid around; a: hydrodynamic radius, where the fluid sticks; D:
length^2/time, positive. The laws are those of a body much larger than the fluid's own particles, at low
Reynolds number; the paper uses eq. 40 for solvent particles too, as a consistency check only.

In 2D a disc in an unbounded fluid has no finite drag at low Reynolds number (Stokes' paradox): there is no
Stokes-Einstein law. In a periodic box the box's size stands in for infinity, and D grows with its logarithm.
"""

from __future__ import annotations

import math

import numpy as np

from tether.theory.arrays import Numbers, plain

PERIODIC_CUBE = 2.837297
"""xi of the simple cubic lattice: its Ewald (Madelung) constant; no dimension. Yeh & Hummer 2004."""

PERIODIC_SQUARE = 2.0 * math.lgamma(0.25) - math.log(2.0 * math.sqrt(math.pi))
"""ln(Gamma(1/4)^2 / (2 sqrt(pi))) = 1.310533: the square lattice's constant in -ln(r/L) - c; no dimension."""


def stokes_einstein_diffusivity(
    *, temperature: Numbers, viscosity: Numbers, radius: Numbers, dimension: int = 3, slip: bool = False
) -> Numbers:
    """D = kT / (6 pi eta a) of a sphere that the fluid sticks to; 4 pi where it slips freely. Length^2/time."""
    return plain(temperature / (_drag_coefficient(dimension, slip) * viscosity * radius))


def stokes_einstein_radius(
    *, temperature: Numbers, viscosity: Numbers, diffusivity: Numbers, dimension: int = 3, slip: bool = False
) -> Numbers:
    """a = kT / (6 pi eta D), the paper's eq. 40; 4 pi with slip. Length. D is that of an unbounded fluid."""
    return plain(temperature / (_drag_coefficient(dimension, slip) * viscosity * diffusivity))


def unbounded_diffusivity(
    diffusivity: Numbers, *, temperature: Numbers, viscosity: Numbers, box_length: Numbers
) -> Numbers:
    """D = D_L + 2.837297 kT / (6 pi eta L): of a large fluid, from D_L measured in a periodic cube of side L.

    I.-C. Yeh and G. Hummer, J. Phys. Chem. B 108, 15873 (2004), doi 10.1021/jp0477147. The images of a
    particle drag it back; how large the particle is, and whether the fluid sticks to it, changes only the next
    order, (a/L)^3. In 3D, in a cube only.
    """
    return plain(diffusivity + _drag_of_images(temperature, viscosity, box_length))


def periodic_diffusivity(
    diffusivity: Numbers, *, temperature: Numbers, viscosity: Numbers, box_length: Numbers
) -> Numbers:
    """D_L = D - 2.837297 kT / (6 pi eta L): what a periodic cube of side L makes of D. As unbounded_diffusivity."""
    return plain(diffusivity - _drag_of_images(temperature, viscosity, box_length))


def periodic_disc_diffusivity(
    *, temperature: Numbers, viscosity: Numbers, radius: Numbers, box_length: Numbers
) -> Numbers:
    """D_L = kT / (4 pi eta) (ln(L/a) - 1.3105 + pi a^2/L^2) of a disc in a periodic square of side L, 2D.

    H. Hasimoto, J. Fluid Mech. 5, 317 (1959), doi 10.1017/S0022112059000222: a square array of cylinders that
    the fluid sticks to, as fluid and disc together stand still, which is how a box with conserved momentum
    does it. What is left out is of the order (pi a^2/L^2)^2. In 2D eta is stress (force/length) x time.
    """
    if not np.all((np.asarray(radius) > 0.0) & (2.0 * np.asarray(radius) < box_length)):
        raise ValueError(
            "a disc must be smaller than its box (it would overlap its own images); take 0 < radius < box_length / 2"
        )
    room = np.log(np.asarray(box_length) / radius) - PERIODIC_SQUARE + math.pi * np.square(radius / box_length)
    return plain(temperature / (4.0 * math.pi * viscosity) * room)


def _drag_of_images(temperature: Numbers, viscosity: Numbers, box_length: Numbers) -> Numbers:
    return PERIODIC_CUBE * temperature / (6.0 * math.pi * viscosity * box_length)


def _drag_coefficient(dimension: int, slip: bool) -> float:
    """Drag of a sphere over eta a times its speed."""
    if dimension == 2:
        raise ValueError(
            "there is no Stokes-Einstein law in 2D (a disc in an unbounded fluid has no finite drag, its mobility "
            "grows with the logarithm of the fluid's size); use periodic_disc_diffusivity, which takes the box"
        )
    if dimension != 3:
        raise ValueError(f"no Stokes-Einstein law in {dimension} dimensions (a box has 2 or 3); take dimension=3")
    return 4.0 * math.pi if slip else 6.0 * math.pi
