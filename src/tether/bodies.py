"""Bodies: how many, of which shape, how their constituents are held, and how much volume they count for."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import lru_cache
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from tether import shapes
from tether.errors import InputError
from tether.model import Model, exactly_one, fault, validated_in_place
from tether.shapes import MOST_SITES, Shape

Site = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)]
Length = Annotated[float, Field(gt=0)]

SOLVENT = "solvent"
"""The name of species 0."""

FILLED = ("disc", "sphere", "ellipsoid")
"""The shapes whose outermost sites enclose a volume, filled with sites."""

_NAME = r"[A-Za-z0-9_-]{1,60}"

_OF_RESULTS = ("angle", "axes", "bodies", "error", "plane", "rotational", "running", "velocity")
"""Words that names of results have where others have the name of a kind of bodies."""

_SHAPE_OF_KEY = {
    "sides": ("polygon",),
    "points": ("points",),
    "radius": ("disc", "sphere"),
    "length": ("rod",),
    "semiaxes": ("ellipsoid",),
}
"""The keys that only some shapes have, and need."""

_OF_SITES = ("shape", "spacing", "sides", "points", "length", "semiaxes")
"""The keys that a body of a single particle does not have."""

_OF_SPRINGS = ("base", "torque_arms", "stiffness")
"""The keys that only tethered bodies have."""


class Bodies(Model):
    """Bodies of one kind: DPD particles, their constituents, tethered to sites of a rigid base or fixed to them.

    In Python the shape may be an object: `Bodies(cube(0.25), count=512)`.
    """

    name: str | None = Field(
        default=None,
        min_length=1,
        examples=["colloid"],
        description="Name of the species that the constituents are. Files use it, and [[interactions]]; if not given, "
        'the shape\'s name, or "single", numbered where several tables have the same.',
    )
    model: Literal["tethered", "rigid", "single"] = Field(
        default="tethered",
        description="How constituents are held. Tethered: by one spring each to its site; rigid: at their sites of a "
        "body that moves as a whole (the frozen particle model); single: each body is one DPD particle.",
    )
    shape: (
        Literal[
            "triangle",
            "square",
            "polygon",
            "disc",
            "octahedron",
            "cube",
            "sphere",
            "ellipsoid",
            "rod",
            "points",
        ]
        | None
    ) = Field(
        default=None,
        json_schema_extra={"default": "cube"},
        description="Shape made by the sites. Two-dimensional: triangle, square, polygon (with sides), disc (with "
        "radius); three-dimensional: octahedron, cube, sphere (with radius); either: ellipsoid (with 2 or 3 semiaxes), "
        'rod (with length), points. "cube" if not given; a single particle has none.',
    )
    spacing: float | None = Field(
        default=None,
        gt=0,
        examples=[0.25],
        json_schema_extra={"default": 0.25},
        description="Distance between nearest sites, in units of length. It is the side of a polygon and "
        "the edge of a cube or octahedron; rings and shells of larger bodies, and their sites, are about so far apart; "
        "0.25 if not given. Points have none.",
    )
    sides: int | None = Field(
        default=None,
        ge=3,
        le=MOST_SITES,
        examples=[6],
        description="Number of sides of a polygon. Only for it.",
    )
    radius: float | None = Field(
        default=None,
        gt=0,
        examples=[1.0],
        description="Radius of a disc or sphere, in units of length. It is that of the outermost sites; of a single "
        "particle it is the effective radius. Only for these.",
    )
    semiaxes: tuple[Length, ...] | None = Field(
        default=None,
        strict=False,
        min_length=2,
        max_length=3,
        examples=[[1.0, 0.5, 0.5]],
        description="Semiaxes of the outermost sites of an ellipsoid, in units of length. Three numbers, or two for an "
        "ellipse in 2D. Only for it.",
    )
    length: float | None = Field(
        default=None,
        gt=0,
        examples=[1.0],
        description="Length of a rod from its first site to its last, in units of length. Only for it.",
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
    effective_radius: float | None = Field(
        default=None,
        gt=0,
        examples=[1.2],
        description="Radius with which the volume of a body is counted, in units of length. If given, the volume "
        "fraction of these bodies is number * volume / volume of the box: a sphere's volume (a disc's in 2D), or, of a "
        "rod, that of all points nearer to it. If not given, a disc, sphere or ellipsoid has the volume within its "
        "outermost sites, and other shapes count particles (eq. 42 of the paper).",
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
        description="Volume fraction phi, a pure number. Of discs, spheres, ellipsoids and single particles, and "
        "wherever effective_radius is given, number * volume / volume of the box; of others, the paper's eq. 42-43 for "
        "small bodies: constituents / (constituents + solvent). The number of bodies is rounded.",
    )
    base: Literal["massless", "newton-euler", "newton-euler-lagged"] | None = Field(
        default=None,
        json_schema_extra={"default": "massless"},
        description="How the rigid base of tethered bodies moves. Massless: the rigid placement that fits the "
        "constituents best, at every step; newton-euler: by the DPD forces on its constituents (the paper's "
        'algorithm); newton-euler-lagged: by those of the step before. "massless" if not given.',
    )
    torque_arms: Literal["constituents", "sites"] | None = Field(
        default=None,
        json_schema_extra={"default": "constituents"},
        description="Where the DPD forces act when their torque on a Newton-Euler base is taken. Only for "
        'those bases, "constituents" if not given.',
    )
    stiffness: float | None = Field(
        default=None,
        gt=0,
        examples=[3000.0],
        json_schema_extra={"default": 3000.0},
        description="Stiffness H of a spring, in units of energy / length^2. The force is -H times the stretch. Only "
        "for tethered bodies, 3000 if not given.",
    )
    mass: float | None = Field(
        default=None,
        gt=0,
        examples=[1.0],
        description="Mass of one constituent, in units of mass. If not given, discs, spheres, ellipsoids, single "
        "particles, and rods with an effective_radius are as heavy as the solvent of their volume; for others it is "
        "1.0.",
    )

    @validated_in_place
    def __init__(self, shape: str | Shape | None = None, **values: Any) -> None:
        super().__init__(shape=shape, **values)

    @model_validator(mode="before")
    @classmethod
    def _described(cls, values: Any) -> Any:
        """A Shape object becomes the keys that describe it."""
        return _described(values) if isinstance(values, dict) else values

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.name == SOLVENT:
            raise fault("name", f'= "{SOLVENT}" is taken', "the solvent has it", "give the bodies another name")
        if self.name is not None and self.name.partition("_")[0] in _OF_RESULTS:
            problem, why = f'= "{self.name}" could be taken for another result', "results are called by the name"
            raise fault("name", problem, why, "give another one, for example disc")
        if self.name is not None and not re.fullmatch(_NAME, self.name):
            problem, why = "is no plain word", "files, results and other tables use the name"
            raise fault("name", problem, why, "give at most 60 letters (a to z), digits, - or _")
        if self.model == "single":
            self._without(_OF_SITES, "a single particle has no sites")
            self._without(("effective_radius",), "the radius of a single particle is its effective one")
            if self.radius is None:
                raise self._missing("radius", 'model = "single"')
        else:
            self._keys_of_shape(self.shape or "cube")
        if self.model != "tethered":
            self._without(_OF_SPRINGS, "only tethered bodies have springs and a base")
        if self.torque_arms is not None and self.base in (None, "massless"):
            why = "a massless base feels no torque"
            raise fault("torque_arms", 'does not go with base = "massless"', why, "take it out")
        exactly_one(self, "count", "volume_fraction", "one makes the other, with the box and the density")
        return self

    @model_validator(mode="after")
    def _filled(self) -> Self:
        """Keys that were not given, and whose default hangs on another key, get it; they stay 'not given'."""
        # Assignment is refused, and would make the key a given one.
        values = self.__dict__
        if self.model != "single":
            values["shape"] = self.shape or "cube"
            if self.shape != "points" and self.spacing is None:
                values["spacing"] = 0.25
        if self.model == "tethered":
            values["base"] = self.base or "massless"
            values["stiffness"] = self.stiffness or 3000.0
            if self.base != "massless" and self.torque_arms is None:
                values["torque_arms"] = "constituents"
        if self.mass is None and not self.is_neutrally_buoyant:
            values["mass"] = 1.0
        try:
            _ = self.geometry
        except InputError as error:
            key = str(error.key[0])
            raise fault(key, error.problem.removeprefix(f"{key} "), error.why, error.remedy) from None
        return self

    def _keys_of_shape(self, shape: str) -> None:
        for name, fitting in _SHAPE_OF_KEY.items():
            given = getattr(self, name) is not None
            if given and shape not in fitting:
                remedy = "take it out, or give shape = " + " or ".join(f'"{each}"' for each in fitting)
                raise fault(name, f'does not go with shape = "{shape}"', _WHY_NOT[name], remedy)
            if shape in fitting and not given:
                raise self._missing(name, f'shape = "{shape}"')
        if shape == "points" and self.spacing is not None:
            why = "the points say where the sites are"
            raise fault("spacing", f'= {self.spacing!r} does not go with shape = "points"', why, "take it out")

    def _without(self, names: tuple[str, ...], why: str) -> None:
        for name in names:
            if getattr(self, name) is not None:
                raise fault(name, f'does not go with model = "{self.model}"', why, "take it out")

    def _missing(self, name: str, needing: str) -> PydanticCustomError:
        example = type(self).model_fields[name].examples
        assert example is not None
        return fault(name, "is missing", f"{needing} needs it", f"give it, for example {name} = {example[0]}")

    def hull_in(self, dimension: int) -> float:
        """The radius around a body's center within which its sites are; the effective one of a single particle."""
        own = self.radius if self.model == "single" else None
        return self.geometry_in(dimension).radius if own is None else own

    @property
    def species_name(self) -> str:
        """The name as given, or else the shape's; a configuration numbers names that come twice."""
        return self.name or self.shape or self.model

    @property
    def geometry(self) -> Shape:
        """The shape's sites, about their centroid. Rods and single particles, which fit any box, are put in 3D."""
        return self.geometry_in(3)

    def geometry_in(self, dimension: int) -> Shape:
        """The shape's sites, about their centroid; rods and single particles in so many dimensions."""
        shape = "single" if self.shape is None else self.shape
        size = self.sides or self.radius or self.length or self.semiaxes or self.points
        return _geometry(shape, size, self.spacing, dimension)

    @property
    def is_neutrally_buoyant(self) -> bool:
        """Whether a body is to be as heavy as the solvent of its volume: it is large, and no mass is given."""
        is_large = self.model == "single" or self.shape in FILLED
        return self.mass is None and (is_large or (self.shape == "rod" and self.effective_radius is not None))

    def volume_in(self, dimension: int) -> float | None:
        """Volume of one body of its effective size, length^dimension; None where particles are counted instead."""
        if self.effective_radius is not None:
            # All points within the radius of a rod: a cylinder and two half balls.
            around = 0.0 if self.length is None else self.length * _ball((self.effective_radius,) * (dimension - 1))
            return around + _ball((self.effective_radius,) * dimension)
        if self.radius is not None:
            return _ball((self.radius,) * dimension)
        return None if self.semiaxes is None else _ball(self.semiaxes)

    @property
    def volume_source(self) -> str:
        """What the volume fraction of these bodies is made from, in a few words."""
        if self.effective_radius is not None:
            return f"effective radius {self.effective_radius:g} (given)"
        if self.model == "single":
            return f"effective radius {self.radius:g} (given)"
        if self.radius is not None:
            return f"effective radius {self.radius:g} (outermost sites)"
        if self.semiaxes is not None:
            return f"semiaxes {', '.join(f'{length:g}' for length in self.semiaxes)} (outermost sites)"
        return "eq. 42"

    def longest_timestep(self, mass: float) -> float:
        """The time step 2 sqrt(m/H) at which velocity Verlet of a spring becomes unstable; infinity without springs.

        mass: of one constituent.
        """
        return math.inf if self.stiffness is None else 2 * math.sqrt(mass / self.stiffness)


