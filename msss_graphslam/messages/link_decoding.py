# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes tell each other back to records; what cannot be used raises Refusal.

No bytes of a message can make a record with a number that is not finite.
"""

import re
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from typing import Any

import numpy as np

from msss_graphslam.core.scans.scan_generation import reckoned_scan
from msss_graphslam.core.types import (
    Array,
    Constraint,
    ConstraintKind,
    GraphPoses,
    KeyframeReport,
    MapCorrection,
    Odometry,
    Scan,
    TwistError,
)
from msss_graphslam.messages.columns import BEAMS, POSES, SETTLED, read_columns, read_stamps
from msss_graphslam.messages.fields import numbers, pose_of, stamp_of, time_of, vector_of
from msss_graphslam.messages.refusal import Refusal

__all__ = [
    "SettledOdometry",
    "StampedPose",
    "correction",
    "graph_poses",
    "last_pose",
    "moment",
    "path_poses",
    "scan_beams",
    "settled_odometry",
    "stamped_pose",
    "tried",
]

_PLANAR = np.ix_([0, 1, 5], [0, 1, 5])
_KEYFRAME = re.compile(r"keyframe_([0-9]{1,9})")
_EDGE = re.compile(r"keyframe_([0-9]{1,9}) -> keyframe_([0-9]{1,9})")
_FIGURE = "figure/"


@dataclass(frozen=True, slots=True)
class SettledOdometry:
    """Dead reckoning that stays as it is: ``entries`` in order of their stamps.

    ``stamp_ns`` is how far dead reckoning has taken its input.
    """

    stamp_ns: int
    entries: tuple[Odometry, ...]


@dataclass(frozen=True, slots=True)
class StampedPose:
    """A pose at one stamp: ``pose`` (6,) is x, y, z, roll, pitch, yaw."""

    stamp_ns: int
    pose: Array


def settled_odometry(message: Any) -> SettledOdometry:
    """Return the entries of ``encoding.settled_odometry``."""
    name = "settled_odometry"
    rows = read_columns(message, SETTLED, name)
    stamps = read_stamps(rows, name)
    if (np.diff(stamps) <= 0).any():
        raise Refusal("settled_odometry_stamps_not_increasing")
    columns = zip(
        stamps.tolist(),
        rows["pose"].copy(),
        rows["covariance"].reshape(-1, 6, 6),
        rows["twist"].copy(),
        rows["twist_covariance"].reshape(-1, 6, 6),
        strict=True,
    )
    return SettledOdometry(stamp_of(message, name), tuple(Odometry(*row) for row in columns))


def scan_beams(message: Any) -> Scan:
    """Return the scan of ``encoding.scan_beams``, laid out by dead reckoning."""
    rows = read_columns(message, BEAMS, "scan_beams")
    stamps = read_stamps(rows, "scan_beams")
    if len(rows) < 2:
        raise Refusal("scan_beams_without_beams")
    beams_ns, end_ns = stamps[:-1], int(stamps[-1])
    if (np.diff(beams_ns) <= 0).any() or end_ns < beams_ns[-1]:
        raise Refusal("scan_beams_stamps_not_increasing")
    if stamp_of(message, "scan_beams") != beams_ns[0]:
        raise Refusal("scan_beams_stamp_differs")
    hits = np.flatnonzero(rows["echo"][:-1])
    with np.errstate(all="ignore"):  # what overflows is refused
        scan = reckoned_scan(
            beam_stamps_ns=beams_ns,
            end_stamp_ns=end_ns,
            reckoned=rows["reckoned"].copy(),
            twist_covariance=rows["twist_covariance"][0].reshape(3, 3).copy(),
            beam_index=hits,
            body_points=rows["body_point"][hits],
            body_covariances=rows["body_covariance"][hits].reshape(-1, 2, 2),
            complete=bool(rows["complete"][0]),
            usable=bool(rows["usable"][0]),
        )
    laid_out = (scan.motion, scan.motion_covariances, scan.points, scan.covariances)
    if not all(np.isfinite(values).all() for values in laid_out):
        raise Refusal("scan_beams_not_finite")
    return scan


def graph_poses(message: Any) -> GraphPoses:
    """Return the keyframes of ``encoding.graph_poses``."""
    rows = read_columns(message, POSES, "graph_poses")
    stamps = read_stamps(rows, "graph_poses")
    if (np.diff(stamps) <= 0).any():
        raise Refusal("graph_poses_stamps_not_increasing")
    return GraphPoses(
        stamps_ns=stamps,
        poses=rows["pose"].copy(),
        odometry=rows["odometry"].copy(),
        covariances=rows["covariance"].reshape(-1, 3, 3),
    )


def tried(message: Any) -> KeyframeReport:
    """Return the report of ``encoding.tried``."""
    if not message.status:
        raise Refusal("tried_without_keyframe")
    keyframe, *edges = message.status
    named = _KEYFRAME.fullmatch(keyframe.name)
    if named is None:
        raise Refusal("tried_names")
    number, values = int(named[1]), _values(keyframe)
    return KeyframeReport(
        number=number,
        stamp_ns=stamp_of(message, "tried"),
        pose=_row(values, "pose", 3),
        odometry=_row(values, "odometry", 3),
        twist_error=TwistError(
            _row(values, "twist_error", 3),
            _row(values, "twist_error_covariance", 9).reshape(3, 3),
        ),
        constraints=tuple(_constraint(status, number) for status in edges),
    )


def correction(message: Any) -> MapCorrection:
    """Return the correction of ``encoding.correction``."""
    name = "correction"
    placed = stamped_pose(message, name)
    twist = message.twist.twist
    linear = vector_of(twist.linear, "correction_not_finite")
    angular = vector_of(twist.angular, "correction_not_finite")
    mean = np.array([linear[0], linear[1], angular[2]])
    error = TwistError(mean, _planar_covariance(message.twist.covariance, name))
    covariance = _planar_covariance(message.pose.covariance, name)
    return MapCorrection(placed.stamp_ns, placed.pose[[0, 1, 5]], covariance, error)


def stamped_pose(message: Any, name: str = "pose") -> StampedPose:
    """Return the pose of a geometry_msgs/PoseWithCovarianceStamped; ``name`` is for refusals."""
    placed = message.pose.pose
    pose = pose_of(placed.position, placed.orientation, name)
    return StampedPose(stamp_of(message, name), pose)


def moment(message: Any) -> int:
    """Return the stamp [ns] of a std_msgs/Header, which is all that it says."""
    return time_of(message, "moment")


def last_pose(message: Any) -> StampedPose:
    """Return the last pose of a nav_msgs/Path."""
    if not message.poses:
        raise Refusal("path_without_poses")
    return _path_pose(message.poses[-1])


def path_poses(message: Any) -> list[StampedPose]:
    """Return the poses of a nav_msgs/Path in the order of their stamps."""
    poses = [_path_pose(placed) for placed in message.poses]
    if any(later.stamp_ns <= earlier.stamp_ns for earlier, later in pairwise(poses)):
        raise Refusal("path_stamps_not_increasing")
    return poses


def _path_pose(message: Any) -> StampedPose:
    pose = pose_of(message.pose.position, message.pose.orientation, "path")
    return StampedPose(stamp_of(message, "path"), pose)


def _constraint(status: Any, number: int) -> Constraint:
    named = _EDGE.fullmatch(status.name)
    if named is None or not int(named[1]) < int(named[2]) == number:
        raise Refusal("tried_names")
    if status.hardware_id not in set(ConstraintKind):
        raise Refusal("tried_kind")
    if (status.level in (0, b"\x00")) != (not status.message):
        raise Refusal("tried_level")
    values = _values(status)
    return Constraint(
        kind=ConstraintKind(status.hardware_id),
        first=int(named[1]),
        second=number,
        relative_pose=_row(values, "relative_pose", 3),
        covariance=_row(values, "covariance", 9).reshape(3, 3),
        refusal=status.message,
        figures={
            key.removeprefix(_FIGURE): float(_row(values, key, 1)[0])
            for key in values
            if key.startswith(_FIGURE)
        },
    )


def _values(status: Any) -> dict[str, str]:
    return {entry.key: entry.value for entry in status.values}


def _row(values: dict[str, str], key: str, size: int) -> Array:
    """Return the numbers (size,) that stand under the key."""
    words = values.get(key, "").split()
    if len(words) != size:
        raise Refusal("tried_values")
    try:
        row = [float(word) for word in words]
    except ValueError:
        raise Refusal("tried_values") from None
    if not all(map(isfinite, row)):
        raise Refusal("tried_not_finite")
    return np.array(row)


def _planar_covariance(values: Any, name: str) -> Array:
    flat = numbers(values)
    if flat.shape != (36,):
        raise Refusal(f"{name}_covariance_size")
    covariance = flat.reshape(6, 6)[_PLANAR]
    if not np.isfinite(covariance).all():
        raise Refusal(f"{name}_not_finite")
    return np.asarray(covariance)
