"""The DPD law: exact values at special points, signs, symmetry, reach, and the same numbers by every path."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from suspensions import Fluid, engine, pair_forces

from tether import _core

weights = st.floats(0.01, 1.0)
exponents = st.floats(0.1, 6.0)


def force(distance, departure=0.0, noise=0.0, *, general=False, **parameters):
    """One pair's conservative, dissipative and random force."""
    parameters = {
        "repulsion": 0.0,
        "friction": 0.0,
        "noise_amplitude": 0.0,
        "cutoff": 1.0,
        "exponent": 0.5,
    } | parameters
    columns = [np.array([float(value)]) for value in (distance, departure, noise)]
    return _core.dpd_force(*columns, general=general, **parameters)[0]


def two_particles(dimension, separation, velocity=0.0, **options):
    """Forces on two particles in the middle of a box, the second at the first's -separation e with e = (1, 2, 2)/3 or
    (3, 4)/5; they part at `velocity`. Returns the forces, e, and the positions.
    """
    e = np.array([3.0, 4.0]) / 5.0 if dimension == 2 else np.array([1.0, 2.0, 2.0]) / 3.0
    pair = engine([6.0] * dimension, [0, 0], **options)
    pair.position = np.array([3.0 + separation * e, np.full(dimension, 3.0)])
    pair.velocity = np.array([0.5 * velocity * e, -0.5 * velocity * e])
    pair.place()
    return pair.force, e


def test_exact_values_at_special_points():
    """Powers of 1/2 only, so nothing is rounded."""
    assert force(0.0, repulsion=18.75)[0] == 18.75
    assert force(0.5, repulsion=18.75)[0] == 9.375
    assert force(1.0, repulsion=18.75)[0] == 0.0
    assert force(1.0, cutoff=2.0, repulsion=18.75)[0] == 9.375
    for exponent, w_d in ((0.5, 0.5), (2.0, 0.0625), (1.0, 0.25)):  # at w = 1/4
        terms = force(0.75, departure=3.0, noise=-2.0, friction=4.0, noise_amplitude=8.0, exponent=exponent)
        assert terms[1] == -4.0 * w_d * 3.0
        assert terms[2] == pytest.approx(8.0 * math.sqrt(w_d) * -2.0, rel=2e-16)
    assert not force(1.0, departure=3.0, noise=-2.0, friction=4.0, noise_amplitude=8.0).any()


@given(w=weights, exponent=exponents, departure=st.floats(-10.0, 10.0), noise=st.floats(-1.7, 1.7))
def test_any_exponent_is_the_equation(w, exponent, departure, noise):
    distance = 1.3 * (1.0 - w)
    got = force(
        distance, departure, noise, repulsion=25.0, friction=4.5, noise_amplitude=30.0, cutoff=1.3, exponent=exponent
    )
    w = 1.0 - distance / 1.3
    wanted = (25.0 * w, -4.5 * w**exponent * departure, 30.0 * w ** (0.5 * exponent) * noise)
    assert got == pytest.approx(wanted, rel=1e-13, abs=1e-13)


@given(w=weights, exponent=st.sampled_from([0.5, 2.0]), departure=st.floats(-10.0, 10.0), noise=st.floats(-1.7, 1.7))
def test_fast_paths_are_the_general_one(w, exponent, departure, noise):
    parameters = {"repulsion": 18.75, "friction": 4.5, "noise_amplitude": 30.0, "exponent": exponent}
    fast = force(1.0 - w, departure, noise, **parameters)
    general = force(1.0 - w, departure, noise, general=True, **parameters)
    assert fast == pytest.approx(general, rel=4e-15, abs=0.0)


@given(w=weights, exponent=exponents)
def test_fluctuation_and_dissipation_balance(w, exponent):
    """w_R^2 = w_D for every exponent: with sigma^2 = 2 gamma kT this is what makes kT the temperature."""
    _, dissipative, random = force(1.0 - w, -1.0, 1.0, friction=1.0, noise_amplitude=1.0, exponent=exponent)
    assert random**2 == pytest.approx(dissipative, rel=1e-13)


@given(distance=st.floats(0.0, 0.999), departure=st.floats(-10.0, 10.0), exponent=exponents)
def test_friction_takes_energy_out(distance, departure, exponent):
    assert force(distance, departure, friction=4.5, exponent=exponent)[1] * departure <= 0.0


