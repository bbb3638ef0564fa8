# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The occupancy grid in the format of map_server: an image and a YAML file that places it."""

from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from msss_graphslam.core.maps.mapping import OccupancyGrid
from msss_graphslam.results.atomic import write_bytes, write_text

__all__ = ["write_occupancy_map"]

_OCCUPIED_THRESHOLD = 0.65
_FREE_THRESHOLD = 0.196
_OCCUPIED, _FREE, _UNKNOWN = 0, 254, 205
"""Grey values of map_server's "trinary" mode."""


def write_occupancy_map(image: Path, description: Path, grid: OccupancyGrid) -> None:
    """Write the image (binary PGM, north up) and its description.

    A grid without cells becomes one unknown cell, since no reader takes an empty image.
    """
    occupancy = grid.occupancy if grid.occupancy.size else np.full((1, 1), -1, dtype=np.int8)
    rows, columns = occupancy.shape
    header = f"P5\n{columns} {rows}\n255\n".encode()
    write_bytes(image, header + _grey(occupancy)[::-1].tobytes())
    write_text(description, yaml.safe_dump(_description(image.name, grid), sort_keys=False))


def _grey(occupancy: NDArray[np.int8]) -> NDArray[np.uint8]:
    grey = np.full(occupancy.shape, _UNKNOWN, dtype=np.uint8)
    grey[occupancy > 100 * _OCCUPIED_THRESHOLD] = _OCCUPIED
    grey[(occupancy >= 0) & (occupancy < 100 * _FREE_THRESHOLD)] = _FREE
    return grey


def _description(image: str, grid: OccupancyGrid) -> dict[str, object]:
    return {
        "image": image,
        "mode": "trinary",
        "resolution": float(grid.resolution),
        "origin": [float(grid.origin[0]), float(grid.origin[1]), 0.0],
        "negate": 0,
        "occupied_thresh": _OCCUPIED_THRESHOLD,
        "free_thresh": _FREE_THRESHOLD,
    }
