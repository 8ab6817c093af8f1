"""Shapes: sites about their centroid, the right distances, refused nonsense."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import pdist

from tether.errors import InputError
from tether.shapes import Shape, cube, octahedron, points, polygon, square, triangle

SHAPES = [
    (triangle(0.3), 2, 3, 0.3 / np.sqrt(3), 3),
    (square(0.3), 2, 4, 0.3 / np.sqrt(2), 4),
    (polygon(5, 0.3), 2, 5, 0.15 / np.sin(np.pi / 5), 5),
    (polygon(40, 0.3), 2, 40, 0.15 / np.sin(np.pi / 40), 40),
    (octahedron(0.3), 3, 6, 0.3 / np.sqrt(2), 12),
    (cube(0.3), 3, 8, 0.15 * np.sqrt(3), 12),
]


@pytest.mark.parametrize(("shape", "dimension", "sites", "radius", "edges"), SHAPES)
def test_regular_shapes(shape: Shape, dimension: int, sites: int, radius: float, edges: int) -> None:
    assert shape.sites.shape == (sites, dimension)
    assert shape.sites.dtype == np.float64
    assert shape.dimension == dimension
    np.testing.assert_allclose(shape.sites.mean(axis=0), 0, atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(shape.sites, axis=1), radius, rtol=1e-14)
    np.testing.assert_allclose(shape.radius, radius, rtol=1e-14)
    distances = pdist(shape.sites)
    assert shape.spacing == 0.3
    np.testing.assert_allclose(distances.min(), 0.3, rtol=1e-13)
    assert np.count_nonzero(np.isclose(distances, 0.3, rtol=1e-12)) == edges


def test_points_are_centered_whatever_the_origin() -> None:
    rod = points([[5.0, 1.0], [6.0, 1.0], [8.0, 1.0], [9.0, 1.0]])
    assert np.array_equal(rod.sites, [[-2, 0], [-1, 0], [1, 0], [2, 0]])
    assert (rod.name, rod.spacing, rod.radius, rod.dimension) == ("points", 1.0, 2.0, 2)


def test_sites_are_read_only_and_not_the_caller_s() -> None:
    mine = np.array([[0.0, 0.0], [1.0, 0.0]])
    shape = points(mine)
    mine[0] = 7
    assert shape.sites[0, 0] == -0.5
    with pytest.raises(ValueError, match="read-only"):
        shape.sites[0, 0] = 1


@pytest.mark.parametrize("spacing", [0, -0.1, np.nan, np.inf, True, "0.25", None, 1e40])
@pytest.mark.parametrize("shape", [triangle, square, octahedron, cube, lambda spacing: polygon(5, spacing)])
def test_spacing_is_a_length(shape: object, spacing: object) -> None:
    with pytest.raises(InputError, match=r"^spacing = .* \(it is the distance between nearest sites\); give"):
        shape(spacing)


@pytest.mark.parametrize("sides", [2, 0, -3, 3.0, True, "6", 1001])
def test_a_polygon_has_corners(sides: object) -> None:
    with pytest.raises(InputError, match="give a whole number of sides from 3 to 1000"):
        polygon(sides, 0.25)


@pytest.mark.parametrize(
    ("coordinates", "problem"),
    [
        ([[0, 0]], "has 1 sites"),
        ([], "has sites that are not of 2 or of 3 numbers"),
        ([0, 1], "has sites that are not of 2 or of 3 numbers"),
        ([[0], [1]], "has sites that are not of 2 or of 3 numbers"),
        ([[0, 0, 0, 0], [1, 0, 0, 0]], "has sites that are not of 2 or of 3 numbers"),
        ([[0, 0], [1]], "is not a table of numbers"),
        ("square", "is not a table of numbers"),
        ([[0, 1], [1, 0], [0, 1]], "puts sites 0 and 2 in one place"),
        ([[0, 1], [1, 0], [1, 0], [0, 1]], "puts sites 0 and 3 in one place"),
        ([[0, np.nan], [1, 0]], "has a number that is not finite"),
        ([[0, np.inf], [1, 0]], "has a number that is not finite"),
        (np.zeros((1001, 2)), "has 1001 sites"),
    ],
)
def test_points_are_distinct_and_finite(coordinates: object, problem: str) -> None:
    with pytest.raises(InputError, match=rf"^points {problem}"):
        points(coordinates)
