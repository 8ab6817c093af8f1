"""A Newton-Euler base with all fluid forces off: Euler's equations, with their own sign of the gyroscopic term."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from suspensions import Kind, crooked, crooked_flat, engine

moments = np.sum(crooked**2) - np.sum(crooked**2, axis=0)  # principal moments of inertia, mass 1 a site
spin = np.array([0.4, 6.0, 0.3])  # own axes; mostly about the middle axis, where bodies tumble
middle = np.argsort(moments)[1]
spin = np.roll(spin, middle - 1)


def released(timestep, base="newton-euler"):
    """The body spinning about its center at the middle of a box, its own axes along the box's; no DPD force."""
    made = engine(
        [6.0, 6.0, 6.0],
        [1] * len(crooked),
        kinds=[Kind(crooked, 1, base)],
        timestep=timestep,
        repulsion=0.0,
        friction=0.0,
    )
    made.position = 3.0 + crooked
    made.velocity = np.cross(spin, crooked)
    made.place()
    return made


def rotation_of(made):
    """Of the base, whose row is center (3), quaternion w x y z, velocity, angular momentum, force, torque (3 each)."""
    return Rotation.from_quat(np.roll(made.bases[0, 3:7], -1))


def energy(made):
    """Of rotation: L I^-1 L / 2 in the body's own axes."""
    own = rotation_of(made).inv().apply(made.bases[0, 10:13])
    return 0.5 * float(np.sum(own**2 / moments))


def tumbled(time, sign):
    """Rotation matrix after `time` by I domega/dt = -sign omega x I omega in the body's axes and dR/dt = R [omega]x."""

    def slope(_, state):
        omega, matrix = state[:3], state[3:].reshape(3, 3)
        cross = np.array([[0, -omega[2], omega[1]], [omega[2], 0, -omega[0]], [-omega[1], omega[0], 0]])
        return np.concatenate([-sign * np.cross(omega, moments * omega) / moments, (matrix @ cross).ravel()])

    start = np.concatenate([spin, np.eye(3).ravel()])
    return solve_ivp(slope, (0.0, time), start, rtol=1e-11, atol=1e-12).y[3:, -1].reshape(3, 3)


def test_the_body_is_asymmetric_and_tumbles():
    """What the tests below rest on: three different moments, and an attitude that the wrong sign would change."""
    assert np.diff(np.sort(moments)).min() > 0.05 * moments.max()
    assert np.abs(tumbled(4.0, 1.0) - tumbled(4.0, -1.0)).max() > 0.5


def test_place_gives_the_base_the_motion_of_its_constituents():
    made = released(0.005)
    assert made.bases[0, 10:13] == pytest.approx(moments * spin, rel=1e-12)
    assert made.bases[0, 7:10] == pytest.approx(0.0, abs=1e-14)


def test_angular_momentum_is_exact_and_energy_is_bounded_to_second_order():
    """10 units of time, some ten turns: L keeps its bits; the energy swings by an amount that falls as dt^2."""
    swings = []
    for timestep in (0.02, 0.01, 0.005):
        made = released(timestep)
        start = made.bases[0, 10:13]
        energies = []
        for _ in range(100):
            made.run(round(0.1 / timestep))
            energies.append(energy(made))
            assert np.array_equal(made.bases[0, 10:13], start)
        swings.append(np.ptp(energies))
        first, last = np.array_split(np.array(energies), 2)
        assert abs(first.mean() - last.mean()) < 0.5 * swings[-1]  # it swings, it does not drift
    order = np.polyfit(np.log([4.0, 2.0, 1.0]), np.log(swings), 1)[0]
    assert 1.9 < order < 2.1


def test_tumbling_is_eulers_and_not_that_of_the_papers_sign():
    """Against an adaptive Runge-Kutta solution, of second order in the time step; the paper's eq. 34 (the other sign
    of the gyroscopic term) must disagree.
    """
    exact, other = tumbled(4.0, 1.0), tumbled(4.0, -1.0)
    errors = []
    for timestep in (0.004, 0.002, 0.001):
        made = released(timestep)
        made.run(round(4.0 / timestep))
        attitude = rotation_of(made).as_matrix()
        errors.append(np.abs(attitude - exact).max())
        assert np.abs(attitude - other).max() > 0.5
    assert errors[-1] < 2e-4
    assert 1.9 < np.log2(errors[0] / errors[1]) < 2.1
    assert 1.9 < np.log2(errors[1] / errors[2]) < 2.1


def test_lagged_base_is_alike_without_forces():
    made, lagged = released(0.005), released(0.005, "newton-euler-lagged")
    for one in (made, lagged):
        one.run(400)
    assert np.array_equal(made.bases[:, :13], lagged.bases[:, :13])


@pytest.mark.parametrize("rate", [3.0, -3.0])
def test_free_spin_in_two_dimensions_is_uniform(rate):
    """The angle grows as rate times time; rows are center (2), cosine and sine, velocity (2), angular momentum, ..."""
    made = engine(
        [6.0, 6.0], [1] * 3, kinds=[Kind(crooked_flat, 1, "newton-euler")], repulsion=0.0, friction=0.0, timestep=0.01
    )
    made.position = 3.0 + crooked_flat
    made.velocity = rate * np.stack([-crooked_flat[:, 1], crooked_flat[:, 0]], axis=1)
    made.place()
    made.run(700)
    cosine, sine = made.bases[0, 2:4]
    assert [cosine, sine] == pytest.approx([np.cos(7.0 * rate), np.sin(7.0 * rate)], abs=1e-10)
    assert made.bases[0, 6] == pytest.approx(rate * np.sum(crooked_flat**2), rel=1e-14)
