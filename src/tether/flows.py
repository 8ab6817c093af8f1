"""Flows that a run can impose."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field, field_validator

from tether.model import Model, fault

Heights = npt.NDArray[np.float64]


class Rest(Model):
    """No flow: the suspension at equilibrium."""

    kind: Literal["rest"] = Field(default="rest", description="No flow.")

    @property
    def shear_rate(self) -> float:
        """0, in units of 1 / time."""
        return 0.0

    def velocity(self, y: Heights, height: float) -> Heights:  # noqa: ARG002
        """Imposed velocity along x: 0 everywhere."""
        return np.zeros_like(y)


class Couette(Model):
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

    def velocity(self, y: Heights, height: float) -> Heights:
        """Imposed velocity along x, rate (y - height/2), at heights y of a box of that height."""
        return self.shear_rate * (y - 0.5 * height)


Flow = Annotated[Rest | Couette, Field(discriminator="kind")]
