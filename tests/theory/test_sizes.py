"""The pore between touching particles, by the theorem of Descartes and Soddy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tether.theory import sizes


@pytest.mark.parametrize("dimension", [2, 3])
def test_kissing(dimension):
    """d + 2 balls that all touch have curvatures with (sum)^2 = d x (sum of squares); the largest root is the pore."""
    around = dimension + 1  # each of curvature 1
    # (around + k)^2 = d (around + k^2)
    roots = np.roots([dimension - 1.0, -2.0 * around, dimension * around - around**2])
    assert sizes.pore_size_ratio(dimension) == pytest.approx(max(roots))
    assert sizes.pore_radius(0.7, dimension) == pytest.approx(0.7 / max(roots))


def test_printed():
    """Section 4.5: a (2 sqrt(3) - 3)/3, and 3/(2 sqrt(3) - 3), 6.46."""
    assert sizes.pore_size_ratio(2) == pytest.approx(3.0 / (2.0 * math.sqrt(3.0) - 3.0), rel=1e-12)
    assert sizes.pore_size_ratio(2) == pytest.approx(6.46, abs=0.005)
    radii = np.array([0.4, 0.605])
    np.testing.assert_allclose(sizes.pore_radius(radii, 2), radii * (2.0 * math.sqrt(3.0) - 3.0) / 3.0, rtol=1e-12)
    assert sizes.pore_radius(1.0, 3) == pytest.approx(0.2247, abs=5e-5)
