# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Poses, paths and the correction of the map to records."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from msss_graphslam.core.types import Array, MapCorrection, TwistError
from msss_graphslam.messages.fields import numbers, pose_of, stamp_of, time_of, vector_of
from msss_graphslam.messages.refusal import Refusal

__all__ = ["StampedPose", "correction", "last_pose", "moment", "path_poses", "stamped_pose"]

_PLANAR = np.ix_([0, 1, 5], [0, 1, 5])


@dataclass(frozen=True, slots=True)
class StampedPose:
    """A pose at one stamp: ``pose`` (6,) is x, y, z, roll, pitch, yaw."""

    stamp_ns: int
    pose: Array


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


def _planar_covariance(values: Any, name: str) -> Array:
    flat = numbers(values)
    if flat.shape != (36,):
        raise Refusal(f"{name}_covariance_size")
    covariance = flat.reshape(6, 6)[_PLANAR]
    if not np.isfinite(covariance).all():
        raise Refusal(f"{name}_not_finite")
    return np.asarray(covariance)
