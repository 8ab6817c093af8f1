"""Kinetic theory of the DPD fluid without repulsion (a = 0).

C. A. Marsh, G. Backx and M. H. Ernst, Phys. Rev. E 56, 1676 (1997), doi 10.1103/PhysRevE.56.1676; the paper's
eq. 36-37 are the case w_D = (1 - r/r_c)^(1/2), R. D. Groot and P. B. Warren, J. Chem. Phys. 107, 4423 (1997),
doi 10.1063/1.474784, have w_D = (1 - r/r_c)^2 in 3D. Here the exponent s > 0 and the dimension d are free:

    [r^k w] = integral of r^k w_D(r) over the d-dimensional ball = S_d r_c^(d + k) Beta(d + k, s + 1)

with S_2 = 2 pi and S_3 = 4 pi. Repulsion raises the viscosity (the paper's fluid in 3D: by 5 % at kT = 1, by
12 % at 0.25) and there the diffusivity too (by 30 to 40 %). All arguments but the dimension may be arrays.
"""

from __future__ import annotations

import math

from scipy.special import beta

from tether.theory.arrays import Numbers, plain


def weight_integral(*, dimension: int, exponent: Numbers, cutoff: Numbers = 1.0, power: int = 0) -> Numbers:
    """[r^power w]: the integral of r^power (1 - r/cutoff)^exponent over the ball r < cutoff.

    Units: length^(dimension + power).
    """
    surface = {2: 2.0 * math.pi, 3: 4.0 * math.pi}[dimension]
    order = dimension + power
    return plain(surface * cutoff**order * beta(order, exponent + 1.0))


def diffusivity(
    *,
    density: Numbers,
    friction: Numbers,
    temperature: Numbers,
    dimension: int,
    exponent: Numbers,
    cutoff: Numbers = 1.0,
) -> Numbers:
    """Self-diffusion coefficient D = d kT / (n gamma [w]), length^2/time (the paper's eq. 37).

    A particle feels the friction n gamma [w] / d of its neighbors, taken uncorrelated with it; D is kT over
    it.
    """
    drag = density * friction * weight_integral(dimension=dimension, exponent=exponent, cutoff=cutoff) / dimension
    return plain(temperature / drag)


def viscosity(
    *,
    density: Numbers,
    friction: Numbers,
    temperature: Numbers,
    dimension: int,
    exponent: Numbers,
    cutoff: Numbers = 1.0,
    mass: Numbers = 1.0,
) -> Numbers:
    """Shear viscosity, kinetic plus dissipative part (the paper's eq. 36); positive.

    eta = m n D / 2  +  gamma n^2 [r^2 w] / (2 d (d + 2))

    Units: stress x time (in 2D stress is force/length). The kinetic part is n kT times m D / (2 kT), the time
    in which the drag of eq. 37 makes the correlation of V_x and V_y decay.
    """
    second_moment = weight_integral(dimension=dimension, exponent=exponent, cutoff=cutoff, power=2)
    spreading = diffusivity(
        density=density,
        friction=friction,
        temperature=temperature,
        dimension=dimension,
        exponent=exponent,
        cutoff=cutoff,
    )
    kinetic = 0.5 * mass * density * spreading
    dissipative = friction * density**2 * second_moment / (2.0 * dimension * (dimension + 2.0))
    return plain(kinetic + dissipative)
