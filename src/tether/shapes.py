"""Shapes of bodies: the sites that constituents are tethered to, about their centroid."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.special import ellipeinc

from tether.errors import InputError

Sites = npt.NDArray[np.float64]

MOST_SITES = 1000
"""The most sites that one body may have."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A rigid arrangement of sites.

    name: one of triangle, square, polygon, octahedron, cube, points, disc, sphere, ellipsoid, rod, single.
    sites: float64 array (sites, dimension), read-only, in units of length; their mean is the origin.
    spacing: distance between nearest sites, in units of length; about it where sites fill a body; 0 of a single one.
    keys: what else the shape was made from, by the names that it has in [[bodies]].
    """

    name: str
    sites: Sites
    spacing: float
    keys: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.sites.setflags(write=False)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return int(self.sites.shape[1])

    @property
    def radius(self) -> float:
        """Largest distance of a site from the centroid, in units of length."""
        return float(np.linalg.norm(self.sites, axis=1).max())


def triangle(spacing: float = 0.25) -> Shape:
    """Three sites at the corners of an equilateral triangle of side `spacing`; a disc (paper, fig. 1)."""
    return Shape("triangle", polygon(3, spacing).sites, spacing)


def square(spacing: float = 0.25) -> Shape:
    """Four sites at the corners of a square of side `spacing`, along the axes; a disc (paper, fig. 1)."""
    return Shape("square", _corners(2, _positive(spacing)), spacing)


def polygon(sides: int, spacing: float = 0.25) -> Shape:
    """Sites at the corners of a regular polygon with sides as long as `spacing`; one corner is up (+y)."""
    if isinstance(sides, bool) or not isinstance(sides, int | np.integer) or not 3 <= sides <= MOST_SITES:
        raise InputError(
            f"a polygon of {sides} sides cannot be made",
            "each corner is a site",
            f"give a whole number of sides from 3 to {MOST_SITES}",
            key=("sides",),
        )
    circumradius = _positive(spacing) / (2 * math.sin(math.pi / sides))
    angle = math.pi / 2 + 2 * math.pi * np.arange(sides) / sides
    sites = circumradius * np.column_stack([np.cos(angle), np.sin(angle)])
    return Shape("polygon", sites, spacing, {"sides": int(sides)})


def octahedron(spacing: float = 0.25) -> Shape:
    """Six sites at the corners of an octahedron of edge `spacing`, on the axes; a sphere (paper, fig. 1)."""
    axes = np.eye(3) * _positive(spacing) / math.sqrt(2)
    return Shape("octahedron", np.concatenate([axes, -axes]), spacing)


def cube(spacing: float = 0.25) -> Shape:
    """Eight sites at the corners of a cube of edge `spacing`, along the axes; a sphere (paper, fig. 1)."""
    return Shape("cube", _corners(3, _positive(spacing)), spacing)


def disc(radius: float, spacing: float = 0.25) -> Shape:
    """A filled disc: concentric rings of sites, `spacing` apart from the outermost, at `radius`, inwards.

    A ring has as many sites as bring neighbors closest to `spacing` apart, 0.85 to 1.2 of it. In the middle is one
    site, up to 1.5 spacings from its ring, unless that ring is narrower than 1.5 spacings.
    """
    radius = _length(radius, "radius", spacing)
    sites = _filled((radius, radius), spacing, "radius", radius)
    return Shape("disc", sites, float(spacing), {"radius": radius})


def sphere(radius: float, spacing: float = 0.25) -> Shape:
    """A filled sphere: concentric shells of sites, `spacing` apart from the outermost, at `radius`, inwards.

    The sites of a shell are those of an icosahedron whose edges are divided evenly, thrown onto the sphere: 10 f^2 + 2
    sites for edges in f parts, the nearest 0.75 to 1.25 spacings apart. An icosahedron turns into itself in so many
    ways that any symmetric tensor made from its sites is a number times the unit tensor: the inertia is isotropic, to
    rounding. A shell narrower than 1.5 spacings is an octahedron, which has that property too. In the middle is one
    site, up to 1.5 spacings from its shell, unless that shell is so narrow.
    """
    radius = _length(radius, "radius", spacing)
    sites = _filled((radius, radius, radius), spacing, "radius", radius)
    return Shape("sphere", sites, float(spacing), {"radius": radius})


def ellipsoid(semiaxes: Sequence[float], spacing: float = 0.25) -> Shape:
    """A filled ellipsoid along the axes, of rings (two semiaxes, an ellipse) or shells (three).

    The semiaxes of each layer are `spacing` shorter than those of the one around it, down to the line or the plane in
    the middle, which is filled alike. The sites of a ring have equal arcs between them. A shell is cut into such rings
    along the axis that differs most from the others; three equal semiaxes make a sphere().
    Nearest sites are 0.4 to 1.2 spacings apart where no semiaxis is more than three times another.
    """
    if not isinstance(semiaxes, Sequence | np.ndarray) or isinstance(semiaxes, str) or len(semiaxes) not in (2, 3):
        raise InputError(
            f"semiaxes = {semiaxes!r} are refused",
            "an ellipse has two and an ellipsoid three",
            "give as many numbers, for example [1.0, 0.5, 0.5]",
            key=("semiaxes",),
        )
    lengths = tuple(_length(length, "semiaxes", spacing) for length in semiaxes)
    sites = _filled(lengths, spacing, "semiaxes", list(lengths))
    return Shape("ellipsoid", sites, float(spacing), {"semiaxes": lengths})


def rod(length: float, spacing: float = 0.25, dimension: int = 3) -> Shape:
    """Sites on a line along x, from end to end `length` long, as near to `spacing` apart as divides it evenly."""
    if dimension not in (2, 3):
        raise InputError(f"there is no rod in {dimension!r} dimensions", "", "give 2 or 3")
    length = _length(length, "length", spacing)
    if length / spacing > MOST_SITES:
        raise _too_many_sites("length", length, length / spacing, spacing)
    count = round(length / spacing) + 1
    if count > MOST_SITES:
        raise _too_many_sites("length", length, count, spacing)
    sites = np.zeros((count, dimension))
    sites[:, 0] = length * (np.arange(count) - (count - 1) / 2) / (count - 1)
    return Shape("rod", sites, float(spacing), {"length": length})


def single(dimension: int) -> Shape:
    """The one site of a body that is a single particle."""
    return Shape("single", np.zeros((1, dimension)), 0.0)


def points(coordinates: npt.ArrayLike) -> Shape:
    """Sites at given places, moved so that their mean is the origin.

    coordinates: array (sites, dimension), in units of length.

    Raises InputError unless there are at least 2 sites, all different and finite, in 2 or 3 dimensions.
    """
    sites = _array(coordinates)
    sites = sites - sites.mean(axis=0)
    distances = np.array([_distances(sites, site).min() for site in range(len(sites))])
    if distances.min() == 0:
        first = int(distances.argmin())
        second = int(_distances(sites, first).argmin())
        raise _bad_points(f"puts sites {first} and {second} in one place", "give every site a place of its own")
    return Shape("points", sites, float(distances.min()))


def _array(coordinates: Any) -> Sites:
    try:
        sites = np.array(coordinates, dtype=np.float64)
    except (TypeError, ValueError):
        raise _bad_points("is not a table of numbers", "give as many numbers for each site") from None
    if sites.ndim != 2 or sites.shape[1] not in (2, 3):
        raise _bad_points("has sites that are not of 2 or of 3 numbers", "give [x, y] or [x, y, z] for each site")
    if not 2 <= len(sites) <= MOST_SITES:
        raise _bad_points(f"has {len(sites)} sites", f"give from 2 to {MOST_SITES} sites")
    # Squares of distances have to stay finite.
    if not np.all(np.abs(sites) < 1e100):
        raise _bad_points("has a number that is not finite or absurdly large", "give the sites in units of length")
    return sites


def _distances(sites: Sites, site: int) -> Sites:
    """Distances from one site to all; to itself, infinity."""
    distances: Sites = np.linalg.norm(sites - sites[site], axis=1)
    distances[site] = np.inf
    return distances


def _bad_points(problem: str, remedy: str) -> InputError:
    return InputError(f"points {problem}", "a body's sites are distinct points of space", remedy, key=("points",))


def _positive(spacing: float) -> float:
    number = isinstance(spacing, int | float | np.number) and not isinstance(spacing, bool)
    if not number or not 1e-30 <= spacing <= 1e30:
        raise InputError(
            f"spacing = {spacing!r} is refused",
            "it is the distance between nearest sites",
            "give a number greater than 0 (from 1e-30 to 1e30), for example 0.25",
            key=("spacing",),
        )
    return float(spacing)


def _corners(dimension: int, spacing: float) -> Sites:
    return np.array(list(itertools.product((-spacing / 2, spacing / 2), repeat=dimension)))


def _length(length: float, name: str, spacing: float) -> float:
    """A length of the shape, which has to have room for two sites."""
    spacing = _positive(spacing)
    number = isinstance(length, int | float | np.number) and not isinstance(length, bool)
    if not number or not spacing * (1 - 1e-12) <= length <= 1e30:
        raise InputError(
            f"{name} = {length!r} is refused" if not number else f"{name} = {length!r} is shorter than the spacing",
            f"sites are {spacing:g} apart",
            "give a longer one or a smaller spacing" if number else "give a number of at least the spacing",
            key=(name,),
        )
    return float(length)


def _too_many_sites(name: str, value: Any, count: float, spacing: float) -> InputError:
    return InputError(
        f"{name} = {value!r} makes {count:.6g} sites that are {spacing:g} apart",
        f"a body has at most {MOST_SITES}",
        "give a smaller body or a larger spacing",
        key=(name,),
    )


def _filled(semiaxes: tuple[float, ...], spacing: float, name: str, value: Any) -> Sites:
    """Layers of sites that fill an ellipse or ellipsoid; shape (sites, dimension)."""
    expected = math.prod(semiaxes) * math.pi * (1 if len(semiaxes) == 2 else 4 / 3) / spacing ** len(semiaxes)
    if expected > 2 * MOST_SITES:  # too many to count
        raise _too_many_sites(name, value, expected, spacing)
    sites = _layers(np.array(semiaxes), spacing)
    if len(sites) > MOST_SITES:
        raise _too_many_sites(name, value, len(sites), spacing)
    return sites


def _layers(semiaxes: Sites, spacing: float) -> Sites:
    """Surfaces of ellipsoids from the outermost inwards, then the plane, the line or the point that is left inside."""
    layers = []
    while semiaxes.min() >= spacing / 2:
        layers.append(_surface(semiaxes, spacing))
        semiaxes = semiaxes - spacing
    # What is left is flat. It would be nearer than 3/4 of a spacing to a layer that is still narrower than this.
    if semiaxes.min() >= -spacing / 4:
        long = np.arange(len(semiaxes)) != semiaxes.argmin()
        core = _layers(semiaxes[long], spacing) if long.any() else np.zeros((1, 0))
        layers.append(np.zeros((len(core), len(semiaxes))))
        layers[-1][:, long] = core
    return np.concatenate(layers)


def _surface(semiaxes: Sites, spacing: float) -> Sites:
    """Sites spread over the surface of an ellipsoid of 1, 2 or 3 dimensions; shape (sites, dimension)."""
    if len(semiaxes) == 1:
        return np.array([semiaxes, -semiaxes])
    is_round = np.ptp(semiaxes) <= 1e-12 * semiaxes.max()
    if len(semiaxes) == 2:
        return _circle(semiaxes[0], spacing) if is_round else _ellipse(semiaxes, spacing)
    return _geodesic(semiaxes[0], spacing) if is_round else _slices(semiaxes, spacing)


def _circle(radius: float, spacing: float) -> Sites:
    """At least three sites around a circle; the first is up (+y)."""
    count = max(3, round(2 * math.pi * radius / spacing))
    angle = math.pi / 2 + 2 * math.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def _ellipse(semiaxes: Sites, spacing: float) -> Sites:
    """An even number of sites around an ellipse, with equal arcs between them; the first is on the +x axis.

    Each has another one opposite and another one mirrored in the axes, so that the centroid is the origin and the axes
    are principal ones.
    """
    angle, arc = _quarter(semiaxes)
    half = max(2, round(2 * arc[-1] / spacing))  # sites on one half of the ellipse
    along = 2 * arc[-1] * np.arange(half) / half
    at = np.interp(np.minimum(along, 2 * arc[-1] - along), arc, angle)
    sign = np.where(along <= arc[-1], 1.0, -1.0)
    upper = semiaxes * np.column_stack([sign * np.cos(at), np.sin(at)])
    upper[np.abs(upper) < 1e-15 * semiaxes.max()] = 0.0
    return np.concatenate([upper, -upper])


def _quarter(semiaxes: Sites) -> tuple[Sites, Sites]:
    """Angles t from 0 to pi/2 of the points (a cos t, b sin t) of an ellipse, and the arcs from t = 0 to there."""
    angle = np.linspace(0, math.pi / 2, 2001)
    a, b = semiaxes
    # ds^2 = (a^2 sin^2 t + b^2 cos^2 t) dt^2; ellipeinc(t, m) is the integral of sqrt(1 - m sin^2 t).
    return angle, b * ellipeinc(angle, 1 - (a / b) ** 2)


def _slices(semiaxes: Sites, spacing: float) -> Sites:
    """Rings around an ellipsoid, and a site at each pole, with equal arcs between them along a mean meridian.

    The poles are on the longest axis or the shortest, whichever differs more from the middle one.
    """
    short, middle, long = np.argsort(semiaxes)
    pole = long if semiaxes[long] / semiaxes[middle] >= semiaxes[middle] / semiaxes[short] else short
    others = [axis for axis in range(3) if axis != pole]
    angle, arc = _quarter(np.array([semiaxes[pole], semiaxes[others].mean()]))
    parts = max(2, round(2 * arc[-1] / spacing))  # from pole to pole
    rings = []
    for part in range(parts // 2 + 1):
        at = float(np.interp(2 * arc[-1] * part / parts, arc, angle))
        ring = np.zeros((1, 3))
        if part > 0:
            around = _surface(semiaxes[others] * math.sin(at), spacing)
            ring = np.zeros((len(around), 3))
            ring[:, others] = around
        height = semiaxes[pole] * math.cos(at) * np.eye(3)[pole]
        rings += [ring] if 2 * part == parts else [ring + height, ring - height]
    return np.concatenate(rings)


def _geodesic(radius: float, spacing: float) -> Sites:
    """Sites of an icosahedron with its edges in equal parts, thrown onto a sphere; of an octahedron on a small one."""
    if radius < 0.75 * spacing:
        return radius * np.concatenate([np.eye(3), -np.eye(3)])
    golden = (1 + math.sqrt(5)) / 2
    corners = np.array([np.roll([0.0, y, z], turn) for turn in range(3) for y in (1, -1) for z in (golden, -golden)])
    # Corners of one edge are 2 apart, others at least 2 golden.
    joined = np.linalg.norm(corners[:, None] - corners, axis=2) < 2.5
    edges = [pair for pair in itertools.combinations(range(12), 2) if joined[pair]]
    faces = [
        trio for trio in itertools.combinations(range(12), 3) if all(joined[p] for p in itertools.combinations(trio, 2))
    ]
    # An edge is an arc of atan(2) = 63 degrees.
    parts = max(1, round(math.atan(2) * radius / spacing))
    on_edge = [(i, parts - i) for i in range(1, parts)]
    on_face = [(i, j, parts - i - j) for i in range(1, parts) for j in range(1, parts - i)]
    places = [corners]
    places += [np.array(on_edge) @ corners[list(edge)] for edge in edges if on_edge]
    places += [np.array(on_face) @ corners[list(face)] for face in faces if on_face]
    sites = np.concatenate(places)
    result: Sites = radius * sites / np.linalg.norm(sites, axis=1, keepdims=True)
    return result
