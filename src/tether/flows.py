"""Flows that a run can impose: by the box, which shears at a rate that may change, or by a force on every particle."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field, field_validator

from tether.model import Model, fault

Heights = npt.NDArray[np.float64]


def imposed_velocity(shear_rate: float, y: Heights, height: float) -> Heights:
    """Velocity along x that the box imposes, shear_rate (y - height/2), at heights y of a box of that height."""
    return shear_rate * (y - 0.5 * height)


class _Flow(Model):
    """What flows have in common; unless they say otherwise the box is at rest and nothing drives."""

    @property
    def is_sheared(self) -> bool:
        """Whether the box shears, steadily or not."""
        return False

    @property
    def is_driven(self) -> bool:
        """Whether a force on every particle drives the flow."""
        return False

    def strain(self, steps: npt.ArrayLike, timestep: float) -> Heights:
        """Integral of the imposed shear rate over time from step 0 to the end of each of `steps`; of their shape."""
        del timestep
        return np.zeros(np.shape(steps))

    def driving_force(self, y: Heights, height: float) -> Heights:
        """Force along x on particles at heights y of a box of that height, before its mean over all is taken off."""
        del height
        return np.zeros_like(y)


class _Unsteady(_Flow):
    """A flow without a steady imposed shear."""

    @property
    def shear_rate(self) -> float:
        """Of a steady shear: 0, in units of 1 / time."""
        return 0.0


class _Driven(_Unsteady):
    """A flow that a force on every particle drives."""

    force: float

    @field_validator("force")
    @classmethod
    def _not_zero(cls, force: float) -> float:
        if force == 0:
            why = "the flow is driven by it"
            raise fault((), "= 0 drives nothing", why, 'give another, or the flow of kind "rest"')
        return force

    @property
    def is_driven(self) -> bool:
        """True."""
        return True


class Rest(_Unsteady):
    """No flow: the suspension at equilibrium."""

    kind: Literal["rest"] = Field(default="rest", description="No flow.")


class Couette(_Flow):
    """Plane shear at a constant rate, with mean velocity (rate (y - L_y/2), 0, 0), by Lees-Edwards boundaries."""

    kind: Literal["couette"] = Field(default="couette", description="Plane shear by Lees-Edwards boundaries.")
    shear_rate: float = Field(
        examples=[0.05],
        description="Shear rate d(v_x)/dy, in units of 1 / time. Of either sign, but not zero.",
    )

    @field_validator("shear_rate")
    @classmethod
    def _not_zero(cls, rate: float) -> float:
        if rate == 0:
            why = "the viscosity is the shear stress over the shear rate"
            raise fault((), "= 0 does not shear", why, 'give a rate other than 0, or the flow of kind "rest"')
        return rate

    @property
    def is_sheared(self) -> bool:
        """True."""
        return True

    def strain(self, steps: npt.ArrayLike, timestep: float) -> Heights:
        """shear_rate times the time since step 0."""
        return self.shear_rate * timestep * np.asarray(steps, dtype=np.float64)


class Oscillatory(_Unsteady):
    """Oscillating shear: the strain is amplitude sin(omega t), with t = 0 at step 0."""

    kind: Literal["oscillatory"] = Field(default="oscillatory", description="Oscillating shear.")
    strain_amplitude: float = Field(
        gt=0, examples=[0.5], description="Largest strain, a pure number; the moduli are linear ones if it is small."
    )
    angular_frequency: float = Field(
        gt=0, examples=[0.2], description="Angular frequency omega, in units of 1 / time. A cycle lasts 2 pi / omega."
    )

    @property
    def period(self) -> float:
        """2 pi / omega, in units of time."""
        return 2 * math.pi / self.angular_frequency

    @property
    def is_sheared(self) -> bool:
        """True."""
        return True

    def strain(self, steps: npt.ArrayLike, timestep: float) -> Heights:
        """strain_amplitude sin(omega t)."""
        time = np.asarray(steps, dtype=np.float64) * timestep
        return self.strain_amplitude * np.sin(self.angular_frequency * time)


class Stage(Model):
    """A time of constant shear rate."""

    shear_rate: float = Field(
        examples=[0.2], description="Shear rate, in units of 1 / time. Zero is rest; of either sign."
    )
    duration: float = Field(
        gt=0, examples=[10.0], description="How long it lasts, in units of time. It is rounded to whole steps."
    )

    def steps(self, timestep: float) -> int:
        """The duration in steps."""
        return round(self.duration / timestep)


class Stages(_Unsteady):
    """Shear in stages, each with a rate of its own: start-up, stop, reversal. After the last comes the first again."""

    kind: Literal["stages"] = Field(default="stages", description="Shear in stages, gone through again and again.")
    stages: tuple[Stage, ...] = Field(
        strict=False,
        min_length=1,
        max_length=1000,
        examples=[[{"shear_rate": 0.0, "duration": 5.0}, {"shear_rate": 0.2, "duration": 10.0}]],
        description="The stages in their order. Stress is averaged over the times that they are gone through.",
    )

    @property
    def is_sheared(self) -> bool:
        """Whether a stage has a rate other than 0."""
        return any(stage.shear_rate != 0 for stage in self.stages)

    def cycle(self, timestep: float) -> int:
        """Steps of all stages together."""
        return sum(stage.steps(timestep) for stage in self.stages)

    def strain(self, steps: npt.ArrayLike, timestep: float) -> Heights:
        """Sum of rates times durations; linear within a stage."""
        lengths = [stage.steps(timestep) for stage in self.stages]
        ends = np.concatenate([[0], np.cumsum(lengths)])
        gains = [stage.shear_rate * length * timestep for stage, length in zip(self.stages, lengths, strict=True)]
        strains = np.concatenate([[0.0], np.cumsum(gains)])
        cycles, place = np.divmod(np.asarray(steps, dtype=np.float64), ends[-1])
        return np.asarray(cycles * strains[-1] + np.interp(place, ends, strains))


class Poiseuille(_Driven):
    """Reverse Poiseuille flow (Backer et al. 2005, doi 10.1063/1.1883163): +force above L_y/2, -force below."""

    kind: Literal["poiseuille"] = Field(default="poiseuille", description="Two channels that flow in turn.")
    force: float = Field(examples=[0.1], description="Force g on every particle, in units of force. Not zero.")

    def driving_force(self, y: Heights, height: float) -> Heights:
        """g above half the height, -g below."""
        return np.where(y > 0.5 * height, self.force, -self.force)


class Kolmogorov(_Driven):
    """A force g sin(2 pi n y/L_y) along x on every particle."""

    kind: Literal["kolmogorov"] = Field(default="kolmogorov", description="A sinusoidal force across the box.")
    force: float = Field(
        examples=[0.1], description="Amplitude g of the force on every particle, in units of force. Not zero."
    )
    periods: int = Field(
        default=1, ge=1, le=1000, examples=[1], description="Number n of waves across the box, a whole number."
    )

    def driving_force(self, y: Heights, height: float) -> Heights:
        """g sin(2 pi n y/height)."""
        return np.asarray(self.force * np.sin(2 * math.pi * self.periods * y / height))


Flow = Annotated[Rest | Couette | Oscillatory | Stages | Poiseuille | Kolmogorov, Field(discriminator="kind")]
