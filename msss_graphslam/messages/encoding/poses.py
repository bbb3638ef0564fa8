# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Poses: odometry, ground truth, the corrected pose, paths and transforms."""

from collections.abc import Sequence
from typing import Any

from msss_graphslam.core.types import Array, Odometry, Trajectory
from msss_graphslam.messages.encoding.primitives import (
    Make,
    covariance_36,
    header,
    orientation,
    pose_of,
    vector,
)
from msss_graphslam.messages.frames import BASE_LINK, MAP, ODOM

__all__ = ["ground_truth", "odometry", "path", "pose", "tf_message", "transform"]


def odometry(
    make: Make, estimate: Odometry, frame_id: str = ODOM, child_frame_id: str = BASE_LINK
) -> Any:
    """Return dead reckoning as a nav_msgs/Odometry."""
    twist = make(
        "geometry_msgs/msg/Twist",
        linear=vector(make, estimate.twist[:3]),
        angular=vector(make, estimate.twist[3:]),
    )
    return make(
        "nav_msgs/msg/Odometry",
        header=header(make, estimate.stamp_ns, frame_id),
        child_frame_id=child_frame_id,
        pose=_with_covariance(make, estimate.pose, estimate.covariance),
        twist=make(
            "geometry_msgs/msg/TwistWithCovariance",
            twist=twist,
            covariance=covariance_36(estimate.twist_covariance),
        ),
    )


def ground_truth(
    make: Make,
    stamp_ns: int,
    true_pose: Array,
    frame_id: str = MAP,
    child_frame_id: str = BASE_LINK,
) -> Any:
    """Return the true pose (6,) as a nav_msgs/Odometry."""
    return make(
        "nav_msgs/msg/Odometry",
        header=header(make, stamp_ns, frame_id),
        child_frame_id=child_frame_id,
        pose=make("geometry_msgs/msg/PoseWithCovariance", pose=pose_of(make, true_pose)),
    )


def pose(
    make: Make, stamp_ns: int, estimate: Array, covariance: Array, frame_id: str = MAP
) -> Any:
    """Return a geometry_msgs/PoseWithCovarianceStamped.

    ``estimate`` is (6,) with a covariance (6, 6), or planar (3,) with (3, 3).
    """
    return make(
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        header=header(make, stamp_ns, frame_id),
        pose=_with_covariance(make, estimate, covariance),
    )


def path(make: Make, trajectory: Trajectory, frame_id: str = MAP) -> Any:
    """Return a nav_msgs/Path, stamped as its last pose."""
    poses = [
        make(
            "geometry_msgs/msg/PoseStamped",
            header=header(make, stamp, frame_id),
            pose=pose_of(make, row),
        )
        for stamp, row in zip(trajectory.stamps_ns.tolist(), trajectory.poses, strict=True)
    ]
    last_ns = int(trajectory.stamps_ns[-1]) if poses else 0
    return make("nav_msgs/msg/Path", header=header(make, last_ns, frame_id), poses=poses)


def transform(
    make: Make, stamp_ns: int, placement: Array, frame_id: str, child_frame_id: str
) -> Any:
    """Return a geometry_msgs/TransformStamped of the child's pose (6,) in the frame."""
    return make(
        "geometry_msgs/msg/TransformStamped",
        header=header(make, stamp_ns, frame_id),
        child_frame_id=child_frame_id,
        transform=make(
            "geometry_msgs/msg/Transform",
            translation=vector(make, placement[:3]),
            rotation=orientation(make, placement[3:]),
        ),
    )


def tf_message(make: Make, transforms: Sequence[Any]) -> Any:
    """Return a tf2_msgs/TFMessage of transforms made by ``transform``."""
    return make("tf2_msgs/msg/TFMessage", transforms=list(transforms))


def _with_covariance(make: Make, estimate: Array, covariance: Array) -> Any:
    return make(
        "geometry_msgs/msg/PoseWithCovariance",
        pose=pose_of(make, estimate),
        covariance=covariance_36(covariance),
    )
