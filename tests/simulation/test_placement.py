"""Where particles are at step 0, for every number of bodies in the paper's captions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

import tether as tt
from tether.config import Configuration
from tether.placement import lattice, positions, velocities

SQUARES = [k * k for k in range(1, 12)]
CUBES = [64, 125, 216, 343, 512, 729, 1000, 1331, 1728, 1960]


def suspension(size: tuple[float, ...], count: int, bodies: str, **keys: object) -> tt.Simulation:
    """Squares in two dimensions, cubes in three, at the rate of the paper."""
    shape = tt.square(0.25) if len(size) == 2 else tt.cube(0.25)
    return tt.Simulation(
        **{
            "box": tt.Box(*size),
            "fluid": tt.Fluid(temperature=1.0),
            "bodies": [tt.Bodies(shape, count=count)],
            "flow": tt.Couette(shear_rate=0.2),
            "timestep": 0.005,
            "seed": count,
            "start": tt.Start(bodies=bodies),
        }
        | keys
    )


def centers(simulation: tt.Simulation, at: np.ndarray) -> np.ndarray:
    """Centers of the bodies from places that are not wrapped, put into the box; shape (count, d)."""
    configuration = simulation.configuration
    sites = len(configuration.bodies[0].geometry.sites)
    bodies = at[configuration.solvent_count :].reshape(-1, sites, at.shape[1])
    size = np.array(configuration.box.size)
    return np.mod(bodies.mean(axis=1), size) % size


def assert_apart(at: np.ndarray, size: tuple[float, ...], distance: float) -> None:
    if len(at) > 1:
        nearest = cKDTree(np.minimum(at, np.nextafter(size, 0)), boxsize=size).query(at, k=2)[0][:, 1]
        assert nearest.min() >= distance - 1e-9


@pytest.mark.parametrize("start", ["lattice", "random"])
@pytest.mark.parametrize("count", SQUARES)
def test_squares_are_placed_apart_and_whole(start: str, count: int) -> None:
    simulation = suspension((10.0, 10.0), count, start)
    configuration = simulation.configuration
    assert configuration.solvent_count == 400
    at = positions(configuration, np.random.default_rng(count))
    assert_apart(centers(simulation, at), (10.0, 10.0), 2 * configuration.bodies[0].geometry.radius)
    bodies = at[400:].reshape(count, 4, 2)
    arms = bodies - bodies.mean(axis=1, keepdims=True)
    assert np.linalg.norm(arms, axis=2) == pytest.approx(0.125 * math.sqrt(2))


@pytest.mark.parametrize("start", ["lattice", "random"])
@pytest.mark.parametrize("count", CUBES)
def test_cubes_are_placed_apart_and_whole(start: str, count: int) -> None:
    size = (20.0, 20.0, 10.0)
    simulation = suspension(size, count, start)
    configuration = simulation.configuration
    assert configuration.solvent_count == 16000
    at = positions(configuration, np.random.default_rng(count))
    assert at.shape == (16000 + 8 * count, 3)
    assert_apart(centers(simulation, at), size, 2 * configuration.bodies[0].geometry.radius)
    bodies = at[16000:].reshape(count, 8, 3)
    arms = bodies - bodies.mean(axis=1, keepdims=True)
    assert np.linalg.norm(arms, axis=2) == pytest.approx(0.125 * math.sqrt(3))


@pytest.mark.parametrize("start", ["lattice", "random"])
@pytest.mark.parametrize("count", [1, 36, 121])
def test_squares_start_without_a_jolt(start: str, count: int) -> None:
    """After 2 time units the temperature of 400 to 884 particles is kT within 15 %, over four times its own scatter."""
    simulation = suspension((10.0, 10.0), count, start)
    result = simulation.run(equilibration=200, steps=200)
    assert result.temperature["all"].value == pytest.approx(1.0, abs=0.15)
    assert abs(simulation.velocities).max() < 8.0


def test_the_densest_cubes_start_at_random_without_a_jolt() -> None:
    """1960 cubes among 16000: phi = 0.495. 31680 particles scatter by less than 1 % in temperature."""
    simulation = suspension((20.0, 20.0, 10.0), 1960, "random")
    simulation.place()
    assert simulation.kinetic_temperature() == pytest.approx(1.0, abs=0.03)
    result = simulation.run(steps=20)
    assert simulation.engine.fault is None
    assert result.temperature["all"].value == pytest.approx(1.0, abs=0.15)


def test_orientations_are_random() -> None:
    """The mean of the cubes' first arms vanishes as 1/sqrt(n): 5 standard errors, false alarms in 1 of 500000."""
    configuration = suspension((20.0, 20.0, 10.0), 1000, "lattice").configuration
    at = positions(configuration, np.random.default_rng(1))[16000:].reshape(1000, 8, 3)
    arm = at[:, 0] - at.mean(axis=1)
    error = np.linalg.norm(arm[0]) / math.sqrt(3 * 1000)
    assert np.abs(arm.mean(axis=0)).max() < 5 * error


