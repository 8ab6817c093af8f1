"""Which observers a configuration asks for."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tether.config import Configuration
from tether.measurement import freedom_of_constituents
from tether.observe.displacement import Displacement
from tether.observe.observer import Observer
from tether.observe.profiles import Profiles
from tether.observe.radial_distribution import RadialDistribution
from tether.observe.stress_profile import StressProfile
from tether.theory import kinetic


def observers_of(configuration: Configuration, rotational: Sequence[int]) -> dict[str, Observer]:
    """New observers by name: the name of their table in [measure], and of the file that their results go to.

    rotational: rotational degrees of freedom of one body of each kind.
    """
    measure, size = configuration.measure, configuration.box.size
    kinds = configuration.species_names[1:]
    found: dict[str, Observer] = {}
    if (profiles := configuration.profiles) is not None:
        found["profiles"] = Profiles(
            profiles.bins, profiles.every, size, kinds,
            driven=configuration.flow.is_driven, freedom=_freedom(configuration, rotational),
        )  # fmt: skip
    if (stress := measure.stress_profile) is not None:
        found["stress_profile"] = StressProfile(stress.bins, stress.every, size)
    if (functions := measure.radial_distribution) is not None:
        found["radial_distribution"] = RadialDistribution(
            functions.every, kinds=kinds, bin_width=functions.width, reach=configuration.radial_range
        )
    if (displacement := measure.displacement) is not None:
        found["displacement"] = Displacement(
            displacement.every,
            configuration.dimension,
            configuration.solvent_count,
            dict(zip(kinds, configuration.body_counts, strict=True)),
            solvent_sample=displacement.solvent,
            driven=configuration.flow.is_driven,
            least_lag=2 * _time_around_the_box(configuration),
        )
    return found


def _freedom(configuration: Configuration, rotational: Sequence[int]) -> NDArray[np.float64]:
    """Degrees of freedom of each particle over d; constituents of a body share those that they have together."""
    parts = [np.ones(configuration.solvent_count)]
    of_one = freedom_of_constituents(configuration, rotational)
    for shape, count, freedom in zip(configuration.geometries, configuration.body_counts, of_one, strict=True):
        sites = len(shape.sites)
        parts.append(np.full(count * sites, freedom / (configuration.dimension * sites)))
    return np.concatenate(parts)


def _time_around_the_box(configuration: Configuration) -> float:
    """L^2/(4 pi^2 nu), in which momentum diffuses along the longest side L; 0 without friction.

    nu is that of kinetic theory, which is too small, and so the time too long, by a tenth or so.
    """
    fluid = configuration.solvent
    if fluid.gamma == 0:
        return 0.0
    viscosity = kinetic.viscosity(
        density=fluid.density, friction=fluid.gamma, temperature=fluid.temperature, mass=fluid.mass,
        dimension=configuration.dimension, exponent=fluid.exponent, cutoff=fluid.cutoff,
    )  # fmt: skip
    diffusivity = float(viscosity) / (fluid.density * fluid.mass)
    return max(configuration.box.size) ** 2 / (4 * math.pi**2 * diffusivity)
