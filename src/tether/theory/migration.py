"""Shear-induced migration in plane Poiseuille flow (the paper's eq. 49-51).

R. J. Phillips, R. C. Armstrong, R. A. Brown, A. L. Graham and J. R. Abbott, Phys. Fluids A 4, 30 (1992),
doi 10.1063/1.858498. Particles leave where they collide often and where it is more viscous; their flux is

    J = -K_c a^2 phi grad(rate phi) - K_eta a^2 rate phi^2 grad(ln eta)

(the paper's eq. 50 is -J and its eq. 49 has the sign to match). Where J = 0 along the channel's width,
rate phi eta^(K_eta/K_c) is a constant, and with the momentum balance eta rate = G xi,

    (phi/phi_w) (eta_w/eta)^(1 - K) = h/xi,    K = K_eta/K_c                (the paper's eq. 51)

xi: distance from the centerline, h: half-width, w: at xi = h, G: driving force per volume. Here eta is
Krieger and Dougherty's, eta_s (1 - phi/phi_m)^(-p) with p = [eta] phi_m. With y = 1 - phi/phi_m, the room that
is left, and q = p (K - 1),

    xi/h = (phi_w/phi) (y/y_w)^q

gives xi of y without a root to be found, and all integrals run over s = ln(y/(1 - y)), which resolves dilute and
packed places alike (d ln xi / ds = q (1 - y) + y). At the centerline phi = phi_m exactly, with a cusp: y goes as
xi^(1/q), the shear rate as xi^(1 + 1/(K - 1)). K must exceed 1: otherwise the left side of eq. 51 has a greatest
value, and no phi solves it near the centerline. Phillips et al. have K_c/K_eta = 0.66, K = 1.52; the paper 3.77.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import expit, log_expit

from tether.theory.arrays import Numbers, plain


@dataclass(frozen=True)
class MigrationProfile:
    """The steady state of a suspension in a plane channel; centerline at 0, from -half_width to half_width."""

    wall: float
    """phi_w, volume fraction at the wall: from 0 to below the maximum packing."""
    flux_ratio: float
    """K = K_eta/K_c, above 1; no dimension."""
    maximum_packing: float = 0.65
    """phi_m; the paper has 0.65 in 3D and 0.91 in 2D."""
    intrinsic_viscosity: float = 2.5
    """[eta]: 2.5 for spheres, 2 for discs."""
    half_width: float = 1.0
    """h, length; of a box under reverse Poiseuille flow a quarter of its length along y."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.wall < self.maximum_packing:
            raise ValueError(
                f"no volume fraction at the wall can be {self.wall:g} (a flowing suspension has from 0 to below "
                f"{self.maximum_packing:g}, its maximum packing); give a volume fraction in that range"
            )
        if not self.flux_ratio > 1.0:
            raise ValueError(
                f"no profile has the flux ratio {self.flux_ratio:g} (eq. 51 has no solution at the centerline unless "
                "K_eta/K_c exceeds 1); give K_eta/K_c, which is 1.52 in Phillips et al., not its inverse"
            )

    @classmethod
    def of_mean(
        cls,
        mean: float,
        *,
        flux_ratio: float,
        maximum_packing: float = 0.65,
        intrinsic_viscosity: float = 2.5,
        half_width: float = 1.0,
    ) -> MigrationProfile:
        """The profile whose average over the width is mean, as migration conserves it: from 0 to below phi_m."""

        def profile(wall: float) -> MigrationProfile:
            return cls(wall, flux_ratio, maximum_packing, intrinsic_viscosity, half_width)

        if not 0.0 < mean < maximum_packing:
            return profile(mean)  # 0 is a fluid alone; anything else is refused there
        if profile(mean).mean <= mean:
            return profile(mean)  # even to rounding, as near the maximum packing
        # mean/wall is at most 1 + ln(phi_m/wall): a hundredth of the mean is too little, for any mean above 1e-40.
        wall = brentq(lambda wall: profile(wall).mean - mean, 0.01 * mean, mean, xtol=1e-15 * mean, rtol=1e-14)
        return profile(float(wall))

    @property
    def mean(self) -> float:
        """Volume fraction averaged over the width, the integral of phi d xi / h."""
        return 0.0 if self.wall == 0.0 else self._average(lambda s: self.maximum_packing * float(expit(-s)))

    def volume_fraction(self, position: Numbers) -> Numbers:
        """phi(xi), positions from -half_width to half_width; phi_m at 0 (unless the wall has 0)."""
        return plain(self.maximum_packing * expit(-self._logit(position)))

    def relative_viscosity(self, position: Numbers) -> Numbers:
        """eta/eta_s at a position: (1 - phi/phi_m)^(-[eta] phi_m); infinite at the centerline."""
        return plain(np.exp(-self._p * log_expit(self._logit(position))))

    def shear_rate(self, position: Numbers, *, force_density: float, solvent_viscosity: float) -> Numbers:
        """du/dxi = -G xi/eta: negative above the centerline where G is positive; 1/time.

        force_density: G, the driving force per volume (minus the pressure gradient; n g in reverse Poiseuille
        flow). solvent_viscosity: eta_s, stress x time.
        """
        fluidity = self._fluidity(self._logit(position)) / solvent_viscosity
        return plain(-force_density * np.asarray(position) * fluidity)

    def velocity(self, position: Numbers, *, force_density: float, solvent_viscosity: float) -> Numbers:
        """u(xi): the integral of G xi/eta from |xi| to h, no slip at the wall; length/time. See shear_rate."""
        scale = force_density * self.half_width**2 / solvent_viscosity
        if self.wall == 0.0:
            return plain(0.5 * scale * (1.0 - self._scaled(position) ** 2))
        start = self._logit(position)
        integral = [self._average(lambda s: self._scaled_at(s) * self._fluidity(s), each) for each in start.ravel()]
        return plain(scale * np.reshape(integral, start.shape))

    def mean_velocity(self, *, force_density: float, solvent_viscosity: float) -> float:
        """The average of the velocity over the width: by parts the integral of G xi^2/eta over h; length/time."""
        scale = force_density * self.half_width**2 / solvent_viscosity
        if self.wall == 0.0:
            return scale / 3.0
        return scale * self._average(lambda s: self._scaled_at(s) ** 2 * self._fluidity(s))

    @property
    def _p(self) -> float:
        return self.intrinsic_viscosity * self.maximum_packing

    @property
    def _q(self) -> float:
        return self._p * (self.flux_ratio - 1.0)

    @property
    def _wall_logit(self) -> float:
        """s at the wall: ln((phi_m - phi_w)/phi_w)."""
        return math.inf if self.wall == 0.0 else math.log((self.maximum_packing - self.wall) / self.wall)

    def _scaled(self, position: Numbers) -> NDArray[np.float64]:
        """|xi|/h."""
        scaled = np.abs(np.asarray(position, dtype=np.float64)) / self.half_width
        if not np.all(scaled <= 1.0 + 1e-12):
            raise ValueError(
                "a position lies outside the channel (the profile ends at the walls); "
                f"measure from the centerline, from {-self.half_width:g} to {self.half_width:g}"
            )
        return np.minimum(scaled, 1.0)

    def _logit(self, position: Numbers) -> NDArray[np.float64]:
        """s = ln(y/(1 - y)) at positions, the root of eq. 51: -inf at the centerline, inf in a fluid alone."""
        scaled = self._scaled(position)
        if self.wall == 0.0:
            return np.full_like(scaled, math.inf)
        return np.reshape([self._logit_at(each) for each in scaled.ravel()], scaled.shape)

    def _logit_at(self, scaled: float) -> float:
        if scaled == 0.0:
            return -math.inf
        wall = self._wall_logit
        lowest = log_expit(wall) + math.log(scaled) / self._q  # of ln y, as phi is at least phi_w
        lowest -= math.log(-math.expm1(lowest))
        lowest -= 1e-12 * (1.0 + abs(lowest))  # below the root in spite of rounding
        return float(brentq(lambda s: self._log_scaled_at(s) - math.log(scaled), lowest, wall, xtol=1e-13, rtol=1e-14))

    def _log_scaled_at(self, s: float) -> float:
        """ln(xi/h) by eq. 51; rises with s, and is 0 at the wall."""
        wall = self._wall_logit
        return float(log_expit(-wall) - log_expit(-s) + self._q * (log_expit(s) - log_expit(wall)))

    def _scaled_at(self, s: float) -> float:
        return math.exp(self._log_scaled_at(s))

    def _fluidity(self, s: Numbers) -> Numbers:
        """eta_s/eta, y^p."""
        return plain(np.exp(self._p * log_expit(s)))

    def _average(self, value: Callable[[float], Numbers], start: float = -math.inf) -> float:
        """The integral of a function of s over xi/h, from where s is start to the wall."""

        def integrand(s: float) -> float:
            return float(value(s) * self._scaled_at(s) * (self._q * expit(-s) + expit(s)))

        ends = [start, 0.0, self._wall_logit] if start < 0.0 < self._wall_logit else [start, self._wall_logit]
        return float(sum(quad(integrand, *piece, epsabs=0.0, epsrel=1e-10)[0] for piece in pairwise(ends)))