_WHY_NOT = {
    "sides": "only a polygon has a free number of sides",
    "points": "this shape has sites of its own",
    "radius": "the spacing makes the size of this shape, or another key does",
    "length": "only a rod has a length",
    "semiaxes": "only an ellipsoid has semiaxes",
}


@lru_cache(maxsize=64)
def _geometry(shape: str, size: Any, spacing: float | None, dimension: int) -> Shape:
    """size: the value of the one key that only this shape has; None if there is no such key."""
    if shape == "single":
        return shapes.single(dimension)
    if shape == "points":
        return shapes.points(size)
    assert spacing is not None
    if shape == "rod":
        return shapes.rod(size, spacing, dimension)
    sized: dict[str, Callable[[Any, float], Shape]] = {
        "polygon": shapes.polygon,
        "disc": shapes.disc,
        "sphere": shapes.sphere,
        "ellipsoid": shapes.ellipsoid,
    }
    if shape in sized:
        return sized[shape](size, spacing)
    fixed = {
        "triangle": shapes.triangle,
        "square": shapes.square,
        "octahedron": shapes.octahedron,
        "cube": shapes.cube,
    }
    return fixed[shape](spacing)


def _ball(semiaxes: tuple[float, ...]) -> float:
    """Volume of a ball, ellipsoid, disc or ellipse, or length of the line between two points."""
    return {1: 2.0, 2: math.pi, 3: 4 / 3 * math.pi}[len(semiaxes)] * math.prod(semiaxes)


def _described(values: dict[str, Any]) -> dict[str, Any]:
    shape = values.get("shape")
    if not isinstance(shape, Shape):
        return values
    described: dict[str, Any] = {"shape": shape.name, "spacing": shape.spacing, **shape.keys}
    if shape.name == "points":
        described = {"shape": "points", "points": shape.sites.tolist()}
    for name in ("spacing", *_SHAPE_OF_KEY):
        if values.get(name) is not None:
            raise fault(name, "is given beside a Shape object", "the object has it already", "take it out")
    return {**values, **described}
