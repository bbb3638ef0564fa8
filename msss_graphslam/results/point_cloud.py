# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Point maps as binary PLY (Stanford polygon) files."""

from pathlib import Path

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.results.atomic import write_bytes

__all__ = ["write_points"]

_HEADER = (
    "ply\nformat binary_little_endian 1.0\ncomment frame map, metres\nelement vertex {count}\n"
    "property float x\nproperty float y\nproperty float z\nend_header\n"
)


def write_points(path: Path, points: Array) -> None:
    """Write points (n, 2) or (n, 3) [m]; planar points get z = 0."""
    cloud = np.zeros((len(points), 3), dtype="<f4")
    cloud[:, : points.shape[1]] = points
    write_bytes(path, _HEADER.format(count=len(cloud)).encode() + cloud.tobytes())
