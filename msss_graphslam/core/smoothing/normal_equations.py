# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Sparse normal equations of planar poses, the first of which stays where it is."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.smoothing.pose_covariances import pose_covariances
from msss_graphslam.core.types import Array

__all__ = ["NormalEquations"]


class NormalEquations:
    """The sum of what measurements say of ``count`` poses: H x = -g.

    ``gradient`` (3 count,) is g.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        # Of all poses but the first: leaving it out later would take as much memory again.
        self._free: Any = None
        self.gradient = np.zeros(3 * count)
        self._factors: Any = None

    def add(self, nodes: NDArray[np.intp], information: Array, gradient: Array) -> None:
        """Add m measurements of k poses each, ``nodes`` (m, k); one may name a pose twice.

        ``information`` (m, 3k, 3k) and ``gradient`` (m, 3k).
        """
        # It holds memory that a node does without until the end.
        from scipy.sparse import csc_matrix

        width = 3 * nodes.shape[1]
        places = (3 * nodes[:, :, None] + np.arange(3)).astype(np.int32).reshape(-1, width)
        np.add.at(self.gradient, places, gradient)
        rows, columns = np.repeat(places, width, axis=1).ravel(), np.tile(places, width).ravel()
        free = np.minimum(rows, columns) >= 3
        entries = information.ravel()[free], (rows[free] - 3, columns[free] - 3)
        size = 3 * (self._count - 1)
        added = csc_matrix(entries, shape=(size, size))
        self._free = added if self._free is None else self._free + added
        self._factors = None

    def solution(self) -> Array:
        """Return the steps (count - 1, 3) of all poses but the first.

        Raises RuntimeError where the measurements leave one undetermined.
        """
        return -self.solved(self.gradient)[3:].reshape(-1, 3)

    def solved(self, sides: Array) -> Array:
        """Return x of H x = b for ``sides`` b (3 count,) or (3 count, p); the first pose's is 0.

        Raises RuntimeError where the measurements leave one undetermined.
        """
        result = np.zeros_like(sides)
        result[3:] = self._factorised().solve(sides[3:])
        return result

    def covariances(self) -> Array:
        """Return the covariances (count, 3, 3) of the poses, the first one's being zero."""
        self._factors = None  # They take memory, and are no help here.
        result = np.zeros((self._count, 3, 3))
        result[1:] = pose_covariances(self._free)
        return result

    def covariance_of_last(self, count: int) -> Array:
        """Return the covariance (3 count, 3 count) of the last poses together."""
        size, width = 3 * (self._count - 1), 3 * count
        result = np.zeros((width, width))
        free = min(size, width)
        columns = self._factorised().solve(np.eye(size, free, free - size))
        result[-free:, -free:] = columns[-free:]
        return 0.5 * (result + result.T)

    def _factorised(self) -> Any:
        if self._factors is None:
            from scipy.sparse.linalg import splu

            # Symmetric and positive definite: the diagonal is as good a pivot as any.
            self._factors = splu(
                self._free,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        return self._factors
