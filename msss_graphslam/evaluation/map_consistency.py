# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How sharp a map is, and how far its scans agree: measures that need no truth."""

from collections.abc import Sequence

import numpy as np
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
    neighbours = cKDTree(planar).query_ball_point(sample, _RADIUS)
    thicknesses = [
        _minor_axis(planar[indices]) for indices in neighbours if len(indices) > _FEWEST_NEIGHBOURS
    ]
    return float(np.median(thicknesses)) if thicknesses else None


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
    neighbours = cKDTree(places).query_ball_point(places[sample], _SAME_PLACE)
    pairs = zip(sample, neighbours, strict=True)
    return float(np.mean([np.any(scans[near] != scans[number]) for number, near in pairs]))


def _minor_axis(points: Array) -> float:
    variance = np.linalg.eigvalsh(np.cov(points.T))[0]
    return float(np.sqrt(max(variance, 0.0)))
