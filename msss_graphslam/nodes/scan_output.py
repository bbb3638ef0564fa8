# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scans as messages: whole for the graph, the points for viewers, the part of a turn."""

import numpy as np

from msss_graphslam.core.types import Scan
from msss_graphslam.messages import encoding, frames, topics
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode
from msss_graphslam.ros.qos import DEEP

__all__ = ["ScanOutput"]

_SCAN_FRAME = "scan"


class ScanOutput:
    """Publishes what scan generation makes."""

    def __init__(self, node: SlamNode) -> None:
        self._node = node
        self._beams = node.offer(topics.SCAN_BEAMS, DEEP)
        self._part = node.offer(topics.SCAN_PART)
        self._points = node.offer(topics.SCAN)
        self._transforms = node.offer(topics.TRANSFORMS)

    def publish(self, scan: Scan) -> None:
        """Publish a whole turn."""
        message = encoding.scan_beams(make, scan)
        numbers = (scan.reckoned, scan.body_points, scan.body_covariances, scan.points)
        if self._beams.publish(message, *numbers, scan.covariances) and scan.usable:
            self._show(scan)

    def publish_part(self, part: Scan) -> None:
        """Publish what has been heard of the turn in progress."""
        message = encoding.scan_beams(make, part)
        self._part.publish(message, part.reckoned, part.points, part.covariances)

    def _show(self, scan: Scan) -> None:
        """Publish the points in {I}, and where {I} lies."""
        frame = self._node.frame(_SCAN_FRAME)
        if self._transforms.available:
            x, y, z, _, _, yaw = scan.reckoned[0].tolist()
            placement = np.array([x, y, z, 0.0, 0.0, yaw])
            odom = self._node.frame(frames.ODOM)
            transform = encoding.transform(make, scan.stamp_ns, placement, odom, frame)
            self._transforms.publish(encoding.tf_message(make, [transform]))
        self._points.publish(encoding.scan_cloud(make, scan, frame))
