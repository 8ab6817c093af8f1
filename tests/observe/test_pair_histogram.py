"""Counts of pairs by distance and in the flow-gradient plane are those of a look at every image, and freud's."""

from __future__ import annotations

import math

import freud
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from suspensions import images, places, scattered

from tether import _core


def separations(position, size, offset, range_):
    """Pairs i < j and the separations r_i - r_j of all their images within a cube of the range."""
    i, j = np.triu_indices(len(position), 1)
    parts = []
    for separation, _ in images(position[i] - position[j], size, offset):
        near = (np.abs(separation) <= range_ * (1 + 1e-12)).all(axis=1)
        parts.append((i[near], j[near], separation[near]))
    return tuple(np.concatenate(column) for column in zip(*parts, strict=True))


def in_bin(values, edges, slack):
    """How many values lie in each bin for sure, and how many may: those within the slack of an edge may be either."""
    values = np.sort(values)
    below, above = np.searchsorted(values, edges - slack), np.searchsorted(values, edges + slack)
    may = above[1:] - below[:-1]
    return np.maximum(below[1:] - above[:-1], 0), may


@settings(max_examples=150)
@given(
    dimension=st.sampled_from([2, 3]),
    kind=st.sampled_from(places),
    sides=st.tuples(*[st.one_of(st.sampled_from([3.0, 4.0, 6.0]), st.floats(3.0, 7.0))] * 3),
    share=st.one_of(st.sampled_from([0.0, 0.5, 1.0 / 3.0]), st.floats(0.0, 1.0, exclude_max=True)),
    reach=st.sampled_from([1.0, 0.7, 1.5, 0.5]),
    seed=st.integers(0, 2**32 - 1),
)
def test_counts_are_those_of_every_image(dimension, kind, sides, share, reach, seed):
    """Ranges up to a third of the smallest side come from cells, up to half of it from every pair."""
    size = list(sides[:dimension])
    offset, labels, bins = share * size[0], 3, 12
    generator = np.random.default_rng(seed)
    position = scattered(generator, kind, 40, size, 1.0)
    label = generator.integers(0, labels, len(position)).astype(np.uint8)
    counts = _core.pair_histogram(position, size, offset, reach, bins, label, labels)
    i, j, separation = separations(position, size, offset, reach)
    distance = np.linalg.norm(separation, axis=1)
    edges = np.arange(bins + 1) * reach / bins
    for a in range(labels):
        for b in range(labels):
            chosen = ((label[i] == a) & (label[j] == b)) | ((label[i] == b) & (label[j] == a))
            sure, may = in_bin(distance[chosen], edges, 1e-12)
            assert (sure <= counts[a, b]).all()
            assert (counts[a, b] <= may).all()
    near = np.count_nonzero(distance < reach - 1e-12), np.count_nonzero(distance < reach + 1e-12)
    upper = np.triu_indices(labels)
    assert near[0] <= counts[upper].sum() <= near[1]


@pytest.mark.parametrize("size", [(9.0, 6.5), (7.0, 8.2, 6.0)])
@pytest.mark.parametrize("reach", [2.0, 3.0])
def test_generic_points_match_bin_by_bin_and_on_any_number_of_threads(size, reach):
    """No distance of these points is near an edge, so the integers are equal."""
    generator = np.random.default_rng(3)
    position = generator.random((500, len(size))) * size
    label = (np.arange(500) % 2).astype(np.uint8)
    for offset in (0.0, 1.7, 6.9):
        i, j, separation = separations(position, size, offset, reach)
        distance = np.linalg.norm(separation, axis=1)
        counts = _core.pair_histogram(position, size, offset, reach, 200, label, 2)
        edges = np.linspace(0.0, reach, 201)
        for a, b in ((0, 0), (0, 1), (1, 1)):
            chosen = (np.minimum(label[i], label[j]) == a) & (np.maximum(label[i], label[j]) == b)
            assert np.array_equal(counts[a, b], np.histogram(distance[chosen], edges)[0])
        assert np.array_equal(counts, counts.transpose(1, 0, 2))
        for threads in (2, 3, 5):
            again = _core.pair_histogram(position, size, offset, reach, 200, label, 2, threads)
            assert np.array_equal(again, counts)
        order = generator.permutation(500)
        assert np.array_equal(_core.pair_histogram(position[order], size, offset, reach, 200, label[order], 2), counts)


def test_cells_and_every_pair_count_the_same():
    """The first 150 of 300 bins over nearly half the side are the 150 over a quarter: two routes, equal integers."""
    generator = np.random.default_rng(4)
    size = [8.0, 9.0, 10.0]
    position = generator.random((800, 3)) * size
    label = np.zeros(800, np.uint8)
    far = _core.pair_histogram(position, size, 3.3, 3.9, 300, label, 1)
    near = _core.pair_histogram(position, size, 3.3, 1.95, 150, label, 1)
    assert np.array_equal(far[0, 0, :150], near[0, 0])


def freuds(position, size, offset, reach, bins):
    """freud's counts of ordered pairs in the box of periods (L_x, 0, 0), (offset, L_y, 0) and (0, 0, L_z)."""
    tilt = offset if offset <= 0.5 * size[0] else offset - size[0]  # the same lattice, less oblique
    depth = size[2] if len(size) == 3 else 0.0
    box = freud.box.Box(size[0], size[1], depth, xy=tilt / size[1], is2D=len(size) == 2)
    points = np.zeros((len(position), 3))
    points[:, : len(size)] = position - 0.5 * np.array(size)
    rdf = freud.density.RDF(bins=bins, r_max=reach)
    rdf.compute((box, box.wrap(points)))
    return rdf.bin_counts


