"""Pressure and isothermal sound speed of the plain DPD fluid with conservative force a (1 - r/r_c).

    p = n kT + alpha a n^2 r_c^(d + 1)

is an asymptote at high density, whatever w_D. In 3D alpha = 0.101 (R. D. Groot and P. B. Warren, J. Chem.
Phys. 107, 4423 (1997), doi 10.1063/1.474784); at the paper's fluid (n = 4, a = 18.75, kT = 1) it is about 5
% too high in p, and up to 9 % at lower densities. In 2D no fitted constant is known to us: alpha = pi/24 is
the mean-field value (g = 1 in the virial; its 3D twin is pi/30 = 0.105), 7 % too high in p at the paper's
fluid. A sound speed goes with the square root: half of these. All arguments but the dimension may be arrays.
"""

from __future__ import annotations

import math

import numpy as np

from tether.theory.arrays import Numbers, plain

REPULSION_COEFFICIENT = {2: math.pi / 24.0, 3: 0.101}
"""alpha by dimension: mean field in 2D, Groot and Warren's fit in 3D; no dimension."""


def pressure(
    *, density: Numbers, temperature: Numbers, repulsion: Numbers, dimension: int, cutoff: Numbers = 1.0
) -> Numbers:
    """p = n kT + alpha a n^2 r_c^(d + 1), positive in compression; energy/length^d."""
    virial = REPULSION_COEFFICIENT[dimension] * repulsion * density**2 * cutoff ** (dimension + 1)
    return plain(density * temperature + virial)


def sound_speed(
    *,
    density: Numbers,
    temperature: Numbers,
    repulsion: Numbers,
    dimension: int,
    cutoff: Numbers = 1.0,
    mass: Numbers = 1.0,
) -> Numbers:
    """Isothermal sound speed, c^2 = (dp/dn)/m = (kT + 2 alpha a n r_c^(d + 1))/m; length/time."""
    return sound_speed_from_pressure(
        pressure=pressure(
            density=density, temperature=temperature, repulsion=repulsion, dimension=dimension, cutoff=cutoff
        ),
        density=density,
        temperature=temperature,
        mass=mass,
    )


def sound_speed_from_pressure(
    *, pressure: Numbers, density: Numbers, temperature: Numbers, mass: Numbers = 1.0
) -> Numbers:
    """The same from a measured pressure, whose part beyond n kT is taken to go as n^2.

    c^2 = (kT + 2 (p - n kT)/n)/m; length/time. nan where that is negative, which no DPD fluid is.
    """
    stiffness = temperature + 2.0 * (pressure - density * temperature) / density
    return plain(np.sqrt(np.where(np.asarray(stiffness) >= 0.0, stiffness, math.nan) / mass))
