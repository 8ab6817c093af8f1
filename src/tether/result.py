"""Result: the means of a run with their errors, and what to think of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether import derived
from tether.analysis.oscillatory import Moduli
from tether.caution import warnings_of
from tether.config import Configuration
from tether.estimate import Estimate, estimate, estimate_function
from tether.measurement import Freedom, pairwise_stress, total_stress
from tether.observe.observer import Observer
from tether.observe.profiles import Profiles
from tether.theory.dimensionless import Dimensionless, dimensionless
from tether.version import __version__

if TYPE_CHECKING:
    from tether.analysis.green_kubo import GreenKubo

_TEMPERATURES = {
    "all": "temperature",
    "solvent": "temperature_solvent",
    "constituents": "temperature_constituents",
    "body_translation": "temperature_body_translation",
}
"""Kinetic temperatures that are series of their own."""


@dataclass(frozen=True)
class Performance:
    """How fast the run was."""

    seconds: float
    particle_steps: float
    threads: int
    instruction_set: str
    """Of the pair loop; empty for the reference engine."""

    @property
    def particle_steps_per_second(self) -> float:
        """Particles times steps over seconds of wall-clock time, equilibration included."""
        return self.particle_steps / self.seconds if self.seconds > 0 else math.nan


@dataclass(frozen=True)
class Result:
    """What a run measured. Quantities that do not exist (N2 in 2D, a viscosity at rest) are None.

    Stress is positive in tension; S_xy is the x-force through a plane normal to y; all in reduced units.
    """

    configuration: Configuration
    series: xr.Dataset
    """Samples over time: variables with labelled dimensions, see `tether.measurement.series`."""
    freedom: Freedom
    steps: int
    """Measured steps: as configured, or fewer if [measure] stop_when was met before."""
    observers: Mapping[str, Observer]
    """What [measure] asked for, by the names of its tables."""
    momentum_drift: float
    """Largest change of a component of the total momentum against the imposed profile, per particle."""
    performance: Performance
    state_sha256: str
    """SHA-256 of the final positions, velocities, forces, bases, offset of the box and step."""

    @cached_property
    def stress(self) -> NDArray[np.float64]:
        """Total stress over time: kinetic + conservative + dissipative + body; shape (n, d, d)."""
        return self._without_flow(total_stress(self.series))

    @cached_property
    def stress_pairwise(self) -> NDArray[np.float64]:
        """Kinetic + conservative + dissipative stress over time (the paper's eq. 16); shape (n, d, d)."""
        return self._without_flow(pairwise_stress(self.series))

    @cached_property
    def _flow_energy(self) -> dict[str, float]:
        """Twice the kinetic energy of the measured profile of a driven flow; empty for other flows.

        The series has velocities against the imposed profile, and a driven flow has none.
        """
        profiles = self.observers.get("profiles")
        is_driven = self.configuration.flow.is_driven and isinstance(profiles, Profiles)
        return profiles.flow_energy() if is_driven and isinstance(profiles, Profiles) else {}

    @property
    def flow_is_known(self) -> bool:
        """Whether the profile of a driven flow has been measured."""
        return bool(self._flow_energy)

    def _without_flow(self, stress: xr.DataArray) -> NDArray[np.float64]:
        """Stress whose kinetic part is that about the measured profile."""
        values = np.array(stress.values)
        values[:, 0, 0] += self._flow_energy.get("all", 0.0) / self.configuration.box.volume
        return values

    def _temperature_over_time(self, of: str) -> NDArray[np.float64] | None:
        """A kinetic temperature about the measured profile, shape (n,); None if there is no such group."""
        name = _TEMPERATURES[of]
        if name not in self.series:
            return None
        moving = self._flow_energy.get("constituents" if of == "body_translation" else of, 0.0)
        return self._values(name) - moving / float(getattr(self.freedom, of))

    @cached_property
    def stress_with_noise(self) -> NDArray[np.float64]:
        """Total stress with its random term over time, for what fluctuations tell; shape (n, d, d)."""
        return self.stress + self._values("stress_random")

    @cached_property
    def observed(self) -> dict[str, xr.Dataset]:
        """What observers found, by the names of their tables in [measure]."""
        found = {name: observer.dataset() for name, observer in self.observers.items()}
        return {name: dataset for name, dataset in found.items() if dataset is not None}

    @cached_property
    def datasets(self) -> dict[str, xr.Dataset]:
        """The same, and the functions that the series tells of: a file each in the run's folder."""
        return derived.datasets(self)

    @cached_property
    def fluctuations(self) -> GreenKubo | None:
        """The viscosity by Green and Kubo with its spectrum, of a run at rest that asks for it."""
        return derived.of_fluctuations(self)

    @cached_property
    def response(self) -> Moduli | None:
        """The moduli, of a run under oscillating shear."""
        return derived.of_oscillation(self)

    @cached_property
    def derived(self) -> dict[str, Estimate]:
        """Means that not every run has: other routes to the viscosity, moduli, diffusion, sizes."""
        return derived.estimates(self)

    @cached_property
    def viscosity(self) -> Estimate | None:
        """S_xy / shear rate of the total stress: the suspension's viscosity."""
        return self._viscosity(self.stress)

    @cached_property
    def viscosity_pairwise(self) -> Estimate | None:
        """The same without the stress in the bodies' bases: what the paper plots."""
        return self._viscosity(self.stress_pairwise)

    @cached_property
    def viscosity_random(self) -> Estimate | None:
        """The random forces' share, which is zero on average and in no other mean."""
        return self._viscosity(self._values("stress_random"))

    @cached_property
    def pressure(self) -> Estimate:
        """p = -tr(S)/d of the total stress."""
        return estimate(self.over_time["pressure"])

    @cached_property
    def N1(self) -> Estimate:  # noqa: N802
        """First normal stress difference S_xx - S_yy of the total stress."""
        return estimate(self.over_time["N1"])

    @cached_property
    def N2(self) -> Estimate | None:  # noqa: N802
        """Second normal stress difference S_yy - S_zz of the total stress; None in 2D."""
        return estimate(self.over_time["N2"]) if self.configuration.dimension == 3 else None

    @cached_property
    def temperature(self) -> dict[str, Estimate | None]:
        """Kinetic temperatures: all, solvent, constituents, body_translation, body_rotation.

        With rigid bodies also constituents_raw, as if their constituents were free: no temperature, but in use.
        """
        over_time = {of: self._temperature_over_time(of) for of in _TEMPERATURES}
        found: dict[str, Estimate | None] = {
            of: estimate(values) if values is not None else None for of, values in over_time.items()
        }
        found["body_rotation"] = self._rotation_temperature()
        if "temperature_constituents_raw" in self.series:
            found["constituents_raw"] = estimate(self._values("temperature_constituents_raw"))
        return found

    @cached_property
    def over_time(self) -> dict[str, NDArray[np.float64]]:
        """What must be stationary, by name: samples over time, shape (n,) each."""
        stress = self.stress
        found = {
            f"temperature of {of.replace('_', ' ')}": values
            for of in _TEMPERATURES
            if (values := self._temperature_over_time(of)) is not None
        }
        found["pressure"] = -np.trace(stress, axis1=1, axis2=2) / self.configuration.dimension
        found["N1"] = stress[:, 0, 0] - stress[:, 1, 1]
        if self.configuration.dimension == 3:
            found["N2"] = stress[:, 1, 1] - stress[:, 2, 2]
        if self.configuration.flow.shear_rate != 0:
            found["viscosity"] = stress[:, 0, 1] / self.configuration.flow.shear_rate
        return found

    @cached_property
    def dimensionless(self) -> Dimensionless:
        """Peclet, Reynolds and Mach numbers, with the sizes that they used."""
        return dimensionless(self.configuration, self.pressure.value)

    @property
    def strain(self) -> float:
        """Total strain of the measured steps, forth and back counted alike."""
        timestep = self.configuration.run.timestep
        if "shear_rate" in self.series:
            interval = self.configuration.series_interval * timestep
            return float(np.abs(self.series["shear_rate"].values).sum() * interval)
        return abs(self.configuration.flow.shear_rate) * timestep * self.steps

    @cached_property
    def warnings(self) -> list[str]:
        """What stands against these means, a sentence each."""
        return warnings_of(self)

    def as_dict(self) -> dict[str, Any]:
        """What summary.json holds; None for numbers that do not exist."""
        configuration = self.configuration
        quantities = {name: _entry(e) for name, e in self.estimates.items()}
        temperatures = {of: quantities.pop(f"temperature of {of.replace('_', ' ')}") for of in self.temperature}
        return {
            "version": __version__,
            "seed": configuration.seed,
            "dimension": configuration.dimension,
            "particles": {
                "solvent": configuration.solvent_count,
                "constituents": configuration.constituent_count,
                "bodies": sum(configuration.body_counts),
                "volume_fraction": configuration.volume_fraction,
                "volume_fraction_from": list(configuration.volume_fraction_sources),
                "particle_fraction": configuration.particle_fraction,
                "mass_fraction": configuration.mass_fraction,
            },
            "flow": configuration.flow.kind,
            "steps": self.steps,
            "shear_rate": configuration.flow.shear_rate,
            "strain": self.strain,
            "temperature": temperatures,
            **quantities,
            "momentum_drift": _finite(self.momentum_drift),
            "statistical_inefficiency": {
                name: _finite(e.inefficiency * configuration.series_interval) if e is not None else None
                for name, e in self.estimates.items()
                if name not in self.derived
            },
            "dimensionless": self.dimensionless.as_dict(),
            "warnings": self.warnings,
            "performance": {
                "particle_steps_per_second": _finite(self.performance.particle_steps_per_second),
                "seconds": self.performance.seconds,
                "threads": self.performance.threads,
                "engine": configuration.run.engine,
                "precision": configuration.run.pair_precision,
                "instruction_set": self.performance.instruction_set or None,
            },
            "state_sha256": self.state_sha256,
        }

    @property
    def estimates(self) -> dict[str, Estimate | None]:
        """All means, by name."""
        temperatures = {f"temperature of {of.replace('_', ' ')}": e for of, e in self.temperature.items()}
        return {
            **temperatures,
            "pressure": self.pressure,
            "viscosity": self.viscosity,
            "viscosity_pairwise": self.viscosity_pairwise,
            "viscosity_random": self.viscosity_random,
            "N1": self.N1,
            "N2": self.N2,
            **self.derived,
        }

    def _values(self, name: str) -> NDArray[np.float64]:
        return np.asarray(self.series[name].values, dtype=np.float64)

    def _viscosity(self, stress: NDArray[np.float64]) -> Estimate | None:
        rate = self.configuration.flow.shear_rate
        return estimate(stress[:, 0, 1] / rate) if rate != 0 else None

    def _rotation_temperature(self) -> Estimate | None:
        """(<L . omega> - <L> . <I>^-1 <L>) / degrees of freedom, sums over all bodies.

        With s = <I>^-1 <L>, the mean spin of the bodies weighted with their inertia, this is the mean of
        (L - I s) . I^-1 . (L - I s): what is left of the rotation when the mean spin is taken out.
        """
        if "spin" not in self.series or self.freedom.body_rotation == 0:
            return None
        momentum = self._values("angular_momentum")
        turns = momentum.shape[1]
        inertia = self._values("inertia").reshape(len(momentum), turns * turns)
        columns = np.hstack([self._values("spin_energy")[:, None], momentum, inertia])

        def temperature(means: NDArray[np.float64]) -> float:
            energy, total, flat = np.split(means, [1, 1 + turns])
            spin = np.linalg.lstsq(flat.reshape(turns, turns), total)[0]  # one rod has no inertia about its line
            return float(energy[0] - total @ spin) / self.freedom.body_rotation

        return estimate_function(temperature, columns)


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None


def _entry(estimate: Estimate | None) -> dict[str, float | None] | None:
    return None if estimate is None else estimate.as_dict()
