"""The best rigid placement of sites (Horn's quaternion, one angle in 2D) against the singular value decomposition."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from suspensions import kabsch, turn

from tether import _core


def points(generator, count, dimension, shape):
    """About their centroid: anywhere, in a plane, or on a line (tilted, in 3D)."""
    reference = generator.standard_normal((count, dimension))
    rank = {"full": dimension, "planar": 2, "collinear": 1}[shape]
    reference[:, rank:] = 0.0
    reference -= reference.mean(axis=0)
    return reference @ turn(generator, dimension).T


def misfit(fitted, actual):
    return float(np.sum((fitted - actual) ** 2))


@given(
    dimension=st.sampled_from([2, 3]),
    shape=st.sampled_from(["full", "planar", "collinear"]),
    count=st.integers(2, 12),
    noise=st.sampled_from([0.0, 1e-12, 1e-6, 0.05, 0.5]),
    seed=st.integers(0, 2**32 - 1),
)
def test_best_fit_is_the_decompositions(dimension, shape, count, noise, seed):
    """The misfit is the same minimum; the points too, unless two rotations fit nearly as well as each other."""
    generator = np.random.default_rng(seed)
    reference = points(generator, count, dimension, shape)
    actual = reference @ turn(generator, dimension).T + noise * generator.standard_normal(reference.shape)
    actual -= actual.mean(axis=0)
    fitted = _core.best_fit(reference, actual)
    other = reference @ kabsch(reference, actual).T
    size = float(np.sum(reference**2) + np.sum(actual**2))
    assert misfit(fitted, actual) == pytest.approx(misfit(other, actual), rel=1e-10, abs=1e-13 * size)
    assert np.allclose(fitted @ fitted.T, reference @ reference.T, atol=1e-13 * size)  # turned, not bent
    singular = np.linalg.svd(actual.T @ reference, compute_uv=False)
    determined = singular[-2] + np.sign(np.linalg.det(actual.T @ reference)) * singular[-1]
    if determined > 1e-3 * singular[0]:
        assert np.abs(fitted - other).max() < 1e-11 * np.sqrt(size)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("shape", ["full", "planar", "collinear"])
def test_exact_placement_is_found_exactly(dimension, shape):
    generator = np.random.default_rng(3)
    for _ in range(200):
        reference = points(generator, 5, dimension, shape)
        actual = reference @ turn(generator, dimension).T
        assert np.abs(_core.best_fit(reference, actual) - actual).max() < 3e-15 * 10.0


def test_half_turns_are_found():
    """Where the angle of the quaternion is pi and its scalar part vanishes."""
    reference = points(np.random.default_rng(4), 6, 3, "full")
    for signs in ([1, -1, -1], [-1, 1, -1], [-1, -1, 1], [1, 1, 1]):
        actual = reference * np.array(signs, dtype=float)
        assert np.abs(_core.best_fit(reference, actual) - actual).max() < 3e-14


@pytest.mark.parametrize("dimension", [2, 3])
def test_mirror_image_is_turned_and_not_mirrored(dimension):
    """The best rotation of a body onto its mirror image is no reflection: an angle or volume keeps its sign."""
    generator = np.random.default_rng(5)
    for _ in range(50):
        reference = points(generator, dimension + 1, dimension, "full")
        actual = reference.copy()
        actual[:, 0] *= -1.0
        fitted = _core.best_fit(reference, actual)
        volume = np.linalg.det(reference[1:] - reference[0])
        assert np.linalg.det(fitted[1:] - fitted[0]) == pytest.approx(volume, rel=1e-10)
        assert misfit(fitted, actual) == pytest.approx(
            misfit(reference @ kabsch(reference, actual).T, actual), rel=1e-10
        )
