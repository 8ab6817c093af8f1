"""Bodies of a single particle: particles of a species of their own, which nothing holds and nothing turns."""

from __future__ import annotations

import numpy as np
import pytest
from suspensions import engine, law_table, limit, mean_and_error, measured

MASSES = (1.0, 3.0)
LAWS = law_table(
    [
        [(18.75, 4.5, 1.0, 0.0), (25.0, 6.0, 1.2, 20.0)],
        [(25.0, 6.0, 1.2, 20.0), (60.0, 2.0, 1.4, 10.0)],
    ]
)


def colloids(size, *, bodies, base="massless", rigid=False, density=3.0, count=20, **options):
    """Solvent and `count` heavier particles, which are bodies or not."""
    generator = np.random.default_rng(4)
    dimension = len(size)
    solvent = round(density * np.prod(size))
    species = np.repeat(np.array([0, 1], dtype=np.uint8), [solvent, count])
    made = engine(size, species, laws=LAWS, species_mass=MASSES, shear_rate=0.7, **({"timestep": 0.002} | options))
    if bodies:
        shape = {"sites": np.zeros((1, dimension)), "count": count, "first": solvent, "mass": MASSES[1]}
        if rigid:
            made.add_rigid_bodies(**shape)
        else:
            made.add_tethered_bodies(**shape, stiffness=0.0, base=base, torque_arms="constituents")
    made.position = generator.random((len(species), dimension)) * size
    made.start_gently(0, 100, 0.01)
    mass = np.array(MASSES)[species][:, None]
    velocity = generator.standard_normal(made.position.shape) / np.sqrt(mass)
    velocity -= (mass * velocity).sum(axis=0) / mass.sum()
    velocity[:, 0] += 0.7 * (made.position[:, 1] - 0.5 * size[1])
    made.velocity = velocity
    made.place()
    return made


@pytest.mark.parametrize("precision", ["mixed", "double"])
@pytest.mark.parametrize("size", [[6.0, 5.0], [4.5, 4.3, 5.0]], ids=["2D", "3D"])
def test_they_move_as_free_particles_in_the_same_bits(size, precision):
    """As without bodies: gentle start, plain steps, measured ones. They add nothing to the stress, and have no spin."""
    free, single = (colloids(size, bodies=bodies, precision=precision) for bodies in (False, True))
    assert single.rotational_freedom == [0]
    for one in (free, single):
        one.run(60)
    named, wanted = (measured(one, one.run(40, 10)) for one in (single, free))
    for name in ("order", "position", "velocity", "force"):
        assert np.array_equal(getattr(single, name), getattr(free, name)), name
    for name in wanted:
        if name not in ("thermal_translation", "angular_momentum"):
            assert np.array_equal(named[name], wanted[name]), name
    for name in ("stress_body", "spin_energy", "spin", "angular_momentum", "inertia"):
        assert not named[name].any(), name
    assert named["thermal_translation"] == pytest.approx(named["thermal_constituents"], rel=1e-12)
    center, velocity, rotation = single.body_frames()
    assert np.array_equal(center, single.position[-20:])
    assert np.array_equal(velocity, single.velocity[-20:])
    assert np.array_equal(rotation, np.tile(np.eye(len(size)), (20, 1, 1)))


@pytest.mark.parametrize("size", [[6.0, 5.0], [4.5, 4.3, 5.0]], ids=["2D", "3D"])
def test_rigid_bodies_of_one_particle_are_the_same(size):
    """To rounding: a base carries the momentum instead of the particle."""
    free, rigid = (colloids(size, bodies=bodies, rigid=True, precision="double") for bodies in (False, True))
    assert rigid.rotational_freedom == [0]
    named, wanted = (measured(one, one.run(20, 1)) for one in (rigid, free))
    assert np.abs(rigid.position - free.position).max() < 1e-9
    assert np.abs(rigid.velocity - free.velocity).max() < 1e-7
    for name in wanted:
        if name != "thermal_translation":
            assert named[name] == pytest.approx(wanted[name], abs=1e-6), name


def test_they_hold_the_temperature_of_the_fluid():
    """Steep, heavy colloids in a sheared fluid in 2D, kT = 1: false-alarm rate 1e-4 for both temperatures together;
    half a percent is left to the time step. The control: their energy without their mass is a third of it.
    """
    made = colloids([6.0, 6.0], bodies=True, timestep=0.004)
    made.run(1000)
    named = measured(made, made.run(12_000, 5))
    total = len(made.position) + 2.0 * 20.0  # mass
    solvent = named["thermal_solvent"] / (2.0 * (len(made.position) - 20) * (1.0 - 1.0 / total))
    colloid = named["thermal_translation"] / (2.0 * 20 * (1.0 - MASSES[1] / total))
    for series in (solvent, colloid):
        value, error = mean_and_error(series)
        assert error < 0.02
        assert abs(value - 1.0) < limit(1e-4, comparisons=2) * error + 0.005
    value, error = mean_and_error(colloid / MASSES[1])
    assert abs(value - 1.0) > 20.0 * error
