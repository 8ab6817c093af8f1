"""Configuration: everything that a run is made from, checked as a whole."""

from __future__ import annotations

import math
from typing import Any, Self

from pydantic import Field, model_validator

from tether import toml
from tether.bodies import SOLVENT, Bodies
from tether.box import Box
from tether.config import checks
from tether.config.checks import MOST_OF_A_CYCLE
from tether.config.measure import Measure, Profiles
from tether.config.output import Interval, Output
from tether.config.reference import Reference
from tether.config.run import Run
from tether.config.start import Start
from tether.flows import Flow, Kolmogorov, Oscillatory, Rest, Stages
from tether.fluid import Fluid
from tether.interactions import Interaction, PairParameters, pair_parameters
from tether.model import Model
from tether.shapes import Shape


class Configuration(Model):
    """A run of tether. All quantities are in reduced units of mass, length and energy (DPD units)."""

    seed: int = Field(
        default=0,
        ge=0,
        le=2**63 - 1,
        examples=[1],
        description="Seed of the pair noise, of the initial places and velocities. The same seed gives the same run.",
    )
    box: Box = Field(description="The periodic box.")
    fluid: Fluid = Field(description="The solvent and the DPD law of all particles.")
    bodies: tuple[Bodies, ...] = Field(
        default=(),
        strict=False,
        description="The suspended bodies, one [[bodies]] table a kind. None is a plain fluid.",
    )
    interactions: tuple[Interaction, ...] = Field(
        default=(),
        strict=False,
        description="Forces between two species that differ from the fluid's, one [[interactions]] table a pair of "
        "species. All other pairs have the law of [fluid].",
    )
    flow: Flow = Field(
        default=Rest(),
        description='The flow: kind = "rest", "couette", "oscillatory", "stages", "poiseuille" or "kolmogorov".',
    )
    run: Run = Field(description="Time step and length of the run.")
    start: Start = Field(default=Start(), description="Where the particles are at step 0.")
    measure: Measure = Field(default=Measure(), description="What is measured beside stress and temperature.")
    output: Output = Field(default=Output(), description="What is written while the run goes.")
    reference: Reference = Field(
        default=Reference(), description="Known quantities for the Peclet, Reynolds and Mach numbers."
    )

    @model_validator(mode="after")
    def _checked_as_a_whole(self) -> Self:
        checks.names(self.species_names, self.bodies)
        checks.interactions(self.interactions, self.species_names)
        cutoff = self.pair_parameters().largest_cutoff
        checks.sides(self.box, cutoff, self.interactions)
        checks.shapes(self.box, cutoff, self.bodies, self.geometries)
        checks.springs(self.run.timestep, self.bodies, self.body_masses)
        checks.length(self.run, self.flow, self.output)
        checks.unsteady(self.run, self.flow, self.series_interval)
        sites = [len(shape.sites) for shape in self.geometries]
        checks.numbers(self.solvent_count, self.box, self.bodies, self.body_counts, sites)
        checks.measure(self.measure, self.box, self.flow, self.radial_range)
        return self

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.box.dimension

    @property
    def solvent_count(self) -> int:
        """Number of solvent particles: density * volume, whatever the bodies."""
        return round(min(self.fluid.density * self.box.volume, 1e18))

    @property
    def species_names(self) -> tuple[str, ...]:
        """Names of the species: the solvent's, then one for each [[bodies]] table.

        A table without a name has its shape's, numbered from 1 where it comes twice.
        """
        unnamed = [bodies.species_name for bodies in self.bodies if bodies.name is None]
        names, seen = [SOLVENT], dict.fromkeys(unnamed, 0)
        for bodies in self.bodies:
            name = bodies.species_name
            if bodies.name is None:
                seen[name] += 1
                name = name if unnamed.count(name) == 1 else f"{name}_{seen[name]}"
            names.append(name)
        return tuple(names)

    def pair_parameters(self) -> PairParameters:
        """The law of every pair of species, the solvent first, then one for each [[bodies]] table."""
        return pair_parameters(self.fluid, self.species_names, self.interactions)

    @property
    def geometries(self) -> tuple[Shape, ...]:
        """The sites of one body, in the box's dimension, one shape for each [[bodies]] table."""
        return tuple(bodies.geometry_in(self.dimension) for bodies in self.bodies)

    @property
    def body_volumes(self) -> tuple[float | None, ...]:
        """Volume of one body of its effective size, length^dimension; None where particles are counted instead."""
        return tuple(bodies.volume_in(self.dimension) for bodies in self.bodies)

    @property
    def effective_radii(self) -> tuple[float | None, ...]:
        """Radius of the ball (in 2D the disc) of the volume of one body, length; None where particles are counted."""
        unit = 4 / 3 * math.pi if self.dimension == 3 else math.pi
        return tuple(v if v is None else (v / unit) ** (1 / self.dimension) for v in self.body_volumes)

    @property
    def body_masses(self) -> tuple[float, ...]:
        """Mass of one constituent, one for each [[bodies]] table, in units of mass.

        As given, or 1, or, of large bodies, such that a body is as heavy as the solvent of its volume:
        p m_C = n m V, with p constituents of mass m_C, and n and m the solvent's density and mass.
        """
        masses = []
        for bodies, shape, volume in zip(self.bodies, self.geometries, self.body_volumes, strict=True):
            if bodies.mass is not None:
                masses.append(bodies.mass)
            else:
                assert volume is not None
                masses.append(self.fluid.density * self.fluid.mass * volume / len(shape.sites))
        return tuple(masses)

    @property
    def body_counts(self) -> tuple[int, ...]:
        """Number of bodies, one for each [[bodies]] table.

        Where bodies count by volume, phi_k is their number times v_k / V: v_k of one body, V of the box. Where their
        constituents are counted, n_k in table k and n in all such tables, phi_k = n_k / (solvent + n). Summed over
        those of them with a phi_k: solvent + n = (solvent + constituents of the counted tables) / (1 - sum of phi_k).
        """
        by_particles = [
            (bodies, len(shape.sites))
            for bodies, shape, volume in zip(self.bodies, self.geometries, self.body_volumes, strict=True)
            if volume is None
        ]
        counted = sum(b.count * p for b, p in by_particles if b.count is not None)
        fraction = sum(b.volume_fraction for b, _ in by_particles if b.volume_fraction is not None)
        particles = (self.solvent_count + counted) / max(1 - fraction, 1e-9)
        counts = []
        for bodies, shape, volume in zip(self.bodies, self.geometries, self.body_volumes, strict=True):
            most = particles / len(shape.sites) if volume is None else min(self.box.volume / volume, 1e18)
            wanted = round((bodies.volume_fraction or 0.0) * most)
            counts.append(bodies.count if bodies.count is not None else wanted)
        return tuple(counts)

    @property
    def constituent_count(self) -> int:
        """Number of constituents of all bodies."""
        return sum(self._constituents)

    @property
    def _constituents(self) -> list[int]:
        return [count * len(shape.sites) for count, shape in zip(self.body_counts, self.geometries, strict=True)]

    @property
    def particle_fraction(self) -> float:
        """Constituents / (constituents + solvent), over all bodies: the paper's eq. 42, with the numbers as rounded."""
        return self.constituent_count / (self.constituent_count + self.solvent_count)

    @property
    def _mass_of_bodies(self) -> float:
        return sum(n * mass for n, mass in zip(self._constituents, self.body_masses, strict=True))

    @property
    def total_mass(self) -> float:
        """Mass of all particles, in units of mass."""
        return self.solvent_count * self.fluid.mass + self._mass_of_bodies

    @property
    def mass_fraction(self) -> float:
        """Mass of all bodies / mass of all particles: the paper's eq. 45, with the numbers as rounded."""
        return self._mass_of_bodies / self.total_mass

    @property
    def volume_fraction(self) -> float:
        """Volume fraction of all bodies, with the numbers as rounded.

        By particles, constituents / (constituents + solvent) of the paper's eq. 42-43, for the paper's shapes; plus by
        volume, bodies * volume / volume of the box, for those with an effective size. `volume_fraction_sources` says
        which is which.
        """
        by_particles, by_volume = 0, 0.0
        for count, sites, volume in zip(self.body_counts, self._constituents, self.body_volumes, strict=True):
            by_particles += sites if volume is None else 0
            by_volume += 0.0 if volume is None else count * volume
        of_particles = by_particles / (by_particles + self.solvent_count) if by_particles else 0.0
        return of_particles + by_volume / self.box.volume

    @property
    def volume_fraction_sources(self) -> tuple[str, ...]:
        """What the volume fraction of each [[bodies]] table is made from, in a few words."""
        return tuple(bodies.volume_source for bodies in self.bodies)

    @property
    def steps(self) -> int:
        """Number of measured steps, after equilibration."""
        return self.run.step_count(self.flow.shear_rate)

    @property
    def series_interval(self) -> int:
        """Steps per sample of the series: as given, or 10, or more so as to have 50000 samples at most.

        Of a flow in stages, the most up to that of which every stage and the equilibration are whole numbers; of an
        oscillating one, few enough for MOST_OF_A_CYCLE.
        """
        if self.output.series is not None:
            return self.output.series
        wanted = min(self.steps, max(10, -(-self.steps // 50_000)))
        if isinstance(self.flow, Stages):
            stages = [stage.steps(self.run.timestep) for stage in self.flow.stages]
            whole = math.gcd(*stages, self.run.equilibration)
            return max(n for n in range(1, wanted + 1) if whole % n == 0)
        if isinstance(self.flow, Oscillatory):
            return max(1, min(wanted, int(MOST_OF_A_CYCLE * self.flow.period / self.run.timestep)))
        return wanted

    @property
    def profiles(self) -> Profiles | None:
        """The profiles that are measured: as given, and in a driven flow in any case."""
        if self.measure.profiles is not None or not self.flow.is_driven:
            return self.measure.profiles
        periods = self.flow.periods if isinstance(self.flow, Kolmogorov) else 1
        return Profiles(bins=max(20, 8 * periods))

    @property
    def radial_range(self) -> float:
        """Range of radial distribution functions: as given, or two cutoffs beyond the largest body, room permitting."""
        functions = self.measure.radial_distribution
        if functions is not None and functions.range is not None:
            return functions.range
        hulls = [bodies.hull_in(self.dimension) for bodies in self.bodies]
        reach = 2 * self.pair_parameters().largest_cutoff + max(hulls, default=0.0)
        return min(reach, min(self.box.size) / 3)

    @property
    def solvent(self) -> Fluid:
        """The fluid with the law that two solvent particles have, which [[interactions]] may change."""
        pairs = self.pair_parameters()
        if pairs.is_uniform:
            return self.fluid
        return self.fluid.changed(
            repulsion=float(pairs.repulsion[0, 0]), noise=float(pairs.noise[0, 0]), friction=None,
            cutoff=float(pairs.cutoff[0, 0]),
        )  # fmt: skip

    @property
    def frame_interval(self) -> Interval:
        """Interval between frames: as given, or steps for about 100 frames."""
        return self.output.frames if self.output.frames is not None else Interval(steps=max(1, self.steps // 100))

    def plain_fluid(self) -> Configuration:
        """The same run without bodies."""
        of_solvent = tuple(each for each in self.interactions if set(each.between) == {SOLVENT})
        return self.changed(bodies=(), interactions=of_solvent)

    def resolved(self) -> Configuration:
        """The same run with the intervals of output, masses of constituents and laws of pairs written out."""
        return self.changed(
            output=self.output.changed(series=self.series_interval, frames=self.frame_interval),
            measure=self.measure.changed(profiles=self.profiles),
            bodies=tuple(b.changed(mass=mass) for b, mass in zip(self.bodies, self.body_masses, strict=True)),
            interactions=tuple(each.completed(self.fluid) for each in self.interactions),
        )

    def given(self) -> dict[str, Any]:
        """Every key that has a value, as plain tables: what makes this configuration again."""
        return _given(self.model_dump())

    def to_toml(self) -> str:
        """The resolved configuration as a TOML file, every key with its value; `load` reads it back."""
        return toml.document(self.resolved().given())


def _given(table: dict[str, Any]) -> dict[str, Any]:
    """Without the keys that have no value, and without tables that thereby have no key."""

    def cleaned(item: Any) -> Any:
        if isinstance(item, dict):
            return _given(item)
        return [cleaned(inner) for inner in item] if isinstance(item, list | tuple) else item

    return {name: cleaned(item) for name, item in table.items() if item is not None and cleaned(item) != {}}
