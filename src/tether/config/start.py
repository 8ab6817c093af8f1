"""How a run starts."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from tether.model import Model


class Start(Model):
    """The state that a run starts from."""

    bodies: Literal["lattice", "random"] = Field(
        default="lattice",
        description="Places of the bodies. Lattice: spread evenly; random: anywhere, hulls apart; both "
        "turned at random. Without meaning when a file is given.",
    )
    file: str | None = Field(
        default=None,
        min_length=1,
        examples=["equilibrated/trajectory.gsd"],
        description="GSD file to take the positions from, and the velocities if it has them. Relative to "
        "the folder of the configuration.",
    )
    frame: int = Field(
        default=-1,
        ge=-(2**63),
        le=2**63 - 1,
        examples=[-1],
        description="Frame of the file, counted from 0. Or from the end with -1, -2, ...",
    )
    gentle_steps: int = Field(
        default=200,
        ge=0,
        le=10**9,
        examples=[200],
        description="Number of steps with limited displacement before the run. They take overlaps apart and "
        "do not count as steps of it.",
    )
