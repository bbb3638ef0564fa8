# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Vectors of the plane as complex numbers x + i y.

The real part of conj(a) b is the dot product; a turn by an angle is the product with exp(i angle).
"""

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array

__all__ = ["Numbers", "Vectors", "along", "vectors"]

Vectors = NDArray[np.complex128]

Numbers = NDArray[np.intp]
"""Of rows, one each."""


def vectors(rows: Array) -> Vectors:
    """Return the first two columns of ``rows`` (n, 2 or more)."""
    return np.asarray(rows[:, 0] + 1j * rows[:, 1])


def along(across: Vectors, moves: Array) -> Array:
    """Return the parts (n, 3) of moves (n, 2, 3) along normals; ``across`` is their conjugate."""
    return np.asarray(across.real[:, None] * moves[:, 0] - across.imag[:, None] * moves[:, 1])
