# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Shape matching by angle histograms of vectors, equations 12 and 13 (the paper's [27])."""

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array

__all__ = ["shape_descriptor", "shape_distance"]

BINS = 36
LARGEST_POINT_COUNT = 60
ROWS = 15
"""So many histograms are compared at once with all others: what they need fits into the cache."""


def shape_descriptor(points: Array, yaw: float) -> Array:
    """Return the angle histograms (K, N) of a scan, one for each of K <= 60 of its points.

    Row i is the share of the vectors from point i to all others in each of N = 36 directions.

    Parameters
    ----------
    points
        (n, 2) points of the scan in its own frame [m]; evenly thinned by index to K.
    yaw
        Estimated heading of the scan's frame in the world [rad]. The histograms are not rotation
        invariant: directions are taken in the world, so that revisits on another heading compare.
    """
    points = _thinned(points)
    vectors = points[None, :] - points[:, None]
    turns = (np.arctan2(vectors[..., 1], vectors[..., 0]) + yaw) / (2.0 * np.pi)
    bins = np.floor(turns % 1.0 * BINS).astype(np.intp) % BINS
    rows = np.arange(len(points))[:, None]
    distinct = np.any(vectors != 0.0, axis=-1)
    counts = np.bincount((rows * BINS + bins)[distinct], minlength=len(points) * BINS)
    histograms = counts.reshape(len(points), BINS)
    return np.asarray(histograms / np.maximum(histograms.sum(axis=1, keepdims=True), 1))


def shape_distance(first: Array, second: Array) -> float:
    """Return the distance (13) of two descriptors (K1, N), (K2, N): 0 equal, 2 disjoint.

    It is infinite where a scan has no points: nothing then speaks for the same place.
    """
    if not len(first) or not len(second):
        return float("inf")
    # Deviation: (13) prints arg min; the sum is over the smallest costs, as [27] has it.
    costs = _matching_costs(first, second)
    return float(costs.min(axis=1).mean() + costs.min(axis=0).mean())


def _matching_costs(first: Array, second: Array) -> NDArray[np.float32]:
    """Return the cost (12) of every pair of histograms, (K1, K2); 0 / 0 counts as 0.

    Single precision halves the time and is far finer than one vector's share of a histogram.
    """
    first, second = first.astype(np.float32), second.astype(np.float32)
    positive = second + np.finfo(np.float32).tiny
    costs = np.empty((len(first), len(second)), np.float32)
    for start in range(0, len(first), ROWS):
        rows = first[start : start + ROWS, None]
        difference, ratio = rows - second, rows + positive
        np.divide(difference, ratio, out=ratio)
        np.einsum("ijk,ijk->ij", difference, ratio, out=costs[start : start + ROWS])
    return np.asarray(np.float32(0.5) * costs)


def _thinned(points: Array) -> Array:
    count = min(len(points), LARGEST_POINT_COUNT)
    return points[np.linspace(0, len(points) - 1, count).round().astype(np.intp)]
