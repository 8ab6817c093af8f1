"""The solvent: the parameters of the DPD law and of its thermostat."""

from __future__ import annotations

import math
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from tether.model import Model, exactly_one


class Fluid(Model):
    """A DPD fluid (Groot & Warren 1997), in reduced units of mass, length and energy.

    The force on i from j along e_ij, with r in units of the cutoff r_c and w_D = (1 - r)^s, is
    a (1 - r) - gamma w_D (e_ij . v_ij) + sigma sqrt(w_D) theta_ij / sqrt(dt), where sigma^2 = 2 gamma kT.
    """

    density: float = Field(
        default=4.0,
        gt=0,
        examples=[4.0],
        description="Number density of the solvent, in units of 1 / volume (1 / area in 2D). It is counted over "
        "the whole box and is not lowered when bodies are added.",
    )
    repulsion: float = Field(
        default=18.75,
        ge=0,
        examples=[18.75],
        description="Repulsion a between two particles, in units of energy / length. The conservative force "
        "is a (1 - r/r_c); every pair feels it, solvent and constituents of bodies alike.",
    )
    noise: float | None = Field(
        default=None,
        ge=0,
        examples=[3.0],
        json_schema_extra={"default": 3.0},
        description="Amplitude sigma of the random force, in units of force * time^(1/2). Give noise or "
        "friction, the other follows from sigma^2 = 2 gamma kT; without either, noise = 3.0. Zero is no "
        "thermostat.",
    )
    friction: float | None = Field(
        default=None,
        ge=0,
        examples=[4.5],
        description="Friction gamma of the dissipative force, in units of mass / time. Give noise or "
        "friction, the other follows from sigma^2 = 2 gamma kT. Zero is no thermostat.",
    )
    temperature: float = Field(
        gt=0,
        examples=[1.0],
        description="Thermal energy kT, in units of energy. Initial velocities are drawn at it and, through "
        "sigma^2 = 2 gamma kT, friction and noise hold it.",
    )
    exponent: float = Field(
        default=0.5,
        gt=0,
        examples=[0.5],
        description="Exponent s of the dissipative weight w_D = (1 - r/r_c)^s, a pure number. The random "
        "force has the weight sqrt(w_D).",
    )
    cutoff: float = Field(
        default=1.0, gt=0, examples=[1.0], description="Range r_c of the pair forces, in units of length."
    )
    mass: float = Field(
        default=1.0, gt=0, examples=[1.0], description="Mass of one solvent particle, in units of mass."
    )
    random: Literal["uniform", "gaussian"] = Field(
        default="uniform",
        description="Distribution of the pair noise theta_ij, which has mean 0 and variance 1. Uniform is "
        "faster; both give the same physics.",
    )

    @model_validator(mode="before")
    @classmethod
    def _default_noise(cls, values: Any) -> Any:
        """Without noise and friction, the noise is the one of the paper."""
        if isinstance(values, dict) and values.get("noise") is None and values.get("friction") is None:
            return {**values, "noise": 3.0}
        return values

    @model_validator(mode="after")
    def _one_amplitude(self) -> Self:
        exactly_one(self, "noise", "friction", "sigma^2 = 2 gamma kT makes one from the other")
        return self

    @property
    def sigma(self) -> float:
        """Amplitude of the random force, given or from sigma^2 = 2 gamma kT."""
        if self.noise is not None:
            return self.noise
        assert self.friction is not None
        return math.sqrt(2 * self.friction * self.temperature)

    @property
    def gamma(self) -> float:
        """Friction, given or from sigma^2 = 2 gamma kT."""
        if self.friction is not None:
            return self.friction
        assert self.noise is not None
        return self.noise**2 / (2 * self.temperature)
