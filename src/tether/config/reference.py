"""Known quantities that the dimensionless numbers are made with."""

from __future__ import annotations

from pydantic import Field

from tether.model import Model


class Reference(Model):
    """What the Peclet, Reynolds and Mach numbers use instead of tether's own values or estimates."""

    radius: float | None = Field(
        default=None, gt=0, examples=[0.605], description="Effective radius of a body, in units of length."
    )
    diffusivity: float | None = Field(
        default=None,
        gt=0,
        examples=[0.03],
        description="Diffusivity of one body alone in the solvent, in units of length^2 / time.",
    )
    viscosity: float | None = Field(
        default=None,
        gt=0,
        examples=[2.5],
        description="Viscosity of the solvent, in units of energy * time / volume (energy * time / area in 2D).",
    )
    sound_speed: float | None = Field(
        default=None, gt=0, examples=[5.4], description="Speed of sound, in units of length / time."
    )
