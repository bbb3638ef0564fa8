# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Odometry, corrected pose and both frames, published together."""

from msss_graphslam.core.compounding import carried_over
from msss_graphslam.core.types import Array, Odometry
from msss_graphslam.messages import encoding, frames, topics
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode

__all__ = ["PoseOutput"]


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
        wanted = self._with_odom or self._with_map
        self._transforms = node.offer(topics.TRANSFORMS) if wanted else None

    def publish(self, odometry: Odometry, pose: Array, covariance: Array) -> None:
        """Publish dead reckoning, and the corrected ``pose`` (6,) with ``covariance`` (6, 6)."""
        message = encoding.odometry(make, odometry, self._odom, self._base)
        numbers = (odometry.pose, odometry.covariance, odometry.twist, odometry.twist_covariance)
        is_sent = self._odometry.publish(message, *numbers)
        stamp_ns = odometry.stamp_ns
        corrected = encoding.pose(make, stamp_ns, pose, covariance, self._map)
        if self._pose.publish(corrected, pose, covariance) and is_sent:
            self._publish_transforms(odometry, pose)

    def _publish_transforms(self, odometry: Odometry, pose: Array) -> None:
        if self._transforms is None or not self._transforms.available:
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
