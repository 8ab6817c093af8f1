"""What a run writes, and how often."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, field_validator, model_validator

from tether.model import Model, exactly_one, fault

Steps = Annotated[int, Field(ge=1, le=10**15)]


class Interval(Model):
    """How often something is written: every so many seconds of wall-clock time, or steps."""

    seconds: float | None = Field(
        default=None, gt=0, examples=[60.0], description="Seconds of wall-clock time. Give seconds or steps."
    )
    steps: Steps | None = Field(default=None, examples=[1000], description="Steps. Give seconds or steps.")

    @model_validator(mode="after")
    def _one_unit(self) -> Self:
        exactly_one(self, "seconds", "steps", "both would be two intervals")
        return self


def _bare_steps(given: Any) -> Any:
    """A bare whole number means steps."""
    return {"steps": given} if isinstance(given, int) and not isinstance(given, bool) else given


Every = Annotated[Interval, BeforeValidator(_bare_steps, json_schema_input_type=Interval | Steps)]


class Output(Model):
    """What a run writes, and how often."""

    checkpoint: Every = Field(
        default=Interval(seconds=60.0),
        examples=[{"seconds": 60.0}],
        description="Interval between checkpoints: {seconds = x}, {steps = n}, or n for steps.",
    )
    frames: Every | None = Field(
        default=None,
        examples=[{"steps": 1000}],
        description="Interval between frames of the trajectory: {seconds = x}, {steps = n}, or n for steps. "
        "If not given, chosen for about 100 frames.",
    )
    series: Steps | None = Field(
        default=None,
        examples=[10],
        description="Steps per sample of the series. Each sample is the mean over them; if not given, 10, "
        "or more in runs of over 500000 steps.",
    )
    fields: tuple[Literal["velocity", "mass", "body"], ...] = Field(
        default=("velocity",),
        strict=False,
        examples=[["velocity"]],
        description="What a frame holds besides position and species. Any of velocity, mass, body.",
    )

    @field_validator("fields")
    @classmethod
    def _no_repetition(cls, fields: tuple[str, ...]) -> tuple[str, ...]:
        for number, name in enumerate(fields):
            if name in fields[:number]:
                raise fault((number,), f'= "{name}" is there already', "a field is written once", "take it out")
        return fields
