"""Numbers in, numbers out: what the formulas take and return.

A formula takes numbers and numpy arrays alike and broadcasts them; numbers alone give a float.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Numbers: TypeAlias = float | NDArray[np.float64]
"""A number or an array of numbers."""


def plain(result: Numbers) -> Numbers:
    """A float of a single number, an array of anything else."""
    return float(result) if np.ndim(result) == 0 else np.asarray(result, dtype=np.float64)
