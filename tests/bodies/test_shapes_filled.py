"""Bodies filled with sites: where the sites are, that they leave no holes, and what inertia they have."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial import ConvexHull, cKDTree

from tether.bodies import Bodies
from tether.engines.cpu import principal_sites
from tether.errors import InputError
from tether.shapes import Shape, disc, ellipsoid, rod, sphere

DISCS = [disc(radius) for radius in (0.25, 0.3, 0.37, 0.5, 0.7, 1.0, 1.3, 2.0, 3.0)]
SPHERES = [sphere(radius) for radius in (0.25, 0.3, 0.37, 0.5, 0.6, 0.7, 1.0, 1.1, 1.3, 1.4)]
ELLIPSOIDS = [
    ellipsoid(semiaxes)
    for semiaxes in (
        [1.0, 0.5],
        [0.5, 1.5],
        [2.0, 0.7],
        [1.0, 0.95],
        [1.0, 0.5, 0.5],
        [0.5, 0.5, 1.5],
        [1.0, 1.0, 0.5],
        [0.4, 1.2, 0.8],
        [1.0, 0.95, 0.9],
        [0.75, 0.25, 0.75],
    )
]
FILLED = [*DISCS, *SPHERES, *ELLIPSOIDS]


def name(shape: Shape) -> str:
    return f"{shape.name} {dict(shape.keys)}"


def semiaxes(shape: Shape) -> np.ndarray:
    return np.array(shape.keys.get("semiaxes", [shape.keys.get("radius")] * shape.dimension))


def nearest(points: np.ndarray) -> np.ndarray:
    """Distance of each point to the nearest other one."""
    return cKDTree(points).query(points, k=2)[0][:, 1]


def widest_hole(shape: Shape) -> float:
    """The largest distance, in spacings, of 20000 random points of a body from the nearest site."""
    random = np.random.default_rng(1)
    points = random.uniform(-1, 1, (20_000, shape.dimension))
    points = points[np.linalg.norm(points, axis=1) < 1] * semiaxes(shape)
    return cKDTree(shape.sites).query(points)[0].max() / shape.spacing


@pytest.mark.parametrize("shape", FILLED, ids=name)
def test_sites_are_centered_and_along_principal_axes(shape: Shape) -> None:
    np.testing.assert_allclose(shape.sites.mean(axis=0), 0, atol=1e-15)
    spread = shape.sites.T @ shape.sites
    assert np.abs(spread - np.diag(np.diag(spread))).max() <= 1e-15 * np.trace(spread)
    assert np.array_equal(principal_sites(shape), shape.sites)


@pytest.mark.parametrize("shape", FILLED, ids=name)
def test_the_outermost_sites_are_on_the_surface(shape: Shape) -> None:
    height = ((shape.sites / semiaxes(shape)) ** 2).sum(axis=1)
    assert height.max() == pytest.approx(1, rel=1e-14)
    surface = shape.sites[height > 1 - 1e-12]
    np.testing.assert_allclose(np.abs(surface).max(axis=0), semiaxes(shape), rtol=0.15)
    # A polyhedron of points on a curved surface has less than its volume; the more points, the closer.
    volume = Bodies(shape, count=1).volume_in(shape.dimension)
    enclosed = ConvexHull(surface).volume / volume
    assert 0.8 - 0.5 * (len(surface) < 20) < enclosed < 1


@pytest.mark.parametrize("shape", FILLED, ids=name)
def test_nearest_sites_are_about_a_spacing_apart(shape: Shape) -> None:
    distance = nearest(shape.sites) / shape.spacing
    assert 0.4 < distance.min() < 1.25
    assert distance.max() <= 1.5
    if shape.name != "ellipsoid":
        assert distance.min() > 0.75
        assert np.median(distance) == pytest.approx(1, abs=0.21)


@pytest.mark.parametrize("shape", FILLED, ids=name)
def test_there_are_no_holes(shape: Shape) -> None:
    """No place in a body is a spacing away from all sites: solvent that found room there would feel many of them."""
    assert widest_hole(shape) < 1.0


def test_an_empty_shell_has_a_hole() -> None:
    """The control of the test above."""
    full = sphere(1.0)
    shell = full.sites[np.linalg.norm(full.sites, axis=1) > 0.9]
    assert widest_hole(Shape("sphere", shell, 0.25, full.keys)) > 3.0


@pytest.mark.parametrize("shape", SPHERES, ids=name)
def test_a_sphere_s_inertia_is_isotropic(shape: Shape) -> None:
    """Every direction has a third of the trace, to rounding; so has each shell."""
    for shell in np.unique(np.linalg.norm(shape.sites, axis=1).round(9)):
        sites = shape.sites[np.isclose(np.linalg.norm(shape.sites, axis=1), shell, atol=1e-8)]
        spread = sites.T @ sites
        np.testing.assert_allclose(spread, np.eye(3) * np.trace(spread) / 3, atol=1e-14 * max(np.trace(spread), 1e-30))


def test_a_spheroid_is_a_symmetric_top() -> None:
    prolate = np.diag(ellipsoid([1.0, 0.5, 0.5]).sites.T @ ellipsoid([1.0, 0.5, 0.5]).sites)
    assert prolate[1] == pytest.approx(prolate[2], rel=1e-14)
    oblate = np.diag(ellipsoid([1.0, 1.0, 0.5]).sites.T @ ellipsoid([1.0, 1.0, 0.5]).sites)
    assert oblate[0] == pytest.approx(oblate[1], rel=1e-14)


@pytest.mark.parametrize("parts", [1, 2, 3, 4, 5])
def test_shells_are_divided_icosahedra(parts: int) -> None:
    """10 f^2 + 2 sites and 20 f^2 faces; an edge of the icosahedron is an arc of atan 2, divided into f."""
    sites = sphere(0.25 * parts).sites
    shell = sites[np.linalg.norm(sites, axis=1) > 0.25 * parts - 1e-9]
    frequency = round(math.atan(2) * parts)
    assert len(shell) == 10 * frequency**2 + 2
    assert len(ConvexHull(shell).simplices) == 20 * frequency**2


def test_rings_of_a_disc() -> None:
    """One site, then rings of 2 pi k sites, rounded: 6, 13, 19, 25."""
    distance = np.linalg.norm(disc(1.0).sites, axis=1)
    radii, count = np.unique(distance.round(9), return_counts=True)
    assert np.array_equal(radii, [0, 0.25, 0.5, 0.75, 1.0])
    assert np.array_equal(count, [1, 6, 13, 19, 25])


@pytest.mark.parametrize("axes", [[1.0, 0.5], [0.3, 0.9], [2.0, 1.9]])
def test_a_ring_of_an_ellipse_has_equal_arcs(axes: list[float]) -> None:
    """Arcs by quadrature of sqrt(a^2 sin^2 t + b^2 cos^2 t), to the 1e-5 of the table they were read from."""
    a, b = axes
    sites = ellipsoid(axes).sites
    ring = sites[((sites / axes) ** 2).sum(axis=1) > 1 - 1e-12]
    angle = np.sort(np.arctan2(ring[:, 1] / b, ring[:, 0] / a))
    angle = np.append(angle, angle[0] + 2 * math.pi)
    arcs = [
        quad(lambda t: math.hypot(a * math.sin(t), b * math.cos(t)), start, end)[0]
        for start, end in itertools.pairwise(angle)
    ]
    np.testing.assert_allclose(arcs, np.mean(arcs), rtol=1e-5)
    assert np.mean(arcs) == pytest.approx(0.25, rel=0.15)


def test_three_equal_semiaxes_make_a_sphere() -> None:
    assert np.array_equal(ellipsoid([1.0, 1.0, 1.0]).sites, sphere(1.0).sites)
    assert np.array_equal(ellipsoid([1.0, 1.0]).sites, disc(1.0).sites)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(("length", "count"), [(0.25, 2), (0.3, 2), (1.0, 5), (2.1, 9)])
def test_rods(length: float, count: int, dimension: int) -> None:
    sites = rod(length, 0.25, dimension).sites
    assert sites.shape == (count, dimension)
    np.testing.assert_allclose(sites[:, 0], np.linspace(-length / 2, length / 2, count), atol=1e-15)
    assert not sites[:, 1:].any()


@pytest.mark.parametrize(("keys", "dimension"), [({"length": 1.0}, 2), ({"length": 1.0}, 3), ({"length": 0.3}, 3)])
def test_the_volume_around_a_rod(keys: dict[str, float], dimension: int) -> None:
    """The share of 100000 random points of a box nearer than 0.4 to the line, within 5 standard errors of the formula.

    False alarms in 1 of 1.7 million. The control, the cylinder without its ends, fails.
    """
    bodies = Bodies(shape="rod", effective_radius=0.4, count=1, **keys)
    points = np.random.default_rng(3).uniform(-1, 1, (100_000, dimension))
    along = np.clip(points[:, 0], -keys["length"] / 2, keys["length"] / 2)
    beside = points.copy()
    beside[:, 0] -= along
    share = np.mean(np.linalg.norm(beside, axis=1) < 0.4)
    error = math.sqrt(share * (1 - share) / len(points))
    assert abs(share - bodies.volume_in(dimension) / 2**dimension) < 5 * error
    cylinder = keys["length"] * {2: 0.8, 3: math.pi * 0.16}[dimension]
    assert abs(share - cylinder / 2**dimension) > 5 * error


def test_shape_objects_say_what_they_were_made_from() -> None:
    assert Bodies(disc(1.0, 0.3), count=5) == Bodies("disc", radius=1.0, spacing=0.3, count=5)
    assert Bodies(sphere(1), count=5) == Bodies("sphere", radius=1.0, count=5)
    assert Bodies(rod(2.0, dimension=2), count=5) == Bodies("rod", length=2.0, count=5)
    assert Bodies(ellipsoid(np.array([1, 0.5])), count=5) == Bodies("ellipsoid", semiaxes=[1, 0.5], count=5)
    with pytest.raises(InputError, match=r"^Bodies: radius is given beside a Shape object"):
        Bodies(disc(1.0), radius=2.0, count=1)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: disc(0.2), "radius = 0.2 is shorter than the spacing (sites are 0.25 apart); give a longer one or"),
        (lambda: disc("1"), "radius = '1' is refused (sites are 0.25 apart); give a number"),
        (lambda: disc(math.nan), "radius = nan is shorter than"),
        (lambda: disc(1.0, 0.0), "spacing = 0.0 is refused"),
        (lambda: disc(10.0), "radius = 10.0 makes 5026.55 sites that are 0.25 apart (a body has at most 1000); give"),
        (lambda: sphere(1e30), "radius = 1e+30 makes 2.68"),
        (lambda: sphere(1.5), "radius = 1.5 makes 1163 sites"),
        (lambda: rod(0.1), "length = 0.1 is shorter than the spacing"),
        (lambda: rod(1e29), "length = 1e+29 makes 4e+29 sites"),
        (lambda: rod(1.0, dimension=4), "there is no rod in 4 dimensions"),
        (lambda: ellipsoid([1.0]), "semiaxes = [1.0] are refused (an ellipse has two"),
        (lambda: ellipsoid(1.0), "semiaxes = 1.0 are refused"),
        (lambda: ellipsoid("ab"), "semiaxes = 'ab' are refused"),
        (lambda: ellipsoid([1.0, 0.1]), "semiaxes = 0.1 is shorter than the spacing"),
        (lambda: ellipsoid([4.0, 4.0, 4.0]), "semiaxes = [4.0, 4.0, 4.0] makes 17157.3 sites"),
    ],
)
def test_refused(make: object, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value).startswith(sentence)
