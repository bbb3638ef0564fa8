# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The latest beams, kept for a scan generation that is started again."""

from msss_graphslam.core.types import Beam
from msss_graphslam.messages import encoding, topics
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode
from msss_graphslam.ros.qos import DEEP

__all__ = ["BeamRelay"]


class BeamRelay:
    """Publishes beams a second time, for those who come late; the drivers keep none."""

    def __init__(self, node: SlamNode) -> None:
        self._output = node.offer(topics.RECENT_BEAMS, DEEP)

    def add(self, beam: Beam) -> None:
        """Keep a beam that was heard."""
        self._output.publish(encoding.laser_scan(make, beam, "", 0.0))
