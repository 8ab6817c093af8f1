"""Where particles are at step 0, for every number of bodies in the paper's captions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

import tether as tt
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
    v = velocities(configuration, at, mass, random)
    v[:, 0] -= 0.2 * (at[:, 1] - 5.0)
    assert np.abs((mass[:, None] * v).sum(axis=0)).max() < 1e-10
    for of in (mass == 1.0, mass == 4.0):
        values = (mass[of, None] * v[of] ** 2).ravel()
        assert abs(values.mean() - 1.0) < 5 * math.sqrt(2 / len(values))


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