@pytest.mark.parametrize("dimension", [2, 3])
def test_two_particles_at_rest_repel(dimension):
    """The sign convention: F_ij acts on i, e_ij points from j to i, repulsion is positive along it."""
    forces, e = two_particles(dimension, 0.5, friction=0.0)
    assert forces[0] == pytest.approx(0.5 * 18.75 * e, rel=1e-14)
    assert forces[1] == pytest.approx(-0.5 * 18.75 * e, rel=1e-14)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("velocity", [-2.0, 2.0])
def test_two_moving_particles_are_braked(dimension, velocity):
    forces, e = two_particles(dimension, 0.75, velocity, repulsion=0.0, noise=0.0)
    assert forces[0] == pytest.approx(-4.5 * math.sqrt(0.25) * velocity * e, rel=1e-14)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("exponent", [0.5, 1.2, 2.0])
@pytest.mark.parametrize("random", ["uniform", "gaussian"])
def test_action_and_reaction_are_the_same_bits(dimension, exponent, random):
    forces, _ = two_particles(dimension, 0.6, 1.7, exponent=exponent, random=random)
    assert np.array_equal(forces[0], -forces[1])
    assert forces[0].all()


@pytest.mark.parametrize("random", ["uniform", "gaussian"])
@pytest.mark.parametrize("timestep", [0.01, 0.0025])
def test_random_force_is_sigma_w_xi_over_root_timestep(random, timestep):
    forces, e = two_particles(3, 0.75, repulsion=0.0, friction=0.0, noise=3.0, random=random, timestep=timestep, seed=9)
    xi = _core.pair_noise(9, 0, np.array([0], dtype=np.uint32), np.array([1], dtype=np.uint32), random)[0]
    assert forces[0] == pytest.approx(3.0 * 0.25**0.25 * xi / math.sqrt(timestep) * e, rel=1e-13)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("cutoff", [1.0, 1.5])
def test_nothing_at_or_beyond_the_cutoff(dimension, cutoff):
    """Along x the distance is exact: the last number below the cutoff feels the noise, the cutoff itself nothing."""
    pair = engine([6.0] * dimension, [0, 0], cutoff=cutoff)
    for distance, felt in ((np.nextafter(cutoff, 0.0), True), (cutoff, False), (1.1 * cutoff, False), (2.9, False)):
        position = np.zeros((2, dimension))
        position[0, 0] = distance
        pair.position = position
        pair.place()
        assert bool(pair.force.any()) is felt


def test_two_particles_on_one_point_push_nowhere():
    forces, _ = two_particles(3, 0.0)
    assert not forces.any()


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("exponent", [0.5, 0.8, 2.0])
@pytest.mark.parametrize(("shear_rate", "offset"), [(0.0, 0.0), (0.7, 1.234), (-0.7, 2.9)])
def test_forces_of_many_are_the_printed_equations(dimension, exponent, shear_rate, offset):
    """Against the plain NumPy writing of eq. 1-15, in a narrow box, sheared or not, for both kinds of noise."""
    size = [3.3, 3.0, 4.1][:dimension]
    generator = np.random.default_rng(dimension)
    position = generator.random((60, dimension)) * size
    velocity = generator.standard_normal((60, dimension))
    for random in ("uniform", "gaussian"):
        fluid = Fluid(friction=2.0, temperature=0.7, exponent=exponent, random=random)
        many = engine(size, [0] * 60, shear_rate=shear_rate, timestep=0.004, seed=5, **fluid.options)
        many.position, many.velocity, many.offset, many.step = position, velocity, offset, 17
        many.place()
        wanted, _ = pair_forces(
            fluid, position, velocity, size, timestep=0.004, seed=5, step=17, shear_rate=shear_rate, offset=offset
        )
        assert many.force == pytest.approx(wanted, abs=1e-10)


@pytest.mark.parametrize("dimension", [2, 3])
def test_forces_know_no_uniform_motion(dimension):
    """Galilei: the same velocity added to all changes no force but by rounding."""
    size = [4.0] * dimension
    generator = np.random.default_rng(4)
    many = engine(size, [0] * 100)
    many.position = generator.random((100, dimension)) * size
    many.velocity = generator.standard_normal((100, dimension))
    many.place()
    at_rest = many.force
    many.velocity = many.velocity + np.array([5.0, -3.0, 2.0])[:dimension]
    many.place()
    assert many.force == pytest.approx(at_rest, abs=1e-10)
    assert np.abs(many.force.sum(axis=0)).max() < 1e-10
