"""The packed pair loop finds what brute force over all images finds: repulsion alone, wherever particles are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from suspensions import engine, every_pair, places, scattered


def forces(position, size, shear_rate, offset, cutoff, precision, **options):
    """Of the packed engine, by repulsion alone: (1 - r/r_c) e."""
    options = {"repulsion": 1.0, "friction": 0.0, "noise": 0.0, "precision": precision} | options
    made = engine(size, [0] * len(position), shear_rate=shear_rate, cutoff=cutoff, **options)
    made.position, made.offset = position, offset
    made.velocity = np.zeros_like(position)
    made.place()
    return made.force


def brute_forces(position, size, shear_rate, offset, cutoff):
    """The same by looking at every image of every pair, and what rounding separations to 1 (of a unit of length, far
    less than that in truth) does to each particle's force: directions turn by 1/r, weights change by 1/r_c. Particles
    on one point push nowhere; so do those that are closer than a rounding, whose direction is anyone's guess.
    """
    pairs = every_pair(position, size, shear_rate=shear_rate, offset=offset, cutoff=cutoff)
    distance = np.linalg.norm(pairs.separation, axis=1)
    pull = np.maximum(0.0, 1.0 - distance / cutoff) / np.where(distance > 0.0, distance, 1.0)
    force = np.zeros_like(position)
    np.add.at(force, pairs.i, pull[:, None] * pairs.separation)
    np.subtract.at(force, pairs.j, pull[:, None] * pairs.separation)
    turned = np.zeros(len(position))
    for ends in (pairs.i, pairs.j):
        np.add.at(turned, ends, 1.0 / cutoff + 2.0 / np.maximum(distance, 1e-300))
    return force, turned, pairs


def compare(position, size, shear_rate, offset, cutoff, precision, brute=None, **options):
    """The engine's forces are brute force's, to rounding: of a position by its part of the box (2^-32 in mixed
    precision), of each pair's arithmetic, and of each pair's force to the quantum. Returns how many pairs there are.
    `brute` overrides what brute force is given.
    """
    size = [float(side) for side in size]
    case = {"shear_rate": shear_rate, "offset": offset, "cutoff": cutoff}
    got = forces(position, size, precision=precision, **case, **options)
    wanted, turned, pairs = brute_forces(position, size, **(case | (brute or {})))
    of_position, of_pair = (2.0**-31 * max(size), 1e-6) if precision == "mixed" else (2.0**-50 * max(size), 1e-14)
    partners = np.bincount(np.concatenate([pairs.i, pairs.j]), minlength=len(position))
    # No direction is wrong by more than 2, and no weight by more than 1.
    allowed = np.minimum(of_position * turned, 2.0 * partners) + of_pair * (partners + 1)
    wrong = np.linalg.norm(got - wanted, axis=1)
    assert (wrong < allowed).all(), (wrong / allowed).max()
    return len(pairs.i)


@settings(max_examples=400)
@given(
    dimension=st.sampled_from([2, 3]),
    kind=st.sampled_from(places),
    cutoff=st.sampled_from([1.0, 0.7, 1.1, 1.3]),
    sides=st.tuples(*[st.one_of(st.sampled_from([3.0, 4.0, 5.0, 6.0]), st.floats(3.0, 9.0))] * 3),
    share=st.one_of(st.sampled_from([0.0, 0.5, 1.0 / 3.0]), st.floats(0.0, 1.0, exclude_max=True)),
    shear_rate=st.sampled_from([-1.3, 0.0, 0.6]),
    precision=st.sampled_from(["mixed", "double"]),
    seed=st.integers(0, 2**32 - 1),
)
def test_forces_are_brute_forces(dimension, kind, cutoff, sides, share, shear_rate, precision, seed):
    size = [side * cutoff for side in sides[:dimension]]
    position = scattered(np.random.default_rng(seed), kind, 40, size, cutoff)
    compare(position, size, shear_rate, share * size[0], cutoff, precision)


@pytest.mark.parametrize("precision", ["mixed", "double"])
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("shear_rate", [-0.5, 0.5])
@pytest.mark.parametrize("kind", places)
def test_narrowest_box_at_every_offset(dimension, shear_rate, kind, precision):
    """Exactly three cutoffs wide, where every row is a neighbor of every other, at offsets all around the period."""
    generator = np.random.default_rng(7)
    size = [3.0] * dimension
    found = 0
    for offset in (*np.linspace(0.0, 3.0, 13), np.nextafter(3.0, 0.0), 1.0 - 1e-16, 1.0 + 1e-15):
        position = scattered(generator, kind, 50, size, 1.0)
        found += compare(position, size, shear_rate, offset % 3.0, 1.0, precision)
    assert found > 1000


@pytest.mark.parametrize("precision", ["mixed", "double"])
@pytest.mark.parametrize("size", [(9.0, 3.0), (3.0, 9.5), (3.0, 8.2, 5.0), (10.1, 3.0, 4.0), (4.9, 5.0, 3.0)])
def test_many_particles_in_unequal_boxes(size, precision):
    generator = np.random.default_rng(8)
    for shear_rate, offset in ((0.0, 0.0), (0.4, 1.7), (-0.4, 2.9)):
        position = scattered(generator, "anywhere", 500, size, 1.0)
        assert compare(position, size, shear_rate, offset, 1.0, precision, threads=2) > 500


@pytest.mark.parametrize("precision", ["mixed", "double"])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_last_places_before_the_far_side(axis, precision):
    """There a position rounds to the side itself, which is the other end of the box."""
    size = [5.0] * 3
    size[axis] = 4.0
    for below in (np.nextafter(4.0, 0.0), 4.0 - 4e-10, 4.0 - 2e-9):
        for partner in (3.7, 0.2, 4.0 - 1e-3):
            position = np.full((2, 3), 2.0)
            position[:, axis] = below, partner
            assert compare(position, size, 0.0, 0.0, 1.0, precision) == 1


@pytest.mark.parametrize("precision", ["mixed", "double"])
@pytest.mark.parametrize("fluid", ["repulsion", "repulsion, friction and noise"])
@pytest.mark.parametrize("spread", [0.0, 0.2, 0.6])
@pytest.mark.parametrize(("center", "offset"), [(2.0, 0.0), (0.05, 0.0), (0.05, 1.3)])
def test_crowd(spread, fluid, center, offset, precision):
    """Three thousand particles on a point, or in a cube of which each sees most others, also across all boundaries.
    Four million pairs are too many for brute force; the reference stands in for it.
    """
    generator = np.random.default_rng(3)
    size = [4.0, 4.5, 5.0]
    position = np.mod(center + spread * (generator.random((3000, 3)) - 0.5), size)
    case = (position, size, 0.3, offset, 1.0)
    options = {} if fluid == "repulsion" else {"friction": 4.5, "noise": 3.0}
    wanted = forces(*case, precision="double", pairs="reference", **options)
    got = forces(*case, precision=precision, **options)
    largest = np.abs(wanted).max()
    assert largest >= 500.0 * spread
    assert np.abs(got - wanted).max() <= (1e-5 if precision == "mixed" else 1e-13) * largest


@pytest.mark.parametrize("precision", ["mixed", "double"])
def test_sparse_box(precision):
    """Two particles in 50^3: rows and bins are wider than the cutoff here; at every distance and across boundaries."""
    generator = np.random.default_rng(4)
    found = 0
    for _ in range(200):
        first = generator.random(3) * 50.0
        apart = generator.standard_normal(3)
        position = np.mod(np.array([first, first + apart * generator.random() * 1.3 / np.linalg.norm(apart)]), 50.0)
        if generator.random() < 0.5:
            position[:, 1] = np.mod(position[:, 1] - first[1], 50.0)
        found += compare(position, [50.0] * 3, 0.2, generator.random() * 50.0, 1.0, precision)
    assert 50 < found < 200


@pytest.mark.parametrize("dimension", [2, 3])
def test_side_below_three_cutoffs_is_refused(dimension):
    """A particle would see another and its image at once."""
    for axis in range(dimension):
        size = [3.0 * 1.1] * dimension
        engine(size, [0], cutoff=1.1)
        size[axis] *= 1.0 - 1e-9
        with pytest.raises(ValueError, match="below three cutoffs"):
            engine(size, [0], cutoff=1.1)


@pytest.mark.parametrize("precision", ["mixed", "double"])
@pytest.mark.parametrize("wrong", [{"offset": 3.0}, {"cutoff": 0.99}])
def test_comparison_notices(wrong, precision):
    """The control: an offset of the wrong sign, or a slightly smaller reach, is not the same."""
    position = scattered(np.random.default_rng(9), "anywhere", 200, [4.0, 4.0], 1.0)
    compare(position, [4.0, 4.0], 0.5, 1.0, 1.0, precision)
    with pytest.raises(AssertionError):
        compare(position, [4.0, 4.0], 0.5, 1.0, 1.0, precision, brute=wrong)