@pytest.mark.parametrize("count", [1, 2, 3, 7, 8, 27, 31, 100, 1960])
@pytest.mark.parametrize("size", [(10.0, 10.0), (4.0, 30.0), (20.0, 20.0, 10.0)])
def test_a_lattice_is_even_for_any_count(count: int, size: tuple[float, ...]) -> None:
    at = lattice(count, size)
    assert at.shape == (count, len(size))
    assert (at >= 0).all()
    assert (at < size).all()
    even = (np.prod(size) / count) ** (1 / len(size))
    if count > 8:
        assert_apart(at, size, 0.5 * even)
    for axis, side in enumerate(size):  # no half of the box holds all the vacancies
        lower = np.count_nonzero(at[:, axis] < side / 2 - 1e-9)
        upper = np.count_nonzero(at[:, axis] > side / 2 + 1e-9)
        assert abs(lower - upper) <= max(1.0, 0.25 * count)


def test_velocities_are_maxwellian_about_the_profile() -> None:
    """Momentum against the profile is zero in all bits but the last; each mass has its kT within 5 standard errors."""
    configuration = suspension((10.0, 10.0), 121, "lattice").configuration.changed(
        bodies=(tt.Bodies(tt.square(0.25), count=121, mass=4.0),)
    )
    random = np.random.default_rng(5)
    at = np.mod(positions(configuration, random), 10.0)
    mass = np.repeat([1.0, 4.0], [400, 484])
    v = velocities(configuration, at, mass, 0.2, random)
    v[:, 0] -= 0.2 * (at[:, 1] - 5.0)
    assert np.abs((mass[:, None] * v).sum(axis=0)).max() < 1e-10
    for of in (mass == 1.0, mass == 4.0):
        values = (mass[of, None] * v[of] ** 2).ravel()
        assert abs(values.mean() - 1.0) < 5 * math.sqrt(2 / len(values))


def mixture(size: tuple[float, ...], start: str, *bodies: tt.Bodies) -> Configuration:
    """A configuration of several kinds of bodies."""
    return Configuration(
        box=tt.Box(*size),
        fluid=tt.Fluid(temperature=1.0),
        bodies=bodies,
        run=tt.Run(timestep=1e-3, steps=1),
        start=tt.Start(bodies=start),
    )


def by_kind(configuration: Configuration, at: np.ndarray) -> list[np.ndarray]:
    """Places of the constituents of each kind, shape (count, sites, d)."""
    sites = [len(shape.sites) for shape in configuration.geometries]
    ends = np.cumsum([n * p for n, p in zip(configuration.body_counts, sites, strict=True)])
    parts = np.split(at[configuration.solvent_count :], ends[:-1])
    return [part.reshape(-1, p, at.shape[1]) for part, p in zip(parts, sites, strict=True)]


LARGE = tt.Bodies(tt.disc(1.0), count=6)
SMALL = tt.Bodies(tt.square(0.25), count=60)
TINY = tt.Bodies(model="single", radius=0.3, count=40)


@pytest.mark.parametrize("start", ["lattice", "random"])
@pytest.mark.parametrize("bodies", [(LARGE, SMALL), (SMALL, LARGE), (TINY, LARGE, SMALL), (TINY,), (LARGE,)])
def test_bodies_of_different_sizes_are_placed_apart(start: str, bodies: tuple[tt.Bodies, ...]) -> None:
    """No two circles about bodies overlap; that of a single particle has its effective radius."""
    configuration = mixture((12.0, 12.0), start, *bodies)
    at = positions(configuration, np.random.default_rng(2))
    centers = [part.mean(axis=1) for part in by_kind(configuration, at)]
    assert [len(part) for part in centers] == list(configuration.body_counts)
    radii = [each.radius if each.model == "single" else each.geometry.radius for each in bodies]
    radius = np.repeat(radii, configuration.body_counts)
    every = np.concatenate(centers)
    apart = every[:, None] - every
    distance = np.linalg.norm(apart - 12.0 * np.round(apart / 12.0), axis=2)
    np.fill_diagonal(distance, np.inf)
    assert (distance >= radius[:, None] + radius - 1e-9).all()


