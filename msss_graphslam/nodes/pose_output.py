# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Odometry, corrected pose and both frames, published together."""

import numpy as np

from msss_graphslam.core.compounding import carried_over
from msss_graphslam.core.types import Array, Odometry
from msss_graphslam.messages import encoding, frames, topics
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.moulds import Mould
from msss_graphslam.ros.node import SlamNode

__all__ = ["PoseOutput"]

# How many numbers a PoseWithCovariance has, and a TwistWithCovariance.
_POSE, _TWIST = 43, 42


class PoseOutput:
    """Publishes ``odom``, ``pose`` and, where wanted and installed, ``tf``."""

    def __init__(self, node: SlamNode) -> None:
        declare = node.parameters.declare
        self._with_odom = declare("publish_odom_tf", True, "whether odom to base_link goes to tf")
        self._with_map = declare("publish_map_tf", True, "whether map to odom goes to tf")
        self._map, self._odom = node.frame(frames.MAP), node.frame(frames.ODOM)
        self._base = node.frame(frames.BASE_LINK)
        self._odometry = node.offer(topics.ODOM)
        self._pose = node.offer(topics.POSE)
        self._odometry.show_listeners()
        self._pose.show_listeners()
        nowhere, unknown = np.zeros(6), np.zeros((6, 6))
        standing = Odometry(0, nowhere, unknown, nowhere, unknown)
        self._odometry_mould = Mould(
            encoding.odometry(make, standing, self._odom, self._base), _POSE + _TWIST
        )
        self._pose_mould = Mould(encoding.pose(make, 0, nowhere, unknown, self._map), _POSE)
        wanted = self._with_odom or self._with_map
        self._transforms = node.offer(topics.TRANSFORMS) if wanted else None

    def publish(self, odometry: Odometry, pose: Array, covariance: Array) -> None:
        """Publish dead reckoning, and the corrected ``pose`` (6,) with ``covariance`` (6, 6)."""
        stamp_ns, numbers = odometry.stamp_ns, self._odometry_mould.numbers
        _write_pose(numbers, odometry.pose, odometry.covariance)
        numbers[_POSE : _POSE + 6] = odometry.twist
        numbers[_POSE + 6 :] = odometry.twist_covariance.reshape(36)
        is_sent = self._odometry.publish(self._odometry_mould.cast(stamp_ns), numbers)
        numbers = self._pose_mould.numbers
        _write_pose(numbers, pose, covariance)
        if self._pose.publish(self._pose_mould.cast(stamp_ns), numbers) and is_sent:
            self._publish_transforms(odometry, pose)

    def _publish_transforms(self, odometry: Odometry, pose: Array) -> None:
        if self._transforms is None or not self._transforms.subscribers:
            return
        stamp_ns, transforms = odometry.stamp_ns, []
        if self._with_map:
            placed = carried_over(pose, odometry.pose)
            transforms.append(encoding.transform(make, stamp_ns, placed, self._map, self._odom))
        if self._with_odom:
            transforms.append(
                encoding.transform(make, stamp_ns, odometry.pose, self._odom, self._base)
            )
        self._transforms.publish(encoding.tf_message(make, transforms))


def _write_pose(numbers: Array, pose: Array, covariance: Array) -> None:
    """Write pose (6,) and covariance (6, 6) as a PoseWithCovariance has them."""
    numbers[:3] = pose[:3]
    numbers[3:7] = encoding.quaternion(*pose[3:].tolist())
    numbers[7:_POSE] = covariance.reshape(36)
