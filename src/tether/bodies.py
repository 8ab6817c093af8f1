"""Bodies: how many, of which shape, and how their constituents are held."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from tether import shapes
from tether.errors import InputError
from tether.model import Model, exactly_one, fault, validated_in_place
from tether.shapes import MOST_SITES, Shape

Site = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)]


class Bodies(Model):
    """Bodies of one shape: DPD particles, their constituents, tethered by springs to sites of a rigid base.

    In Python the shape may be an object: `Bodies(cube(0.25), count=512)`.
    """

    shape: Literal["triangle", "square", "polygon", "octahedron", "cube", "points"] = Field(
        default="cube",
        description="Shape made by the sites. Two-dimensional: triangle, square, polygon (with sides); "
        "three-dimensional: octahedron, cube; either: points.",
    )
    spacing: float | None = Field(
        default=None,
        gt=0,
        examples=[0.25],
        json_schema_extra={"default": 0.25},
        description="Distance between nearest sites, in units of length. It is the side of a polygon and "
        "the edge of a cube or octahedron, 0.25 if not given; points have none.",
    )
    sides: int | None = Field(
        default=None,
        ge=3,
        le=MOST_SITES,
        examples=[6],
        description="Number of sides of a polygon. Only for it.",
    )
    points: tuple[Site, ...] | None = Field(
        default=None,
        strict=False,
        min_length=2,
        max_length=MOST_SITES,
        examples=[[[0.0, 0.0], [0.25, 0.0], [0.5, 0.0]]],
        description='Places of the sites of a body of the shape "points", in units of length. The origin '
        "does not matter.",
    )
    count: int | None = Field(
        default=None,
        ge=1,
        le=10**9,
        examples=[512],
        description="Number of bodies. Give count or volume_fraction.",
    )
    volume_fraction: float | None = Field(
        default=None,
        gt=0,
        lt=1,
        examples=[0.2],
        description="Volume fraction phi = constituents of these bodies / (all constituents + solvent), a pure "
        "number. It is the definition of the paper, eq. 42-43, for small bodies; the number of bodies is rounded.",
    )
    model: Literal["tethered"] = Field(
        default="tethered", description="How constituents are held. Tethered: by one spring each to its site."
    )
    base: Literal["massless", "newton-euler", "newton-euler-lagged"] = Field(
        default="massless",
        description="How the rigid base moves. Massless: the rigid placement that fits the constituents "
        "best, at every step; newton-euler: by the DPD forces on its constituents (the paper's algorithm); "
        "newton-euler-lagged: by those of the step before.",
    )
    torque_arms: Literal["constituents", "sites"] | None = Field(
        default=None,
        json_schema_extra={"default": "constituents"},
        description="Where the DPD forces act when their torque on a Newton-Euler base is taken. Only for "
        'those bases, "constituents" if not given.',
    )
    stiffness: float = Field(
        default=3000.0,
        gt=0,
        examples=[3000.0],
        description="Stiffness H of a spring, in units of energy / length^2. The force is -H times the stretch.",
    )
    mass: float = Field(default=1.0, gt=0, examples=[1.0], description="Mass of one constituent, in units of mass.")

    @validated_in_place
    def __init__(self, shape: str | Shape = "cube", **values: Any) -> None:
        super().__init__(shape=shape, **values)

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, values: Any) -> Any:
        """A Shape object becomes the keys that describe it; defaults that hang on another key are set."""
        if not isinstance(values, dict):
            return values
        values = _described(values)
        if values.get("shape", "cube") != "points" and values.get("spacing") is None:
            values["spacing"] = 0.25
        if str(values.get("base")).startswith("newton-euler") and values.get("torque_arms") is None:
            values["torque_arms"] = "constituents"
        return values

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        self._only_with("sides", self.shape == "polygon", "only a polygon has a free number of sides", "polygon")
        self._only_with("points", self.shape == "points", "this shape has sites of its own", "points")
        if self.shape == "points" and self.spacing is not None:
            why = "the points say where the sites are"
            raise fault("spacing", f'= {self.spacing!r} does not go with shape = "points"', why, "take it out")
        if self.torque_arms is not None and self.base == "massless":
            why = "a massless base feels no torque"
            raise fault("torque_arms", 'does not go with base = "massless"', why, "take it out")
        exactly_one(self, "count", "volume_fraction", "one makes the other, with the box and the density")
        try:
            _ = self.geometry
        except InputError as error:
            raise fault("points", error.problem.removeprefix("points "), error.why, error.remedy) from None
        return self

    def _only_with(self, name: str, fits: bool, why: str, shape: str) -> None:
        given = getattr(self, name) is not None
        if given and not fits:
            remedy = f'take it out, or give shape = "{shape}"'
            raise fault(name, f'does not go with shape = "{self.shape}"', why, remedy)
        if fits and not given:
            example = type(self).model_fields[name].examples
            assert example is not None
            raise fault(
                name,
                "is missing",
                f'shape = "{shape}" needs it',
                f"give it, for example {name} = {example[0]}",
            )

    @property
    def geometry(self) -> Shape:
        """The shape's sites, about their centroid."""
        if self.points is not None:
            return shapes.points(self.points)
        assert self.spacing is not None
        if self.sides is not None:
            return shapes.polygon(self.sides, self.spacing)
        fixed = {
            "triangle": shapes.triangle,
            "square": shapes.square,
            "octahedron": shapes.octahedron,
            "cube": shapes.cube,
        }
        return fixed[self.shape](self.spacing)

    @property
    def longest_timestep(self) -> float:
        """The time step 2 sqrt(m/H) at which velocity Verlet of a spring becomes unstable."""
        return 2 * math.sqrt(self.mass / self.stiffness)


def _described(values: dict[str, Any]) -> dict[str, Any]:
    shape = values.get("shape")
    if not isinstance(shape, Shape):
        return dict(values)
    described: dict[str, Any] = {"shape": shape.name, "spacing": shape.spacing}
    if shape.name == "polygon":
        described["sides"] = len(shape.sites)
    if shape.name == "points":
        described = {"shape": "points", "points": shape.sites.tolist()}
    for name in ("spacing", "sides", "points"):
        if values.get(name) is not None:
            raise fault(name, "is given beside a Shape object", "the object has it already", "take it out")
    return {**values, **described}
