"""The cell grid finds each pair within the cutoff once, as brute force over all images does."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from suspensions import every_pair, places, scattered

from tether import _core


def compare(position, size, shear_rate, offset, cutoff, brute=None):
    """The grid's pairs are brute force's: ids, separations (their signs too) and image velocities. Pairs within
    rounding of the cutoff may be in or out. Returns how many there are. `brute` overrides what brute force is given.
    """
    size = [float(side) for side in size]
    pair, separation, velocity = _core.neighbor_pairs(position, size, shear_rate, offset, cutoff)
    swapped = pair[:, 0] > pair[:, 1]  # turn pairs so that i < j, as brute force has them
    pair = np.sort(pair, axis=1).astype(int)
    separation[swapped] *= -1.0
    velocity[swapped] *= -1.0
    order = np.lexsort((pair[:, 1], pair[:, 0]))
    pair, separation, velocity = pair[order], separation[order], velocity[order]
    exact = every_pair(
        position, size, **({"shear_rate": shear_rate, "offset": offset, "cutoff": cutoff} | (brute or {}))
    )
    wanted = np.stack([exact.i, exact.j], axis=1)

    def clear(r):
        return np.abs(np.linalg.norm(r, axis=1) - cutoff) > 1e-12 * max(size)

    mine, his = clear(separation), clear(exact.separation)
    assert len(np.unique(pair, axis=0)) == len(pair), "a pair was met twice"
    assert np.array_equal(pair[mine], wanted[his])
    assert np.abs(separation[mine] - exact.separation[his]).max(initial=0.0) < 1e-14 * max(size)
    assert np.array_equal(velocity[mine], exact.image_velocity[his])
    assert (np.linalg.norm(separation, axis=1) < cutoff * (1 + 1e-14)).all()  # to rounding
    return len(pair)


@settings(max_examples=400)
@given(
    dimension=st.sampled_from([2, 3]),
    kind=st.sampled_from(places),
    cutoff=st.sampled_from([1.0, 0.7, 1.1, 1.3]),
    sides=st.tuples(*[st.one_of(st.sampled_from([3.0, 4.0, 5.0, 6.0]), st.floats(3.0, 7.0))] * 3),
    share=st.one_of(st.sampled_from([0.0, 0.5, 1.0 / 3.0]), st.floats(0.0, 1.0, exclude_max=True)),
    shear_rate=st.sampled_from([-1.3, 0.0, 0.6]),
    seed=st.integers(0, 2**32 - 1),
)
def test_grid_is_brute_force(dimension, kind, cutoff, sides, share, shear_rate, seed):
    size = [side * cutoff for side in sides[:dimension]]
    position = scattered(np.random.default_rng(seed), kind, 40, size, cutoff)
    compare(position, size, shear_rate, share * size[0], cutoff)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("shear_rate", [-0.5, 0.5])
@pytest.mark.parametrize("kind", places)
def test_narrowest_box_at_every_offset(dimension, shear_rate, kind):
    """Exactly three cutoffs wide, where every row is a neighbor of every other, at offsets all around the period."""
    generator = np.random.default_rng(7)
    size = [3.0] * dimension
    found = 0
    for offset in (*np.linspace(0.0, 3.0, 13), np.nextafter(3.0, 0.0), 1.0 - 1e-16, 1.0 + 1e-15):
        found += compare(scattered(generator, kind, 50, size, 1.0), size, shear_rate, offset, 1.0)
    assert found > 1000


@pytest.mark.parametrize("size", [(9.0, 3.0), (3.0, 9.5), (3.0, 8.2, 5.0), (10.1, 3.0, 4.0), (4.9, 5.0, 3.0)])
def test_many_particles_in_unequal_boxes(size):
    generator = np.random.default_rng(8)
    for shear_rate, offset in ((0.0, 0.0), (0.4, 1.7), (-0.4, 2.9)):
        position = scattered(generator, "anywhere", 500, size, 1.0)
        assert compare(position, size, shear_rate, offset, 1.0) > 500


def test_pair_across_the_sheared_boundary():
    """One pair by hand. The image of j one period up stands at the offset and moves faster by rate times L_y."""
    position = np.array([[1.0, 4.75], [0.5, 0.25]])
    pair, separation, velocity = _core.neighbor_pairs(position, [6.0, 5.0], 0.5, 0.75, 1.0)
    sign = 1.0 if list(pair[0]) == [0, 1] else -1.0
    assert len(pair) == 1
    assert sign * separation[0] == pytest.approx([1.0 - (0.5 + 0.75), 4.75 - (0.25 + 5.0)])
    assert sign * velocity[0] == 2.5


@pytest.mark.parametrize("wrong", [{"offset": 3.0}, {"shear_rate": -0.5}, {"cutoff": 0.99}])
def test_comparison_notices(wrong):
    """The control: an offset or a velocity of the wrong sign, or a slightly smaller reach, is not the same."""
    position = scattered(np.random.default_rng(9), "anywhere", 200, [4.0, 4.0], 1.0)
    compare(position, [4.0, 4.0], 0.5, 1.0, 1.0)
    with pytest.raises(AssertionError):
        compare(position, [4.0, 4.0], 0.5, 1.0, 1.0, brute=wrong)
