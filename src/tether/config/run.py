"""How long a run is."""

from __future__ import annotations

import math
from typing import Literal, Self

from pydantic import Field, model_validator

from tether.model import Model, exactly_one

MOST_STEPS = 10**15
"""Beyond any run: a thousand steps a second for thirty thousand years."""


class Run(Model):
    """Time step and length of a run."""

    timestep: float = Field(gt=0, examples=[0.005], description="Time step dt, in units of time.")
    equilibration: int = Field(
        default=0,
        ge=0,
        le=MOST_STEPS,
        examples=[20000],
        description="Number of steps before anything is measured.",
    )
    steps: int | None = Field(
        default=None,
        ge=1,
        le=MOST_STEPS,
        examples=[100000],
        description="Number of measured steps. Give steps or strain.",
    )
    strain: float | None = Field(
        default=None,
        gt=0,
        examples=[20.0],
        description="Strain during the measured steps, |shear rate| * time, a pure number. Give steps or "
        "strain; it needs a flow that shears steadily.",
    )
    verlet_lambda: float = Field(
        default=0.5,
        ge=0,
        le=1,
        examples=[0.5],
        description="Parameter lambda of the modified velocity Verlet scheme of Groot & Warren, a pure "
        "number. It predicts the velocities that the dissipative force is calculated with.",
    )

    engine: Literal["cpu", "reference"] = Field(
        default="cpu",
        examples=["cpu"],
        description="What computes the pairs: cpu, with the widest vector instructions that the processor has, or "
        "reference, one pair after the other, to check the other one by.",
    )
    precision: Literal["mixed", "double"] | None = Field(
        default=None,
        examples=["mixed"],
        json_schema_extra={"default": "mixed"},
        description="Precision of the arithmetic within a pair: mixed (single precision there, everything else in "
        "double; momentum is conserved exactly) or double. The reference has only double.",
    )

    @model_validator(mode="after")
    def _precision_of_engine(self) -> Self:
        if self.engine == "reference" and self.precision == "mixed":
            raise ValueError(
                'precision = "mixed" does not go with engine = "reference" (it computes in double precision only); '
                "leave precision out"
            )
        return self

    @property
    def pair_precision(self) -> Literal["mixed", "double"]:
        """The precision as given, or that of the engine."""
        return self.precision or ("double" if self.engine == "reference" else "mixed")

    @model_validator(mode="after")
    def _one_length(self) -> Self:
        exactly_one(self, "steps", "strain", "strain = steps * timestep * |shear rate|")
        return self

    def step_count(self, shear_rate: float) -> int:
        """Measured steps: as given, or as many as the strain needs (the last may overshoot)."""
        if self.steps is not None:
            return self.steps
        assert self.strain is not None
        per_step = abs(shear_rate) * self.timestep
        if not per_step > self.strain / (2 * MOST_STEPS):
            return 2 * MOST_STEPS
        # 20 / (0.05 * 0.005) is 80000.00000000001 in floating point and means 80000.
        return max(1, math.ceil(self.strain / per_step * (1 - 1e-12)))
