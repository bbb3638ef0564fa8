# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that grow with the mission, made as bytes.

An object for each of ten thousand poses takes tens of times as long as their numbers in one
piece. A test compares the bytes with those of the same message made of objects.
"""

from collections.abc import Sequence

import numpy as np

from msss_graphslam.core.types import Array, Constraint, Trajectory
from msss_graphslam.messages.encoding.cdr import CdrWriter
from msss_graphslam.messages.encoding.graph import MARKERS, MarkerStyle, marker_points
from msss_graphslam.messages.frames import MAP

__all__ = ["graph_markers", "path", "quaternions"]

_NANOSECONDS = 1_000_000_000
_STAMP_AND_LENGTH = 12
_MARKER_ADDED = 0


def path(trajectory: Trajectory, frame_id: str = MAP) -> bytes:
    """Return a nav_msgs/Path, stamped as its last pose."""
    stamps = trajectory.stamps_ns
    writer = CdrWriter()
    writer.header(int(stamps[-1]) if len(stamps) else 0, frame_id)
    writer.numbers("I", len(stamps))
    if len(stamps):
        # A row is a pose and the header of the next one: so each begins at a multiple of 8.
        writer.header(int(stamps[0]), frame_id)
        rows = _rows(trajectory, frame_id.encode() + b"\x00")
        writer.rows(rows, left_out=rows.itemsize - rows.dtype["pose"].itemsize)
    return writer.data


def graph_markers(
    stamp_ns: int,
    poses: Array,
    constraints: Sequence[Constraint],
    frame_id: str = MAP,
) -> bytes:
    """Return nodes, odometry edges, loop closures and refused closures as a MarkerArray.

    ``poses`` (n, 3) are the keyframes' x, y, yaw; an edge to a keyframe without one is left out.
    """
    points = marker_points(poses, constraints)
    writer = CdrWriter()
    writer.numbers("I", len(points))
    for name, places in points.items():
        writer.header(stamp_ns, frame_id)
        writer.text(name)
        _write_marker(writer, MARKERS[name], places)
    return writer.data


def _rows(trajectory: Trajectory, frame: bytes) -> np.ndarray[tuple[int], np.dtype[np.void]]:
    space = -(-(_STAMP_AND_LENGTH + len(frame)) // 8) * 8 - _STAMP_AND_LENGTH
    fields = [("pose", "<f8", 7), ("stamp", "<u4", 2), ("length", "<u4"), ("frame", f"S{space}")]
    rows = np.zeros(len(trajectory.stamps_ns), dtype=fields)
    rows["pose"][:, :3] = trajectory.poses[:, :3]
    rows["pose"][:, 3:] = quaternions(trajectory.poses[:, 3:])
    rows["stamp"][:-1] = np.stack(np.divmod(trajectory.stamps_ns[1:], _NANOSECONDS), axis=-1)
    rows["length"], rows["frame"] = len(frame), frame
    return rows


def quaternions(angles: Array) -> Array:
    """Return x, y, z, w (n, 4) of roll, pitch, yaw (n, 3) [rad]; see ``primitives.quaternion``."""
    cr, cp, cy = np.cos(angles.T / 2.0)
    sr, sp, sy = np.sin(angles.T / 2.0)
    components = [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
    return np.stack(components, axis=-1)


def _write_marker(writer: CdrWriter, style: MarkerStyle, places: Array) -> None:
    """Write what follows the name: fields that only other kinds of markers use are empty."""
    writer.numbers("i", 0, style.kind, _MARKER_ADDED)
    writer.numbers("d", 0, 0, 0, 0, 0, 0, 1, style.size, style.size, style.size)
    writer.numbers("f", *style.colour)
    writer.numbers("i", 0, 0)  # lifetime: for ever
    writer.numbers("B", 0)
    writer.numbers("I", len(places))
    writer.rows(np.ascontiguousarray(places, dtype="<f8"))
    writer.numbers("I", 0)  # colours of the points
    writer.text("")
    writer.header(0, "")  # texture
    writer.text("")
    writer.numbers("I", 0, 0)
    writer.text("", "", "")
    writer.numbers("I", 0)
    writer.numbers("B", 0)
