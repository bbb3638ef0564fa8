# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Point clouds of scans and maps, and the occupancy grid."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array, Scan
from msss_graphslam.messages.encoding.primitives import Make, header, pose_of
from msss_graphslam.messages.frames import MAP

__all__ = ["map_cloud", "occupancy_grid", "scan_cloud"]

_FLOAT32 = 7  # sensor_msgs/PointField.FLOAT32
_SCAN_FIELDS = (
    "x",
    "y",
    "z",
    "covariance_xx",
    "covariance_xy",
    "covariance_yy",
    "time_offset",
)


def scan_cloud(make: Make, scan: Scan, frame_id: str) -> Any:
    """Return the scan's points in {I} as a sensor_msgs/PointCloud2.

    Each point carries its covariance [m^2] and its beam's time after the first beam [s].
    """
    stamps = scan.beam_stamps_ns[scan.beam_index]
    columns = [
        scan.points[:, 0],
        scan.points[:, 1],
        np.zeros(len(scan.points)),
        scan.covariances[:, 0, 0],
        scan.covariances[:, 0, 1],
        scan.covariances[:, 1, 1],
        (stamps - scan.stamp_ns) * 1e-9,
    ]
    return _cloud(make, scan.stamp_ns, frame_id, _SCAN_FIELDS, np.stack(columns, axis=-1))


def map_cloud(make: Make, stamp_ns: int, points: Array, frame_id: str = MAP) -> Any:
    """Return map points (n, 2) or (n, 3) [m] as a sensor_msgs/PointCloud2."""
    spatial = np.zeros((len(points), 3))
    spatial[:, : points.shape[1]] = points
    return _cloud(make, stamp_ns, frame_id, ("x", "y", "z"), spatial)


def occupancy_grid(
    make: Make,
    stamp_ns: int,
    cells: NDArray[np.int8],
    resolution: float,
    origin: Array,
    frame_id: str = MAP,
) -> Any:
    """Return a nav_msgs/OccupancyGrid.

    ``cells`` (height, width) hold 0..100 or -1 for unknown, the first row at the lowest y;
    ``origin`` (2,) is the outer corner of cell (0, 0) [m] and ``resolution`` a cell's edge [m].
    """
    height, width = cells.shape
    stamped = header(make, stamp_ns, frame_id)
    information = make(
        "nav_msgs/msg/MapMetaData",
        map_load_time=stamped.stamp,
        resolution=float(resolution),
        width=int(width),
        height=int(height),
        origin=pose_of(make, np.array([origin[0], origin[1], 0.0])),
    )
    data = np.ascontiguousarray(cells, dtype=np.int8).reshape(-1)
    return make("nav_msgs/msg/OccupancyGrid", header=stamped, info=information, data=data)


def _cloud(make: Make, stamp_ns: int, frame_id: str, names: tuple[str, ...], rows: Array) -> Any:
    data = np.ascontiguousarray(rows, dtype="<f4")
    step = 4 * len(names)
    fields = [
        make("sensor_msgs/msg/PointField", name=name, offset=4 * i, datatype=_FLOAT32, count=1)
        for i, name in enumerate(names)
    ]
    return make(
        "sensor_msgs/msg/PointCloud2",
        header=header(make, stamp_ns, frame_id),
        height=1,
        width=len(data),
        fields=fields,
        is_bigendian=False,
        point_step=step,
        row_step=step * len(data),
        data=data.reshape(-1).view(np.uint8),
        is_dense=True,
    )
