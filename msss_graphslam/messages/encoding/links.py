# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes tell each other, without loss; ``messages.link_decoding`` gives it back."""

from collections.abc import Sequence
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import (
    Array,
    Constraint,
    GraphPoses,
    KeyframeReport,
    MapCorrection,
    Odometry,
    Scan,
)
from msss_graphslam.messages.columns import BEAMS, DATATYPES, POSES, SETTLED, set_stamps
from msss_graphslam.messages.encoding.primitives import Make, covariance_36, header, pose_of
from msss_graphslam.messages.frames import BASE_LINK, MAP, ODOM

__all__ = ["correction", "graph_poses", "moment", "scan_beams", "settled_odometry", "tried"]

# diagnostic_msgs/DiagnosticStatus
_OK, _WARN = 0, 1


def moment(make: Make, stamp_ns: int) -> Any:
    """Return a stamp alone, as a std_msgs/Header."""
    return header(make, stamp_ns, "")


def settled_odometry(make: Make, stamp_ns: int, entries: Sequence[Odometry]) -> Any:
    """Return settled dead reckoning as a sensor_msgs/PointCloud2, a row an entry.

    ``stamp_ns`` is how far dead reckoning has taken its input.
    """
    rows = np.zeros(len(entries), dtype=SETTLED)
    set_stamps(rows, np.array([entry.stamp_ns for entry in entries], dtype=np.int64))
    for row, entry in zip(rows, entries, strict=True):
        row["pose"], row["covariance"] = entry.pose, entry.covariance.reshape(36)
        row["twist"], row["twist_covariance"] = entry.twist, entry.twist_covariance.reshape(36)
    return _cloud(make, stamp_ns, ODOM, rows)


def scan_beams(make: Make, scan: Scan) -> Any:
    """Return what was measured in the scan as a sensor_msgs/PointCloud2 in ``odom``.

    A row is a beam; the last one is the end of the turn. Raises ValueError where a beam has more
    than one point.
    """
    if (np.diff(scan.beam_index) <= 0).any():
        raise ValueError("a beam of the scan has more than one point, or they are out of order")
    rows = np.zeros(len(scan.reckoned), dtype=BEAMS)
    set_stamps(rows, np.append(scan.beam_stamps_ns, scan.end_stamp_ns))
    rows["reckoned"] = scan.reckoned
    rows["echo"][scan.beam_index] = 1
    rows["body_point"][scan.beam_index] = scan.body_points
    rows["body_covariance"][scan.beam_index] = scan.body_covariances.reshape(-1, 4)
    rows["twist_covariance"] = scan.twist_covariance.reshape(9)
    rows["complete"], rows["usable"] = scan.complete, scan.usable
    return _cloud(make, scan.stamp_ns, ODOM, rows)


def graph_poses(make: Make, graph: GraphPoses) -> Any:
    """Return all keyframes as a sensor_msgs/PointCloud2 in ``map``, stamped as the newest."""
    rows = np.zeros(len(graph.stamps_ns), dtype=POSES)
    set_stamps(rows, graph.stamps_ns)
    rows["pose"], rows["odometry"] = graph.poses, graph.odometry
    rows["covariance"] = graph.covariances.reshape(-1, 9)
    newest_ns = int(graph.stamps_ns[-1]) if len(rows) else 0
    return _cloud(make, newest_ns, MAP, rows)


def tried(make: Make, report: KeyframeReport) -> Any:
    """Return a keyframe and the constraints tried to it as a diagnostic_msgs/DiagnosticArray.

    Status 0 is the keyframe. Each other one is a constraint: its kind as ``hardware_id``, why it
    was refused as ``message``, and the gates' values among the ``values`` as ``figure/<name>``;
    a figure that is not finite is left out.
    """
    keyframe = {
        "pose": _text(report.pose),
        "odometry": _text(report.odometry),
        "twist_error": _text(report.twist_error.mean),
        "twist_error_covariance": _text(report.twist_error.covariance),
    }
    name = f"keyframe_{report.number}"
    status = [_status(make, name, keyframe)]
    status += [_tried_constraint(make, edge) for edge in report.constraints]
    return make(
        "diagnostic_msgs/msg/DiagnosticArray",
        header=header(make, report.stamp_ns, MAP),
        status=status,
    )


def correction(make: Make, placed: MapCorrection) -> Any:
    """Return where the newest scan's middle lies as a nav_msgs/Odometry.

    Its twist is the error of dead reckoning's twist that the sonar has shown.
    """
    surge, sway, yaw_rate = placed.twist_error.mean.tolist()
    twist = make(
        "geometry_msgs/msg/Twist",
        linear=make("geometry_msgs/msg/Vector3", x=surge, y=sway, z=0.0),
        angular=make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=yaw_rate),
    )
    return make(
        "nav_msgs/msg/Odometry",
        header=header(make, placed.stamp_ns, MAP),
        child_frame_id=BASE_LINK,
        pose=make(
            "geometry_msgs/msg/PoseWithCovariance",
            pose=pose_of(make, placed.pose),
            covariance=covariance_36(placed.covariance),
        ),
        twist=make(
            "geometry_msgs/msg/TwistWithCovariance",
            twist=twist,
            covariance=covariance_36(placed.twist_error.covariance),
        ),
    )


def _tried_constraint(make: Make, edge: Constraint) -> Any:
    values = {
        "relative_pose": _text(edge.relative_pose),
        "covariance": _text(edge.covariance),
        **{
            f"figure/{name}": repr(float(figure))
            for name, figure in edge.figures.items()
            if isfinite(figure)
        },
    }
    name = f"keyframe_{edge.first} -> keyframe_{edge.second}"
    return _status(make, name, values, hardware_id=edge.kind.value, message=edge.refusal)


def _status(
    make: Make, name: str, values: dict[str, str], hardware_id: str = "", message: str = ""
) -> Any:
    level = _WARN if message else _OK
    # A byte is bytes to rclpy and a number to the bag library.
    is_bytes = isinstance(make("diagnostic_msgs/msg/DiagnosticStatus").level, bytes)
    return make(
        "diagnostic_msgs/msg/DiagnosticStatus",
        level=bytes([level]) if is_bytes else level,
        name=name,
        hardware_id=hardware_id,
        message=message,
        values=[
            make("diagnostic_msgs/msg/KeyValue", key=key, value=value)
            for key, value in values.items()
        ],
    )


def _text(numbers: Array) -> str:
    return " ".join(map(repr, numbers.reshape(-1).tolist()))


def _cloud(make: Make, stamp_ns: int, frame_id: str, rows: NDArray[np.void]) -> Any:
    step = rows.dtype.itemsize
    return make(
        "sensor_msgs/msg/PointCloud2",
        header=header(make, stamp_ns, frame_id),
        height=1,
        width=len(rows),
        fields=[_field(make, rows.dtype, name) for name in rows.dtype.names or ()],
        is_bigendian=False,
        point_step=step,
        row_step=step * len(rows),
        data=np.frombuffer(rows.tobytes(), dtype=np.uint8),
        is_dense=True,
    )


def _field(make: Make, layout: np.dtype[np.void], name: str) -> Any:
    kind = layout[name]
    return make(
        "sensor_msgs/msg/PointField",
        name=name,
        offset=int(layout.fields[name][1]) if layout.fields else 0,
        datatype=DATATYPES[kind.base.str[1:]],
        count=int(np.prod(kind.shape, dtype=int)),
    )
