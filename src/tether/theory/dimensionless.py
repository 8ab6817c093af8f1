"""Peclet, Reynolds and Mach numbers of a sheared suspension, with the sizes that they were made from.

    Pe   = |rate| a^2 / D_0          the paper's eq. 18
    Re   = n m |rate| a L_y / eta    section 4.6's words: rho v L / eta, v = |rate| a, L the channel's width
    Re_a = n m |rate| a^2 / eta      of one body; the ranges of Re that section 4.6 prints equal Re_a / 2
    Ma   = |rate| a / c              section 4.6

a: effective radius of a body, D_0: diffusivity of one body alone, n, m and eta: number density, particle
mass and viscosity of the solvent, c: sound speed. Where these come from, first that applies:

1. the user's [reference];
2. a: the volume that a body counts for, if it has one; c: the measured pressure, if there is one;
3. the paper's own fluid and bodies: what was measured of them (Tables 1 and 2; each source is named);
4. estimates, said to be such.

The numbers carry no sign: the shear rate's is left out. They are None at rest and without bodies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tether.theory import diffusion, equation_of_state, kinetic
from tether.theory.arrays import Numbers, plain

if TYPE_CHECKING:
    from tether.bodies import Bodies
    from tether.config import Configuration


@dataclass(frozen=True)
class Quantity:
    """A value in reduced units, None where nothing tells it, and one line on where it comes from."""

    value: float | None
    source: str


@dataclass(frozen=True)
class Dimensionless:
    """The dimensionless numbers of a run (None at rest and without bodies) and what they were made from."""

    peclet: float | None
    reynolds: float | None
    particle_reynolds: float | None
    mach: float | None
    radius: Quantity
    """Effective radius a of a body, length."""
    diffusivity: Quantity
    """Diffusivity D_0 of one body alone in the solvent, length^2/time."""
    viscosity: Quantity
    """Viscosity eta of the solvent, stress x time."""
    sound_speed: Quantity
    """Isothermal sound speed c, length/time."""

    def as_dict(self) -> dict[str, float | dict[str, float | str | None] | None]:
        """For JSON: each number by its name, each quantity as {"value": ..., "source": ...}."""
        numbers: dict[str, float | dict[str, float | str | None] | None] = {
            "peclet": self.peclet,
            "reynolds": self.reynolds,
            "particle_reynolds": self.particle_reynolds,
            "mach": self.mach,
        }
        for name in ("radius", "diffusivity", "viscosity", "sound_speed"):
            quantity: Quantity = getattr(self, name)
            numbers[name] = {"value": quantity.value, "source": quantity.source}
        return numbers


@dataclass(frozen=True)
class _Measured:
    """What is known of the paper's fluid (n = 4, a = 18.75, sigma = 3, s = 1/2) at one temperature.

    radius: of the paper's body (square or cube, 0.25 between sites), Table 1, a_eff of the colloidal
    particle. diffusivity: of one such body; 3D: Table 2; 2D: from the caption of figure 10, a^2 |rate| / Pe
    by eq. 18, whose Pe is printed to two digits. viscosity: of the solvent; 3D: Table 2; 2D: our own.
    """

    radius: float
    diffusivity: float | None
    viscosity: float | None


_PAPER = {
    (2, 1.0): _Measured(0.3995, 0.3995**2 * 0.05 / 0.18, 3.090),
    (2, 0.5): _Measured(0.44, 0.44**2 * 0.01 / 0.13, None),
    (2, 0.25): _Measured(0.465, None, None),
    (3, 1.0): _Measured(0.605, 0.046, 2.5106),
    (3, 0.5): _Measured(0.64, 0.011, 4.5917),
    (3, 0.25): _Measured(0.675, 0.00225, 9.9830),
}
_PAPER_SHAPE = {2: "square", 3: "cube"}


def peclet(shear_rate: Numbers, radius: Numbers, diffusivity: Numbers) -> Numbers:
    """Pe = |rate| a^2 / D_0, the paper's eq. 18: how much faster the flow displaces a body than diffusion.

    The number hangs on what a and D_0 are. The paper's, and ours: a is the body's effective radius by the radial
    distribution function (Table 1), D_0 the diffusivity of one such body alone in the solvent (Table 2; in the
    paper's periodic box, not corrected for its size). Any a and D_0 in consistent units will do, arrays too.
    """
    return plain(np.abs(shear_rate) * np.square(radius) / diffusivity)


def dimensionless(configuration: Configuration, pressure: float | None = None) -> Dimensionless:
    """The dimensionless numbers of a run. pressure: measured, total, positive in compression; or None.

    With bodies of several shapes the numbers are those of the largest.
    """
    fluid = configuration.fluid
    rate = abs(configuration.flow.shear_rate)
    viscosity = _viscosity(configuration)
    sound_speed = _sound_speed(configuration, pressure)
    if not configuration.bodies:
        none = Quantity(None, "no bodies")
        return Dimensionless(None, None, None, None, none, none, viscosity, sound_speed)

    radius, largest = max(
        ((_radius(configuration, bodies), bodies) for bodies in configuration.bodies),
        key=lambda pair: pair[0].value or 0.0,
    )
    diffusivity = _diffusivity(configuration, largest, radius, viscosity)
    speed = _product(rate, radius.value)
    momentum = _product(fluid.density * fluid.mass, speed)
    sheared = rate > 0.0
    return Dimensionless(
        peclet=_peclet(rate, radius, diffusivity) if sheared else None,
        reynolds=_ratio(_product(momentum, configuration.box.size[1]), viscosity.value) if sheared else None,
        particle_reynolds=_ratio(_product(momentum, radius.value), viscosity.value) if sheared else None,
        mach=_ratio(speed, sound_speed.value) if sheared else None,
        radius=radius,
        diffusivity=diffusivity,
        viscosity=viscosity,
        sound_speed=sound_speed,
    )


def _peclet(rate: float, radius: Quantity, diffusivity: Quantity) -> float | None:
    if radius.value is None or not diffusivity.value:
        return None
    return float(peclet(rate, radius.value, diffusivity.value))


def _radius(configuration: Configuration, bodies: Bodies) -> Quantity:
    if configuration.reference.radius is not None:
        return Quantity(configuration.reference.radius, "given as reference.radius")
    stated = bodies.volume_in(configuration.dimension)
    if stated is not None:
        radius = _radius_of_volume(stated, configuration.dimension)
        return Quantity(radius, f"of the volume that the body counts for: {bodies.volume_source}")
    measured = _measured_body(configuration, bodies)
    if measured is not None:
        return Quantity(measured.radius, "the paper's Table 1, from the radial distribution function")
    volume = len(bodies.geometry.sites) / configuration.fluid.density
    return Quantity(
        _radius_of_volume(volume, configuration.dimension),
        "estimate: of the volume that as much solvent fills (the paper's bodies: 15 to 40 % high)",
    )


def _radius_of_volume(volume: float, dimension: int) -> float:
    """Radius of the disc or sphere of a volume."""
    return math.sqrt(volume / math.pi) if dimension == 2 else math.cbrt(0.75 * volume / math.pi)


def _viscosity(configuration: Configuration) -> Quantity:
    fluid = configuration.solvent
    if configuration.reference.viscosity is not None:
        return Quantity(configuration.reference.viscosity, "given as reference.viscosity")
    measured = _measured_fluid(configuration)
    if measured is not None and measured.viscosity is not None:
        if configuration.dimension == 2:
            return Quantity(measured.viscosity, "measured of this fluid alone, 3.090 +- 0.023 at shear rate 0.2")
        return Quantity(measured.viscosity, "the paper's Table 2, measured of this fluid alone")
    if fluid.gamma == 0.0:
        return Quantity(None, "no friction: kinetic theory has no value (give reference.viscosity)")
    value = kinetic.viscosity(
        density=fluid.density,
        friction=fluid.gamma,
        temperature=fluid.temperature,
        dimension=configuration.dimension,
        exponent=fluid.exponent,
        cutoff=fluid.cutoff,
        mass=fluid.mass,
    )
    return Quantity(float(value), "estimate: kinetic theory without repulsion (the paper's fluid: 2 to 11 % low)")


def _diffusivity(configuration: Configuration, bodies: Bodies, radius: Quantity, viscosity: Quantity) -> Quantity:
    if configuration.reference.diffusivity is not None:
        return Quantity(configuration.reference.diffusivity, "given as reference.diffusivity")
    measured = _measured_body(configuration, bodies)
    if measured is not None and measured.diffusivity is not None:
        if configuration.dimension == 2:
            return Quantity(measured.diffusivity, "the Pe of the paper's figure 10, read back by eq. 18 (to about 3 %)")
        return Quantity(measured.diffusivity, "the paper's Table 2, from the mean square displacement")
    if configuration.dimension == 2:
        return Quantity(None, "2D has no Stokes-Einstein relation (give reference.diffusivity)")
    if radius.value is None or viscosity.value is None:
        return Quantity(None, "Stokes-Einstein needs the solvent's viscosity (give reference.viscosity)")
    value = diffusion.stokes_einstein_diffusivity(
        temperature=configuration.fluid.temperature, viscosity=viscosity.value, radius=radius.value
    )
    return Quantity(float(value), "estimate: Stokes-Einstein, kT / (6 pi eta a) (the paper's cubes: 12 to 24 % low)")


def _sound_speed(configuration: Configuration, pressure: float | None) -> Quantity:
    fluid = configuration.solvent
    if configuration.reference.sound_speed is not None:
        return Quantity(configuration.reference.sound_speed, "given as reference.sound_speed")
    if pressure is not None and math.isfinite(pressure):
        # Solvent and constituents repel alike (or nearly so), so all particles count, with their mean mass.
        constituents = [
            (count * len(bodies.geometry.sites), mass)
            for count, bodies, mass in zip(
                configuration.body_counts, configuration.bodies, configuration.body_masses, strict=True
            )
        ]
        particles = configuration.solvent_count + sum(count for count, _ in constituents)
        mass = configuration.solvent_count * fluid.mass + sum(count * each for count, each in constituents)
        value = float(
            equation_of_state.sound_speed_from_pressure(
                pressure=pressure,
                density=particles / configuration.box.volume,
                temperature=fluid.temperature,
                mass=mass / particles,
            )
        )
        if math.isfinite(value):
            return Quantity(value, "the measured pressure, its part beyond n kT taken to go as n^2 (isothermal)")
    value = float(
        equation_of_state.sound_speed(
            density=fluid.density,
            temperature=fluid.temperature,
            repulsion=fluid.repulsion,
            dimension=configuration.dimension,
            cutoff=fluid.cutoff,
            mass=fluid.mass,
        )
    )
    if configuration.dimension == 2:
        return Quantity(value, "estimate: mean-field equation of state (isothermal; about 3 % high)")
    return Quantity(value, "estimate: Groot and Warren's equation of state (isothermal; 3 to 5 % high)")


def _measured_fluid(configuration: Configuration) -> _Measured | None:
    """The paper's measurements, if the solvent is one of its fluids."""
    fluid, dimension = configuration.solvent, configuration.dimension
    is_paper = all(
        math.isclose(ours, papers, rel_tol=1e-9)
        for ours, papers in (
            (fluid.density, 4.0),
            (fluid.repulsion, 18.75),
            (fluid.sigma, 3.0),
            (fluid.exponent, 0.5),
            (fluid.cutoff, 1.0),
            (fluid.mass, 1.0),
        )
    )
    return _PAPER.get((dimension, fluid.temperature)) if is_paper else None


def _measured_body(configuration: Configuration, bodies: Bodies) -> _Measured | None:
    """The paper's measurements, if these are its bodies in one of its fluids."""
    is_paper = (
        bodies.shape == _PAPER_SHAPE[configuration.dimension]
        and bodies.spacing == 0.25
        and configuration.pair_parameters().is_uniform
    )
    return _measured_fluid(configuration) if is_paper else None


def _product(first: float | None, second: float | None) -> float | None:
    return None if first is None or second is None else first * second


def _ratio(numerator: float | None, denominator: float | None) -> float | None:
    return None if numerator is None or not denominator else numerator / denominator
