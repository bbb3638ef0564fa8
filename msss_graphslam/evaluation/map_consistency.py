# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How sharp a map is, and how far its scans agree: measures that need no truth."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from msss_graphslam.core.types import Array

__all__ = ["seen_again", "wall_thickness"]

_RADIUS = 0.5
_FEWEST_NEIGHBOURS = 8
_LARGEST_SAMPLE = 2000
_SAME_PLACE = 0.25


def wall_thickness(points: Array) -> float | None:
    """Return the median thickness [m] of the walls that map points (n, 2) [m] make.

    The thickness at a point is the standard deviation of its neighbours within 0.5 m along their
    minor axis; points with fewer than eight neighbours are specks, no wall. At most 2000 points,
    evenly spread over the map's order, are looked at. None where there is no wall. A blurred map
    is thick, but a thin map may still be wrong: it rejects and does not rank.
    """
    planar = np.asarray(points, dtype=float)[:, :2]
    if not len(planar):
        return None
    sample = planar[:: -(-len(planar) // _LARGEST_SAMPLE)]
    of, other = _near(sample, planar, _RADIUS)
    steps = planar[other] - sample[of]
    thicknesses = _minor_axes(of, steps, len(sample))
    return float(np.median(thicknesses)) if len(thicknesses) else None


def seen_again(clouds: Sequence[Array]) -> float | None:
    """Return the share of all points that lie within 0.25 m of another scan's point.

    ``clouds`` are the points (n, 2) [m] of each scan in the map. A wall drawn twice, side by side,
    is as thin as one; this tells them apart. At most 2000 points are looked at. None without two
    scans that have points.
    """
    filled = [np.asarray(cloud, dtype=float)[:, :2] for cloud in clouds if len(cloud)]
    if len(filled) < 2:
        return None
    places = np.concatenate(filled)
    scans = np.repeat(np.arange(len(filled)), [len(cloud) for cloud in filled])
    sample = np.arange(0, len(places), -(-len(places) // _LARGEST_SAMPLE))
    of, other = _near(places[sample], places, _SAME_PLACE)
    elsewhere = of[scans[other] != scans[sample[of]]]
    return float(np.mean(np.bincount(elsewhere, minlength=len(sample)) > 0))


def _near(
    sample: Array, points: Array, radius: float
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the rows (p,) of all pairs of a sample's point and a point no farther than that."""
    pairs = cKDTree(sample).sparse_distance_matrix(cKDTree(points), radius, output_type="ndarray")
    return pairs["i"], pairs["j"]


def _minor_axes(of: NDArray[np.intp], steps: Array, count: int) -> Array:
    """Return the standard deviation [m] along the minor axis for each that has neighbours enough.

    ``steps`` (p, 2) [m] lead to the neighbours, that of the row ``of`` (p,) below ``count`` each.
    """

    def total(values: Array) -> Array:
        return np.asarray(np.bincount(of, values, minlength=count)[is_wall], dtype=float)

    neighbours = np.bincount(of, minlength=count)
    is_wall = neighbours > _FEWEST_NEIGHBOURS
    number = neighbours[is_wall]
    x, y = steps.T
    mean_x, mean_y = total(x) / number, total(y) / number
    square_x = total(x * x) - number * mean_x**2
    square_y = total(y * y) - number * mean_y**2
    product = total(x * y) - number * mean_x * mean_y
    minor = 0.5 * (square_x + square_y) - np.hypot(0.5 * (square_x - square_y), product)
    return np.asarray(np.sqrt(np.maximum(minor, 0.0) / (number - 1)))
