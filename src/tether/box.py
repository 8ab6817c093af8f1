"""The periodic box."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from tether.model import Model, validated_in_place


class Box(Model):
    """A periodic box: x is the flow, y the velocity gradient, z the vorticity; two sides make a 2D run.

    In Python: `Box(20, 20, 10)`.
    """

    size: tuple[Annotated[float, Field(gt=0)], ...] = Field(
        strict=False,
        min_length=2,
        max_length=3,
        examples=[[20.0, 20.0, 10.0]],
        description="Sides of the periodic box, in units of length. In the order x (flow), y (velocity "
        "gradient), z (vorticity); two numbers make a two-dimensional run. No side is shorter than three "
        "cutoffs.",
    )

    @validated_in_place
    def __init__(self, *sides: float, size: Sequence[float] | None = None) -> None:
        if sides and size is not None:
            raise TypeError("Box takes its sides one by one or as size=[...], not both")
        super().__init__(size=sides if size is None else size)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.size)

    @property
    def volume(self) -> float:
        """Volume of the box (area in 2D), in units of length^dimension."""
        return math.prod(self.size)
