# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Sparse normal equations of planar poses, the first of which stays where it is."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array

__all__ = ["NormalEquations"]

AT_ONCE = 64
"""Poses whose covariances are solved for together: bounds the memory, not the result."""


class NormalEquations:
    """The sum of what measurements say of ``count`` poses: H x = -g."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._rows: list[NDArray[np.intp]] = []
        self._columns: list[NDArray[np.intp]] = []
        self._entries: list[Array] = []
        self._gradient = np.zeros(3 * count)
        self._factors: Any = None

    def add(self, nodes: list[int], information: Array, gradient: Array) -> None:
        """Add a measurement of k poses: (3k, 3k) and (3k,); a pose may be named twice."""
        places = (3 * np.array(nodes)[:, None] + np.arange(3)).ravel()
        self._rows.append(np.repeat(places, len(places)))
        self._columns.append(np.tile(places, len(places)))
        self._entries.append(information.ravel())
        np.add.at(self._gradient, places, gradient)
        self._factors = None

    def solution(self) -> Array:
        """Return the steps (count - 1, 3) of all poses but the first.

        Raises RuntimeError where the measurements leave one undetermined.
        """
        return np.asarray(-self._solve(self._gradient[3:])).reshape(-1, 3)

    def covariances(self) -> Array:
        """Return the covariances (count, 3, 3) of the poses, the first one's being zero."""
        result = np.zeros((self._count, 3, 3))
        size = 3 * (self._count - 1)
        for start in range(0, size, 3 * AT_ONCE):
            stop = min(start + 3 * AT_ONCE, size)
            columns = self._solve(np.eye(size, stop - start, -start))
            for place in range(start, stop, 3):
                own = columns[place : place + 3, place - start : place - start + 3]
                result[place // 3 + 1] = 0.5 * (own + own.T)
        return result

    def covariance_of_last(self, count: int) -> Array:
        """Return the covariance (3 count, 3 count) of the last poses together."""
        size, width = 3 * (self._count - 1), 3 * count
        result = np.zeros((width, width))
        free = min(size, width)
        columns = self._solve(np.eye(size, free, free - size))
        result[-free:, -free:] = columns[-free:]
        return 0.5 * (result + result.T)

    def _solve(self, right: Array) -> Array:
        if self._factors is None:
            # It holds memory that a node does without until the end.
            from scipy.sparse import csc_matrix
            from scipy.sparse.linalg import splu

            places = np.concatenate(self._rows), np.concatenate(self._columns)
            size = 3 * self._count
            whole = csc_matrix((np.concatenate(self._entries), places), shape=(size, size))
            self._factors = splu(whole[3:, 3:])
        return np.asarray(self._factors.solve(right))
