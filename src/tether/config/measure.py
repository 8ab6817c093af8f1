"""What is measured beside stress and temperature, and when a run is long enough."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from tether.config.output import Steps
from tether.model import Model, fault

Bins = Annotated[int, Field(ge=2, le=10_000)]


class Profiles(Model):
    """Number densities, velocity, temperature and particle fraction in bins across y."""

    bins: Bins = Field(default=20, examples=[20], description="Number of equal bins across the box in y.")
    every: Steps = Field(default=50, examples=[50], description="Steps between samples.")


class StressProfile(Model):
    """Stress in bins across y and through planes normal to y and to x; with it, the configurational temperature."""

    bins: Bins = Field(
        default=20,
        examples=[20],
        description="Number of equal bins across the box in y. There are as many planes, at their edges, and as many "
        "normal to x.",
    )
    every: Steps = Field(
        default=100, examples=[100], description="Steps between samples. A sample costs about as much as ten steps."
    )


class RadialDistribution(Model):
    """Radial distribution functions of solvent and bodies, effective sizes, and the bodies' pair distribution."""

    range: float | None = Field(
        default=None,
        gt=0,
        examples=[2.0],
        description="Largest distance, in units of length. If not given, 2 cutoffs beyond the largest body, or a third "
        "of the smallest side.",
    )
    width: float = Field(default=0.01, gt=0, examples=[0.01], description="Width of a bin, in units of length.")
    every: Steps = Field(
        default=200, examples=[200], description="Steps between samples. A sample costs as much as ten to twenty steps."
    )


class Displacement(Model):
    """Mean-square displacement, diffusion coefficients, velocity autocorrelation, rotational diffusion."""

    every: Steps = Field(
        default=50, examples=[50], description="Steps between samples: the shortest lag that is looked at."
    )
    solvent: int = Field(
        default=2000, ge=0, le=10**9, examples=[2000], description="How many solvent particles are followed, at most."
    )


class StopWhen(Model):
    """Relative standard errors at which the run ends before its number of steps."""

    viscosity: float | None = Field(
        default=None, gt=0, lt=1, examples=[0.01], description="Of the viscosity (total stress), a pure number."
    )
    viscosity_pairwise: float | None = Field(
        default=None, gt=0, lt=1, examples=[0.01], description="Of the pairwise viscosity, a pure number."
    )
    pressure: float | None = Field(
        default=None, gt=0, lt=1, examples=[0.001], description="Of the pressure, a pure number."
    )

    @property
    def targets(self) -> dict[str, float]:
        """The relative errors that were given, by the name of the quantity."""
        return {name: error for name in type(self).model_fields if (error := getattr(self, name)) is not None}

    @model_validator(mode="after")
    def _something(self) -> StopWhen:
        if not self.targets:
            raise fault((), "names no quantity", "a run stops for the error of one", "give {viscosity = 0.01}")
        return self


def _switch(given: Any) -> Any:
    """true is the table with its defaults, false is none."""
    if isinstance(given, bool):
        return {} if given else None
    return given


class Measure(Model):
    """What is measured beside stress and temperature: a table each, or true for its defaults.

    In a flow that is driven by a force, profiles are measured in any case.
    """

    profiles: Annotated[Profiles | None, BeforeValidator(_switch)] = Field(
        default=None, examples=[True], description="Profiles across y: a table, or true."
    )
    stress_profile: Annotated[StressProfile | None, BeforeValidator(_switch)] = Field(
        default=None, examples=[True], description="Stress across y and through planes: a table, or true."
    )
    radial_distribution: Annotated[RadialDistribution | None, BeforeValidator(_switch)] = Field(
        default=None, examples=[True], description="Radial distribution functions: a table, or true."
    )
    displacement: Annotated[Displacement | None, BeforeValidator(_switch)] = Field(
        default=None, examples=[True], description="Displacement and diffusion: a table, or true."
    )
    green_kubo: bool = Field(
        default=False,
        description="Whether the viscosity is also taken from the fluctuations of the stress. Only at rest.",
    )
    stop_when: StopWhen | None = Field(
        default=None,
        examples=[{"viscosity": 0.01}],
        description="End the run once these relative standard errors are reached. At the latest at its last step.",
    )
