"""Relative viscosity eta_r = eta / eta_solvent against volume fraction phi: dilute theory and empirical laws.

Numbers without units. phi is the volume fraction of the suspended phase, a number or an array; what comes
back has its shape. The paper's eq. 46-48, and Batchelor's second order. The paper finds phi_m = 0.91 in 2D
and 0.65 in 3D to fit its suspensions.
"""

from __future__ import annotations

import math
from typing import Literal, overload

import numpy as np
from numpy.typing import NDArray

MAXIMUM_PACKING = {2: 0.91, 3: 0.65}
"""phi_m by dimension: discs in hexagonal packing, pi/sqrt(12) = 0.907; spheres in random close packing."""


def intrinsic_viscosity(dimension: int) -> float:
    """[eta] = (d + 2)/2, the slope of eta_r at phi = 0 for rigid discs (2) and spheres (2.5).

    J. F. Brady, Int. J. Multiphase Flow 10, 113 (1984).
    """
    return (dimension + 2.0) / 2.0


@overload
def einstein(phi: float, dimension: int) -> float: ...
@overload
def einstein(phi: NDArray[np.float64], dimension: int) -> NDArray[np.float64]: ...
def einstein(phi: float | NDArray[np.float64], dimension: int) -> float | NDArray[np.float64]:
    """eta_r = 1 + [eta] phi, [eta] = (d + 2)/2: exact to first order in phi (the paper's eq. 46)."""
    return _like(phi, 1.0 + intrinsic_viscosity(dimension) * _fraction(phi))


BATCHELOR_COEFFICIENT = {"brownian": 6.2, "hydrodynamic": 5.2, "extension": 7.6}
"""Coefficient of phi^2 for spheres in 3D, by what it is of; see batchelor."""


@overload
def batchelor(phi: float, case: Literal["brownian", "hydrodynamic", "extension"] = ...) -> float: ...
@overload
def batchelor(
    phi: NDArray[np.float64], case: Literal["brownian", "hydrodynamic", "extension"] = ...
) -> NDArray[np.float64]: ...
def batchelor(
    phi: float | NDArray[np.float64], case: Literal["brownian", "hydrodynamic", "extension"] = "brownian"
) -> float | NDArray[np.float64]:
    """eta_r = 1 + 5/2 phi + k phi^2: hard spheres in 3D to second order in phi; good to phi of about 0.1.

    "brownian"      k = 6.2: strong Brownian motion (Pe -> 0), the viscosity at rest. G. K. Batchelor, J. Fluid
                    Mech. 83, 97 (1977), doi 10.1017/S0022112077001062.
    "hydrodynamic"  k = 5.2: the same without the stress of Brownian motion, at the even distribution of pairs
                    that it keeps up; the viscosity at high frequency. Same source.
    "extension"     k = 7.6: no Brownian motion (Pe -> infinity), pure straining flow. G. K. Batchelor and J. T.
                    Green, J. Fluid Mech. 56, 401 (1972), doi 10.1017/S0022112072002435.

    In simple shear without Brownian motion pairs circle each other for ever, and k is not determined.
    """
    if case not in BATCHELOR_COEFFICIENT:
        raise ValueError(
            f"no second-order coefficient is called {case!r} (it depends on Brownian motion and flow); "
            f"choose one of {', '.join(BATCHELOR_COEFFICIENT)}"
        )
    fraction = _fraction(phi)
    return _like(phi, 1.0 + 2.5 * fraction + BATCHELOR_COEFFICIENT[case] * fraction**2)


@overload
def krieger_dougherty(phi: float, dimension: int, maximum_packing: float | None = None) -> float: ...
@overload
def krieger_dougherty(
    phi: NDArray[np.float64], dimension: int, maximum_packing: float | None = None
) -> NDArray[np.float64]: ...
def krieger_dougherty(
    phi: float | NDArray[np.float64], dimension: int, maximum_packing: float | None = None
) -> float | NDArray[np.float64]:
    """eta_r = (1 - phi/phi_m)^(-[eta] phi_m) (the paper's eq. 47); infinite from phi_m on.

    I. M. Krieger and T. J. Dougherty, Trans. Soc. Rheol. 3, 137 (1959), doi 10.1122/1.548848. An empirical
    law; phi_m is MAXIMUM_PACKING[dimension] unless given.
    """
    packing = MAXIMUM_PACKING[dimension] if maximum_packing is None else maximum_packing
    return _like(phi, _power_of_room(_fraction(phi), packing, intrinsic_viscosity(dimension) * packing))


@overload
def quemada(phi: float, maximum_packing: float) -> float: ...
@overload
def quemada(phi: NDArray[np.float64], maximum_packing: float) -> NDArray[np.float64]: ...
def quemada(phi: float | NDArray[np.float64], maximum_packing: float) -> float | NDArray[np.float64]:
    """eta_r = (1 - phi/phi_m)^(-2) (the paper's eq. 48); infinite from phi_m on.

    D. Quemada, Rheol. Acta 16, 82 (1977), doi 10.1007/BF01516932. It is no dilute law: its slope at phi = 0
    is 2/phi_m, not [eta].
    """
    return _like(phi, _power_of_room(_fraction(phi), maximum_packing, 2.0))


def _power_of_room(phi: NDArray[np.float64], packing: float, power: float) -> NDArray[np.float64]:
    room = 1.0 - phi / packing
    jammed = room <= 0.0
    return np.where(jammed, math.inf, np.where(jammed, 1.0, room) ** -power)


def _fraction(phi: float | NDArray[np.float64]) -> NDArray[np.float64]:
    fraction = np.asarray(phi, dtype=np.float64)
    if not ((fraction >= 0.0) & (fraction <= 1.0)).all():
        raise ValueError("a volume fraction must be from 0 to 1 (it is a part of a whole); divide a percentage by 100")
    return fraction


def _like(phi: float | NDArray[np.float64], result: NDArray[np.float64]) -> float | NDArray[np.float64]:
    return float(result) if np.ndim(phi) == 0 else result
