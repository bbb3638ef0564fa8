# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The way of dead reckoning, published now and then."""

from time import monotonic

from msss_graphslam.core.types import Odometry
from msss_graphslam.messages import frames, topics
from msss_graphslam.messages.encoding import serialised
from msss_graphslam.nodes.reckoned_path import ReckonedPath
from msss_graphslam.ros.node import SlamNode

__all__ = ["PathOutput"]

_PERIOD = 1.0
_LOOK = 0.2
_SILENCE = 0.3


class PathOutput:
    """Publishes the way each second, and at once where it ends.

    A dead reckoning that is started again goes on from its end; an empty path says that there is
    none.
    """

    def __init__(self, node: SlamNode) -> None:
        self._frame = node.frame(frames.ODOM)
        self._output = node.offer(topics.RECKONED_PATH)
        self.reset()
        node.every(_PERIOD, self.publish_new)
        node.every(_LOOK, self._look)

    def reset(self) -> None:
        """Forget the way, and say so."""
        self._path = ReckonedPath()
        self._added_at = monotonic()
        self.publish()

    def add(self, odometry: Odometry) -> None:
        """Take in the next odometry."""
        self._path.add(odometry)
        self._is_new, self._added_at = True, monotonic()

    def publish_new(self) -> None:
        """Publish the way if it has become longer."""
        if self._is_new:
            self.publish()

    def publish(self) -> None:
        """Publish the way so far."""
        self._is_new = False
        trajectory = self._path.trajectory
        self._output.publish(serialised.path(trajectory, self._frame), trajectory.poses)

    def _look(self) -> None:
        if monotonic() - self._added_at > _SILENCE:
            self.publish_new()
