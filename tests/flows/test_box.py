"""The sheared box: images in and out of it, and its offset over very many steps."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tether import _core

sides = st.floats(2.0, 20.0)
rates = st.floats(-2.0, 2.0)


def box_of(size, shear_rate, offset):
    return (_core.Box2 if len(size) == 2 else _core.Box3)(list(size), shear_rate, offset)


@st.composite
def particles_about_boxes(draw):
    """A sheared box and a particle up to eight periods outside."""
    dimension = draw(st.sampled_from([2, 3]))
    size = np.array([draw(sides) for _ in range(dimension)])
    shear_rate, offset = draw(rates), draw(st.floats(0.0, 1.0, exclude_max=True)) * size[0]
    position = np.array([draw(st.one_of(st.floats(-8.0, 8.0), st.integers(-8, 8).map(float))) for _ in size]) * size
    velocity = np.array([draw(st.floats(-5.0, 5.0)) for _ in size])
    return size, shear_rate, offset, position, velocity


@given(particles_about_boxes())
def test_wrapped_particles_are_images_inside(case):
    """Inside, half open; moved by whole periods, the rows in y with offset and velocity; wrapped again they stay."""
    size, shear_rate, offset, position, velocity = case
    box = box_of(size, shear_rate, offset)
    inside, moving = box.wrap(position[None], velocity[None])
    assert (inside >= 0.0).all()
    assert (inside < size).all()
    rows = np.round((position[1] - inside[0, 1]) / size[1])
    moved = position - inside[0]
    moved[0] -= rows * box.offset
    periods = moved / size
    assert periods == pytest.approx(np.round(periods), abs=1e-12)
    assert velocity[0] - moving[0, 0] == pytest.approx(rows * shear_rate * size[1], abs=1e-12)
    assert np.array_equal(moving[0, 1:], velocity[1:])
    again, still = box.wrap(inside, moving)
    assert np.array_equal(again, inside)
    assert np.array_equal(still, moving)


@given(particles_about_boxes())
def test_wrapping_changes_no_separation(case):
    """A particle and its image inside the box are on one spot and at rest against each other."""
    size, shear_rate, offset, position, velocity = case
    box = box_of(size, shear_rate, offset)
    inside, moving = box.wrap(position[None], velocity[None])
    separation, relative = box.nearest_image(position[None] - inside, velocity[None] - moving)
    assert separation == pytest.approx(0.0, abs=1e-12)
    assert relative == pytest.approx(0.0, abs=1e-12)


@given(particles_about_boxes())
def test_wrapping_keeps_the_peculiar_velocity(case):
    size, shear_rate, offset, position, velocity = case
    inside, moving = box_of(size, shear_rate, offset).wrap(position[None], velocity[None])
    before = velocity[0] - shear_rate * position[1]
    assert moving[0, 0] - shear_rate * inside[0, 1] == pytest.approx(before, abs=1e-10)


@given(particles_about_boxes(), st.floats(-0.49, 0.49), st.integers(-3, 3), st.integers(-3, 3))
def test_nearest_image_undoes_any_lattice_vector(case, share, rows, columns):
    """A separation within half a box, moved by any period of the sheared lattice, comes back, velocity too."""
    size, shear_rate, offset, _, velocity = case
    box = box_of(size, shear_rate, offset)
    short = share * size * np.array([1.0, -1.0, 0.5])[: len(size)]
    period = np.zeros(len(size))
    period[0] = rows * box.offset + columns * size[0]
    period[1] = rows * size[1]
    period[2:] = columns * size[2:]
    faster = np.zeros(len(size))
    faster[0] = rows * shear_rate * size[1]
    separation, relative = box.nearest_image((short + period)[None], (velocity + faster)[None])
    assert separation[0] == pytest.approx(short, abs=1e-12)
    assert relative[0] == pytest.approx(velocity, abs=1e-12)


@pytest.mark.parametrize("shear_rate", [0.2, -0.2, 0.37, -1.9])
def test_a_million_steps_do_not_wear_the_offset(shear_rate):
    """Against exact arithmetic: at most half a unit in the last place of L_x is lost in each addition, so that after
    10^6 steps (hundreds of crossings) images stand right to 1e-9.
    """
    size, timestep, steps = [10.0, 9.7], 0.01, 1_000_000
    box = box_of(size, shear_rate, 0.0)
    for _ in range(steps):
        box.advance(timestep)
    exact = Fraction(shear_rate) * Fraction(size[1]) * Fraction(timestep) * steps
    crossings = abs(exact / Fraction(size[0]))
    wrong = (Fraction(box.offset) - exact) % Fraction(size[0])
    wrong = min(wrong, Fraction(size[0]) - wrong)
    assert crossings > 1000
    assert 0.0 <= box.offset < size[0]
    assert float(wrong) < steps * np.spacing(size[0])
