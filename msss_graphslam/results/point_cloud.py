# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Point maps as binary PLY (Stanford polygon) files."""

from pathlib import Path

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.errors import UserError
from msss_graphslam.results.atomic import write_bytes

__all__ = ["read_points", "write_points"]

_HEADER = (
    "ply\nformat binary_little_endian 1.0\ncomment frame map, metres\nelement vertex {count}\n"
    "property float x\nproperty float y\nproperty float z\nend_header\n"
)
_END = b"end_header\n"


def write_points(path: Path, points: Array) -> None:
    """Write points (n, 2) or (n, 3) [m]; planar points get z = 0."""
    cloud = np.zeros((len(points), 3), dtype="<f4")
    cloud[:, : points.shape[1]] = points
    write_bytes(path, _HEADER.format(count=len(cloud)).encode() + cloud.tobytes())


def read_points(path: Path) -> Array:
    """Read the points (n, 3) [m] of a file that write_points made; UserError for any other."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from error
    header, end, body = content.partition(_END)
    count = len(body) // 12
    if header + end != _HEADER.format(count=count).encode() or len(body) != 12 * count:
        raise UserError(f"{path}: not a whole map.ply of this package")
    return np.frombuffer(body, dtype="<f4").reshape(-1, 3).astype(np.float64)
