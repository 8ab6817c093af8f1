"""Shapes of bodies: the sites that constituents are tethered to, about their centroid."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from tether.errors import InputError

Sites = npt.NDArray[np.float64]

MOST_SITES = 1000
"""The most sites that one body may have."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A rigid arrangement of sites.

    name: one of triangle, square, polygon, octahedron, cube, points.
    sites: float64 array (sites, dimension), read-only, in units of length; their mean is the origin.
    spacing: distance between nearest sites, in units of length.
    """

    name: str
    sites: Sites
    spacing: float

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
    return Shape("polygon", circumradius * np.column_stack([np.cos(angle), np.sin(angle)]), spacing)


def octahedron(spacing: float = 0.25) -> Shape:
    """Six sites at the corners of an octahedron of edge `spacing`, on the axes; a sphere (paper, fig. 1)."""
    axes = np.eye(3) * _positive(spacing) / math.sqrt(2)
    return Shape("octahedron", np.concatenate([axes, -axes]), spacing)


def cube(spacing: float = 0.25) -> Shape:
    """Eight sites at the corners of a cube of edge `spacing`, along the axes; a sphere (paper, fig. 1)."""
    return Shape("cube", _corners(3, _positive(spacing)), spacing)


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
