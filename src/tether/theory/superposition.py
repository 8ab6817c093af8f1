"""What a body's constituents at their sites do to a particle near by (the paper's figures 3 and 4).

With r_i the distance of a point from site i, e_i the unit vector from the site to the point, e_o that from the
body's center (the mean of its sites) to the point, and the sums over the sites nearer than r_c:

    summed_repulsion = sum of a (1 - r_i/r_c)              figure 3, the superposed shape functions
    radial_repulsion = sum of a (1 - r_i/r_c) e_i . e_o    figure 4, radial part of the conservative force

Both are forces, in the unit of a; the second is positive where the particle is pushed outward. It is minus the
slope along e_o of the energy, the sum of a r_c/2 (1 - r_i/r_c)^2; the first is no component of a force and no
energy. anisotropy tells how far either is from round.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tether.theory.arrays import Numbers, plain


class Field(Protocol):
    """summed_repulsion, radial_repulsion, or a function like them."""

    def __call__(
        self, points: NDArray[np.float64], sites: NDArray[np.float64], *, repulsion: float, cutoff: float
    ) -> Numbers: ...


def summed_repulsion(
    points: NDArray[np.float64], sites: NDArray[np.float64], *, repulsion: float = 1.0, cutoff: float = 1.0
) -> Numbers:
    """Sum over sites of a (1 - r_i/r_c), force. points: (..., d), sites: (p, d), lengths; result: (...)."""
    _, distance = _from_sites(points, sites)
    return plain(np.sum(_force(distance, repulsion, cutoff), axis=-1))


def radial_repulsion(
    points: NDArray[np.float64], sites: NDArray[np.float64], *, repulsion: float = 1.0, cutoff: float = 1.0
) -> Numbers:
    """Sum over sites of a (1 - r_i/r_c) e_i . e_o, force, positive outward. Shapes as summed_repulsion.

    Zero at the body's center, which has no outward; a particle upon a site is not pushed by that site.
    """
    separation, distance = _from_sites(points, sites)
    outward = _unit(np.asarray(points, dtype=np.float64) - np.mean(sites, axis=0))
    projection = np.sum(_unit(separation) * outward[..., None, :], axis=-1)  # e_i . e_o
    return plain(np.sum(_force(distance, repulsion, cutoff) * projection, axis=-1))


def anisotropy(
    radius: Numbers,
    sites: NDArray[np.float64],
    *,
    field: Field = radial_repulsion,
    cutoff: float = 1.0,
    directions: int = 720,
) -> Numbers:
    """(greatest - least)/mean of a field over all directions at a distance from the body's center; no unit.

    0 is round. nan where the mean is 0, out of reach of the sites. The directions are spread evenly: equal
    angles in 2D, a golden spiral in 3D. radius: a number or an array (length); the result has its shape.
    """
    circle = _directions(sites.shape[-1], directions)
    points = np.mean(sites, axis=0) + np.multiply.outer(np.asarray(radius, dtype=np.float64), circle)
    value = np.asarray(field(points, sites, repulsion=1.0, cutoff=cutoff))
    mean = np.mean(value, axis=-1)
    spread = np.ptp(value, axis=-1)
    return plain(np.divide(spread, mean, out=np.full_like(mean, math.nan), where=mean != 0.0))


def _from_sites(
    points: NDArray[np.float64], sites: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Vectors (..., p, d) and distances (..., p) from the sites to the points."""
    separation = np.asarray(points, dtype=np.float64)[..., None, :] - np.asarray(sites, dtype=np.float64)
    return separation, np.linalg.norm(separation, axis=-1)


def _force(distance: NDArray[np.float64], repulsion: float, cutoff: float) -> NDArray[np.float64]:
    reach: NDArray[np.float64] = np.maximum(1.0 - distance / cutoff, 0.0)
    return repulsion * reach


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """vector/|vector|; zero where that is 0."""
    length = np.asarray(np.linalg.norm(vector, axis=-1, keepdims=True), dtype=np.float64)
    return np.divide(vector, length, out=np.zeros_like(vector), where=length > 0.0)


def _directions(dimension: int, count: int) -> NDArray[np.float64]:
    if dimension == 2:
        angle = 2.0 * math.pi * np.arange(count) / count
        return np.column_stack([np.cos(angle), np.sin(angle)])
    height = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(count)  # by the golden angle
    across = np.sqrt(1.0 - height**2)
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), height])
