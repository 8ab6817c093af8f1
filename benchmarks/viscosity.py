"""Wall time until the shear viscosity of the plain 3D fluid has a standard error of 1 %.

Both run the same number of steps in portions that alternate, on one core, and sample the stress at every step. The
error is that of the blocked mean (`tt.estimate`), and the time to 1 % is the wall time, times (relative error / 1 %)^2.
Ours leaves the random term out of the stress, whose mean is zero; the pressure of LAMMPS has it in.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

import tether as tt
from benchmarks.lammps_peer import Peer, lammps_version
from benchmarks.ours import Ours
from benchmarks.setup import Manner, cubic

PARTICLES = 16_000
SHEAR_RATE = 0.1
"""In units of 1 / time."""
AIMS = {2.0: 8.0, 0.5: None}
"""How many times sooner than LAMMPS we aim to be, by exponent."""

_RELATIVE_ERROR = 0.01
_PORTIONS = 10
_TERMS = ("stress_kinetic", "stress_conservative", "stress_dissipative")
_XY = 1  # of the components of a 3D stress, row by row


@dataclass(frozen=True)
class Measured:
    """The viscosity that one program found, in units of pressure times time, and how long it took."""

    viscosity: tt.Estimate
    seconds: float
    """Wall time of the measurement, equilibration left out."""
    speed: float
    """In million particle-steps per second."""

    @property
    def seconds_to_aim(self) -> float:
        """Wall time to a standard error of 1 %."""
        return self.seconds * (self.viscosity.relative_error / _RELATIVE_ERROR) ** 2

    @property
    def relative_uncertainty(self) -> float:
        """Standard error of `seconds_to_aim`, over itself: twice that of the error, which is known from few blocks."""
        return 2 * self.viscosity.error_of_error / self.viscosity.error

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {
            "viscosity": self.viscosity.as_dict(),
            "inefficiency_steps": self.viscosity.inefficiency,
            "seconds": self.seconds,
            "speed": self.speed,
            "seconds_to_1_percent": self.seconds_to_aim,
            "relative_uncertainty": self.relative_uncertainty,
        }


@dataclass(frozen=True)
class Comparison:
    """Both programs at one exponent."""

    exponent: float
    ours: Measured
    lammps: Measured | None

    @property
    def ratio(self) -> tuple[float, float] | None:
        """How many times sooner ours is there, and the standard error of that."""
        if self.lammps is None:
            return None
        ratio = self.lammps.seconds_to_aim / self.ours.seconds_to_aim
        return ratio, ratio * hypot(self.lammps.relative_uncertainty, self.ours.relative_uncertainty)

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {
            "exponent": self.exponent,
            "particles": PARTICLES,
            "shear_rate": SHEAR_RATE,
            "ours": self.ours.as_dict(),
            "lammps": self.lammps.as_dict() if self.lammps else None,
            "ratio": self.ratio,
            "least_ratio": AIMS[self.exponent],
        }


def compare(exponent: float, equilibration: int, steps: int) -> Comparison:
    """Run both for `steps` after an equilibration."""
    setup = cubic(PARTICLES, exponent, shear_rate=SHEAR_RATE)
    ours = Ours(setup, Manner(interval=1))
    ours.run(equilibration)
    particles = ours.particles
    peer = Peer(setup, ours.state) if lammps_version() else None
    if peer:
        peer.run(equilibration // 4)  # it starts from what ours has equilibrated
    ours_parts, peer_parts, seconds = [], [], [0.0, 0.0]
    for _ in range(_PORTIONS):
        measured, took = ours.measure(steps // _PORTIONS)
        ours_parts.append(_stress(type(ours.engine).columns, measured))
        seconds[0] += took
        if peer:
            pressure, took = peer.measure(steps // _PORTIONS)
            peer_parts.append(-pressure)
            seconds[1] += took
    if peer:
        peer.close()
    ours.close()
    return Comparison(
        exponent,
        _measured(ours_parts, particles, seconds[0]),
        _measured(peer_parts, particles, seconds[1]) if peer else None,
    )


def _stress(columns: list[tuple[str, int]], measured: NDArray[np.float64]) -> NDArray[np.float64]:
    """The xy stress of each sample, without the random term; in units of energy / length^3."""
    names, widths = zip(*columns, strict=True)
    first = dict(zip(names, np.cumsum([0, *widths[:-1]]), strict=True))
    return sum((measured[:, first[term] + _XY] for term in _TERMS), np.zeros(len(measured)))


def _measured(stress: list[NDArray[np.float64]], particles: int, seconds: float) -> Measured:
    series = np.concatenate(stress)
    return Measured(tt.estimate(series / SHEAR_RATE), seconds, particles * len(series) / seconds / 1e6)


def shown(comparisons: list[Comparison]) -> str:
    """A table, as text."""
    lines = [
        f"Wall time to a standard error of 1 % of the viscosity: plain 3D fluid, {PARTICLES} particles,"
        f" shear rate {SHEAR_RATE:g}, one thread",
        "",
        f"{'s':>4} {'':<8}{'viscosity':>18}{'measured':>12}{'speed':>10}{'to 1 %':>12}{'LAMMPS / ours':>20}{'aim':>8}",
    ]
    for of in comparisons:
        for name, measured in (("ours", of.ours), ("LAMMPS", of.lammps)):
            if measured is None:
                continue
            ratio = f"{of.ratio[0]:.1f} +- {of.ratio[1]:.1f}" if of.ratio and name == "ours" else ""
            aim = f">= {AIMS[of.exponent]:g}" if AIMS[of.exponent] and name == "ours" else ""
            times = f"{measured.seconds:>10.1f} s{measured.speed:>10.2f}{measured.seconds_to_aim:>10.1f} s"
            lines.append(f"{of.exponent:>4g} {name:<8}{measured.viscosity!s:>18}{times}{ratio:>20}{aim:>8}")
    return "\n".join(lines)
