# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The maps of a corrected trajectory: points by equation 5, and an occupancy grid."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from msss_graphslam.config.groups import Mapping
from msss_graphslam.core.compounding import transform_points
from msss_graphslam.core.maps.free_space import free_places, rays_of
from msss_graphslam.core.types import Array, Keyframe

__all__ = ["OccupancyGrid", "map_points", "occupancy_grid"]

UNKNOWN = -1
LARGEST_CELL_COUNT = 16_000_000


@dataclass(frozen=True, slots=True)
class OccupancyGrid:
    """Probabilities of occupation in ``map``, as in nav_msgs/OccupancyGrid.

    ``occupancy`` int8 (rows, columns): 0 free to 100 occupied, -1 unknown; row 0 is southmost,
    column 0 westmost. ``resolution`` is the edge of a cell [m], ``origin`` (2,) the south-west
    corner of the first cell [m].
    """

    occupancy: NDArray[np.int8]
    resolution: float
    origin: Array


def map_points(keyframes: Sequence[Keyframe]) -> Array:
    """Return all points (n, 3) in ``map`` [m], equation 5; z is the vehicle's height."""
    clouds = [
        np.column_stack(
            [
                transform_points(keyframe.pose, keyframe.scan.points),
                keyframe.scan.heights[keyframe.scan.beam_index],
            ]
        )
        for keyframe in keyframes
    ]
    return np.concatenate([np.zeros((0, 3)), *clouds])


def occupancy_grid(
    keyframes: Sequence[Keyframe], config: Mapping, sonar_position: ArrayLike = (0.0, 0.0)
) -> OccupancyGrid:
    """Return the occupancy grid of the scans in their final layout.

    A beam speaks for free water before its first return and for a wall at each return; it says
    nothing of what lies behind, and nothing without a return. A scan counts once a cell, and there
    a return outweighs what passed. Where the extent would need more than 16 million cells, they
    are made larger by powers of two, as ``resolution`` then says.

    Parameters
    ----------
    keyframes
        The optimised poses, and the scans as the corrected trajectory lays them out.
    config
        The cells and the beam's model.
    sonar_position
        (2,) ``sonar_link`` in ``base_link`` [m], from where the beams start.
    """
    position = np.asarray(sonar_position, dtype=float)
    scans = [
        (rays_of(keyframe, position), transform_points(keyframe.pose, keyframe.scan.points).T)
        for keyframe in keyframes
        if len(keyframe.scan.points)
    ]
    places = [np.concatenate([rays.starts.T, echoes], axis=1) for rays, echoes in scans]
    log_odds, origin, resolution = _empty_grid(places, config.resolution)
    for rays, echoes in scans:
        passed = free_places(rays, resolution, config.free_width)
        _add_scan(
            log_odds,
            _cells(passed, origin, resolution, log_odds.shape),
            _cells(echoes, origin, resolution, log_odds.shape),
            config,
        )
    return OccupancyGrid(_per_cent(log_odds), resolution, origin)


def _empty_grid(places: list[Array], resolution: float) -> tuple[Array, Array, float]:
    """Return log-odds of 0 over all places (2, n), the grid's origin and the edge of a cell."""
    if not places:
        return np.zeros((0, 0)), np.zeros(2), resolution
    low = np.min([part.min(axis=1) for part in places], axis=0)
    high = np.max([part.max(axis=1) for part in places], axis=0)
    while True:
        first = np.floor(low / resolution)
        columns, rows = np.floor(high / resolution) - first + 1.0
        if rows * columns <= LARGEST_CELL_COUNT:
            return np.zeros((int(rows), int(columns))), first * resolution, resolution
        resolution *= 2.0


def _cells(
    places: Array, origin: Array, resolution: float, shape: tuple[int, ...]
) -> NDArray[np.intp]:
    """Return the flat indices of the cells of those places (2, n) that lie on the grid."""
    column, row = np.floor((places - origin[:, None]) / resolution).astype(np.intp)
    inside = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1])
    return np.asarray(row[inside] * shape[1] + column[inside])


def _add_scan(
    log_odds: Array, passed: NDArray[np.intp], hit: NDArray[np.intp], config: Mapping
) -> None:
    """Update the cells in place; NumPy's indexed assignment counts a repeated cell once."""
    flat = log_odds.reshape(-1)
    hit_after = flat[hit] + _log_odds(config.hit_probability)
    flat[passed] += _log_odds(config.miss_probability)
    flat[hit] = hit_after


def _log_odds(probability: float) -> float:
    return float(np.log(probability / (1.0 - probability)))


def _per_cent(log_odds: Array) -> NDArray[np.int8]:
    probability = 0.5 * (1.0 + np.tanh(0.5 * log_odds))
    return np.where(log_odds == 0.0, UNKNOWN, np.rint(100.0 * probability)).astype(np.int8)
