# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How sharp a map is: a measure that needs no truth."""

import numpy as np
from scipy.spatial import cKDTree

from msss_graphslam.core.types import Array

__all__ = ["wall_thickness"]

_RADIUS = 0.5
_FEWEST_NEIGHBOURS = 8
_LARGEST_SAMPLE = 2000


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
    neighbours = cKDTree(planar).query_ball_point(sample, _RADIUS)
    thicknesses = [
        _minor_axis(planar[indices]) for indices in neighbours if len(indices) > _FEWEST_NEIGHBOURS
    ]
    return float(np.median(thicknesses)) if thicknesses else None


def _minor_axis(points: Array) -> float:
    variance = np.linalg.eigvalsh(np.cov(points.T))[0]
    return float(np.sqrt(max(variance, 0.0)))