def test_kinds_that_fit_on_one_lattice_are_mixed_there() -> None:
    """100 bodies on a 10 x 10 lattice, each kind all over the box."""
    configuration = mixture(
        (10.0, 10.0), "lattice", tt.Bodies(tt.square(), count=50), tt.Bodies(tt.triangle(), count=50)
    )
    centers = [part.mean(axis=1) for part in by_kind(configuration, positions(configuration, np.random.default_rng(1)))]
    places = {tuple(place) for part in centers for place in np.round(part, 9)}
    assert len(places) == 100
    assert np.allclose(np.array(sorted(places)) % 1.0, 0.5)
    for part in centers:
        assert 10 < np.count_nonzero(part[:, 0] < 5.0) < 40


@pytest.mark.parametrize("start", ["lattice", "random"])
def test_mixed_bodies_that_find_no_room_are_refused(start: str) -> None:
    crowded = mixture((12.0, 12.0), start, LARGE.changed(count=20), tt.Bodies(tt.square(), count=1500))
    with pytest.raises(tt.InputError, match=r"^1520 bodies cannot be placed \(.*\); ask for fewer bodies or give"):
        positions(crowded, np.random.default_rng(1))


@pytest.mark.parametrize(
    "bodies",
    [
        tt.Bodies(tt.disc(1.0), count=8),
        tt.Bodies(tt.sphere(0.75), count=8),
        tt.Bodies(tt.ellipsoid([1.5, 0.5]), count=8),
        tt.Bodies(tt.ellipsoid([1.0, 0.5, 0.75]), count=8),
        tt.Bodies(model="single", radius=1.0, count=8),
    ],
    ids=["disc", "sphere", "ellipse", "ellipsoid", "single"],
)
def test_no_solvent_starts_inside_a_closed_body(bodies: tt.Bodies) -> None:
    """The rotation of each body is found from its sites, by least squares; the control is a body a tenth larger.

    Elsewhere solvent is as before: what had its place outside keeps it.
    """
    is_flat = bodies.shape == "disc" or bodies.semiaxes == (1.5, 0.5)
    size = (14.0, 14.0) if is_flat else (9.0, 9.0, 9.0)
    configuration = mixture(size, "random", bodies)
    at = positions(configuration, np.random.default_rng(4))
    solvent = at[: configuration.solvent_count]
    sites = configuration.geometries[0].sites
    semiaxes = np.array(bodies.semiaxes or [bodies.radius] * len(size))
    least = math.inf
    for body in by_kind(configuration, at)[0]:
        center = body.mean(axis=0)
        apart = solvent - center
        apart -= size * np.round(apart / size)
        # rows: body = sites @ turn, and the body's own coordinates are apart @ turn^T
        turn = np.linalg.lstsq(sites, body - center, rcond=None)[0] if len(sites) > 1 else np.eye(len(size))
        assert len(sites) == 1 or np.allclose(turn @ turn.T, np.eye(len(size)))
        least = min(least, ((apart @ turn.T / semiaxes) ** 2).sum(axis=1).min())
    assert 1.0 <= least < 1.1**2
    first = np.random.default_rng(4).random(solvent.shape) * size
    kept = (first == solvent).all(axis=1)
    volume = 8 * bodies.volume_in(len(size)) / np.prod(size)
    # five standard errors of a binomial share; false alarms in 1 of 1.7 million
    assert abs(kept.mean() - (1 - volume)) < 5 * math.sqrt(volume * (1 - volume) / len(solvent))


def test_open_bodies_leave_the_solvent_where_it_is() -> None:
    """The starts of the paper's shapes are those of earlier versions; so solvent takes none of their random numbers."""
    for bodies in (tt.Bodies(tt.cube(), count=20), tt.Bodies(tt.rod(1.0), count=20)):
        configuration = mixture((6.0, 6.0, 6.0), "lattice", bodies)
        at = positions(configuration, np.random.default_rng(3))
        assert np.array_equal(at[: 4 * 216], np.random.default_rng(3).random((4 * 216, 3)) * 6.0)


@pytest.mark.parametrize("start", ["lattice", "random"])
def test_bodies_that_find_no_room_are_refused(start: str) -> None:
    with pytest.raises(
        tt.InputError, match=r"^1000 bodies cannot be placed \(.*\); ask for fewer bodies or give"
    ) as caught:
        suspension((4.0, 4.0), 1000, start).place()
    assert caught.value.key == ("bodies",)


def test_the_same_seed_places_alike_and_another_differently() -> None:
    first, same, other = (suspension((6.0, 6.0), 5, "random", seed=seed) for seed in (1, 1, 2))
    assert first.state_sha256 == same.state_sha256
    assert first.state_sha256 != other.state_sha256
    assert not np.isclose(first.positions[0], other.positions[0]).any()