@pytest.mark.parametrize("offset", [0.0, 2.3, 5.0, 8.9])
@pytest.mark.parametrize("size", [(10.0, 8.0), (10.0, 8.0, 9.0)])
def test_freud_counts_the_same_pairs(size, offset):
    """freud computes in float32: what it has up to an edge lies between the counts up to the edge less and plus that
    rounding, and bin by bin few pairs differ. The control: at another offset neither holds.
    """
    generator = np.random.default_rng(5)
    position = generator.random((1500, len(size))) * size
    label = np.zeros(len(position), np.uint8)
    bins, reach = 200, 2.0
    fine = 5000  # of these in one bin, so each is 2e-6 wide: the rounding of coordinates up to 10 is 10 * 2**-24 = 6e-7
    cumulated = np.cumsum(freuds(position, size, offset, reach, bins)) / 2

    def agrees(at):
        up_to = np.cumsum(_core.pair_histogram(position, size, at, reach, bins * fine, label, 1)[0, 0])
        edge = np.arange(1, bins) * fine - 1
        exact = _core.pair_histogram(position, size, at, reach, bins, label, 1)[0, 0]
        assert np.array_equal(np.cumsum(exact)[:-1], up_to[edge])
        between = (up_to[edge - 2] <= cumulated[:-1]).all() and (cumulated[:-1] <= up_to[edge + 2]).all()
        return between and np.abs(np.diff(cumulated) - exact[1:]).sum() < 1e-3 * exact.sum()

    assert agrees(offset)
    assert not agrees((offset + 0.05) % size[0])


def test_square_lattice_by_hand():
    """Neighbors at 1, sqrt 2, 2 and sqrt 5 of each point of a 10 x 10 lattice: 4, 4, 4 and 8, each pair once."""
    x, y = np.meshgrid(np.arange(10.0), np.arange(10.0))
    position = np.stack([x.ravel(), y.ravel()], axis=1)
    label = np.zeros(100, np.uint8)
    for offset in (0.0, 3.0):  # by whole places: the same lattice
        for reach in (2.5, 4.5):
            counts = _core.pair_histogram(position, [10.0, 10.0], offset, reach, 10 * round(10 * reach), label, 1)[0, 0]
            found = {k: int(n) for k, n in enumerate(counts[:250]) if n}
            assert {k: found[k] for k in list(found)[:4]} == {100: 200, 141: 200, 200: 200, 223: 400}


@pytest.mark.parametrize("size", [(9.0, 6.5), (7.0, 8.2, 6.0), (30.0, 31.0, 29.0)])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.8])
def test_map_counts_ordered_pairs_in_the_slab(size, share):
    """Both ways to find pairs: the largest box has room for cells. The map is its own image at half a turn."""
    generator = np.random.default_rng(6)
    position = generator.random((400, len(size))) * size
    reach, bins, thickness, offset = 3.0, 30, 0.8, share * size[0]
    _, _, separation = separations(position, size, offset, reach)
    if len(size) == 3:
        separation = separation[np.abs(separation[:, 2]) < thickness]
    edges = np.linspace(-reach, reach, bins + 1)
    both = np.concatenate([separation, -separation])
    exact = np.histogram2d(both[:, 1], both[:, 0], [edges, edges])[0]
    assert exact.sum() > 100
    for threads in (1, 3):
        counts = _core.pair_map(position, size, offset, reach, bins, thickness, threads)
        assert np.array_equal(counts, exact)
    assert np.array_equal(counts, counts[::-1, ::-1])
    assert not np.array_equal(_core.pair_map(position, size, offset + 0.3, reach, bins, thickness), exact)


def test_shear_shows_in_the_map_where_it_should():
    """A pair by hand: j one period up stands at the offset, so r_i - r_j = (-0.25, -0.5)."""
    position = np.array([[1.0, 4.75], [0.5, 0.25]])
    counts = _core.pair_map(position, [6.0, 5.0], 0.75, 2.0, 40)
    row, column = np.nonzero(counts)
    assert sorted(zip(row.tolist(), column.tolist(), strict=True)) == [(15, 17), (25, 22)]


@pytest.mark.parametrize(
    "wrong",
    [
        {"range": 3.3}, {"range": 0.0}, {"range": math.nan}, {"bins": 0}, {"group": np.zeros(9, np.uint8)},
        {"group": np.full(10, 2, np.uint8)}, {"threads": 0}, {"size": [6.5, 7.0, 8.0]},
    ],
)  # fmt: skip
def test_wrong_arguments_are_refused(wrong):
    right = {
        "position": np.random.default_rng(7).random((10, 2)), "size": [6.5, 7.0], "offset": 0.0, "range": 2.0,
        "bins": 10, "group": np.zeros(10, np.uint8), "labels": 2,
    }  # fmt: skip
    _core.pair_histogram(**right)
    with pytest.raises(ValueError, match="expected"):
        _core.pair_histogram(**(right | wrong))


def test_no_points_no_pairs():
    nothing = np.zeros((0, 3))
    assert _core.pair_histogram(nothing, [6.0] * 3, 0.0, 2.0, 5, np.zeros(0, np.uint8), 1).sum() == 0
    assert _core.pair_map(nothing, [6.0] * 3, 0.0, 2.0, 5, 1.0).sum() == 0
