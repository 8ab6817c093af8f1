"""Configuration: everything that a run is made from, checked as a whole."""

from __future__ import annotations

from typing import Any, Self

from pydantic import Field, model_validator

from tether import toml
from tether.bodies import Bodies
from tether.box import Box
from tether.config import checks
from tether.config.output import Interval, Output
from tether.config.reference import Reference
from tether.config.run import Run
from tether.config.start import Start
from tether.flows import Flow, Rest
from tether.fluid import Fluid
from tether.model import Model


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
    flow: Flow = Field(default=Rest(), description='The flow: kind = "rest" or "couette".')
    run: Run = Field(description="Time step and length of the run.")
    start: Start = Field(default=Start(), description="Where the particles are at step 0.")
    output: Output = Field(default=Output(), description="What is written while the run goes.")
    reference: Reference = Field(
        default=Reference(), description="Known quantities for the Peclet, Reynolds and Mach numbers."
    )

    @model_validator(mode="after")
    def _checked_as_a_whole(self) -> Self:
        checks.sides(self.box, self.fluid)
        checks.shapes(self.box, self.fluid, self.bodies)
        checks.springs(self.run.timestep, self.bodies)
        checks.length(self.run, self.flow, self.output)
        checks.numbers(self.solvent_count, self.bodies, self.body_counts)
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
    def body_counts(self) -> tuple[int, ...]:
        """Number of bodies, one for each [[bodies]] table.

        With n_k constituents in table k and n in all, phi_k = n_k / (solvent + n). Summed over the tables
        with a phi_k: solvent + n = (solvent + constituents of the counted tables) / (1 - sum of phi_k).
        """
        sites = [bodies.geometry.sites.shape[0] for bodies in self.bodies]
        counted = sum(b.count * p for b, p in zip(self.bodies, sites, strict=True) if b.count is not None)
        fraction = sum(b.volume_fraction for b in self.bodies if b.volume_fraction is not None)
        particles = (self.solvent_count + counted) / max(1 - fraction, 1e-9)
        return tuple(
            b.count if b.count is not None else round((b.volume_fraction or 0.0) * particles / p)
            for b, p in zip(self.bodies, sites, strict=True)
        )

    @property
    def constituent_count(self) -> int:
        """Number of constituents of all bodies."""
        counts = zip(self.bodies, self.body_counts, strict=True)
        return sum(count * bodies.geometry.sites.shape[0] for bodies, count in counts)

    @property
    def volume_fraction(self) -> float:
        """Constituents / (constituents + solvent): the paper's eq. 42-43, with the numbers as rounded."""
        return self.constituent_count / (self.constituent_count + self.solvent_count)

    @property
    def steps(self) -> int:
        """Number of measured steps, after equilibration."""
        return self.run.step_count(self.flow.shear_rate)

    @property
    def series_interval(self) -> int:
        """Steps per sample of the series: as given, or 10, or more so as to have 50000 samples at most."""
        chosen = min(self.steps, max(10, -(-self.steps // 50_000)))
        return self.output.series if self.output.series is not None else chosen

    @property
    def frame_interval(self) -> Interval:
        """Interval between frames: as given, or steps for about 100 frames."""
        return self.output.frames if self.output.frames is not None else Interval(steps=max(1, self.steps // 100))

    def plain_fluid(self) -> Configuration:
        """The same run without bodies."""
        return self.changed(bodies=())

    def resolved(self) -> Configuration:
        """The same run with the intervals of output written out."""
        return self.changed(output=self.output.changed(series=self.series_interval, frames=self.frame_interval))

    def to_toml(self) -> str:
        """The resolved configuration as a TOML file, every key with its value; `load` reads it back."""
        return toml.document(_given(self.resolved().model_dump()))


def _given(table: dict[str, Any]) -> dict[str, Any]:
    """Without the keys that have no value, and without tables that thereby have no key."""

    def cleaned(item: Any) -> Any:
        if isinstance(item, dict):
            return _given(item)
        return [cleaned(inner) for inner in item] if isinstance(item, list | tuple) else item

    return {name: cleaned(item) for name, item in table.items() if item is not None and cleaned(item) != {}}
