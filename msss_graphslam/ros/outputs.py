# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One output of a node: nothing that is not finite leaves."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from rclpy.node import Node

from msss_graphslam.messages.topics import Topic
from msss_graphslam.ros.diagnostics import Diagnostics
from msss_graphslam.ros.messages import available, message_class
from msss_graphslam.ros.qos import name_of, profile_of

__all__ = ["Output", "listeners"]


def listeners(topic: str) -> str:
    """Return the diagnostics' row that says how many listeners a publisher knows."""
    return f"listeners/{topic}"


class Output:
    """A publisher; without the message's package installed it publishes nothing."""

    def __init__(
        self, node: Node, topic: Topic, depth: int | None, diagnostics: Diagnostics
    ) -> None:
        self.topic = topic
        self.published = 0
        self._depth = depth
        self._node = node
        self._diagnostics = diagnostics
        self._publisher: Any = None
        if not available(topic.type_name):
            package = topic.type_name.partition("/")[0]
            node.get_logger().info(f"{package} is not installed: {topic.name} is left out")
            return
        self._advertise()

    def close(self) -> None:
        """Advertise no more; what is published from now on goes nowhere."""
        if self._publisher is not None:
            self._node.destroy_publisher(self._publisher)
            self._publisher = None

    def reset(self) -> None:
        """Take back what a latched topic has kept for those who come late."""
        if self._publisher is not None and self.topic.latched:
            self.close()
            self._advertise()

    @property
    def available(self) -> bool:
        """Whether the message's package is installed."""
        return self._publisher is not None

    @property
    def subscribers(self) -> int:
        """How many subscriptions are matched."""
        return int(self._publisher.get_subscription_count()) if self.available else 0

    def show_listeners(self) -> None:
        """Say in the diagnostics how many listen."""
        self._diagnostics.values[listeners(self.topic.name)] = lambda: self.subscribers

    def publish(self, message: Any, *numbers: ArrayLike) -> bool:
        """Publish the message (or its bytes) if all the numbers are finite; else count it."""
        if not all(np.isfinite(values).all() for values in numbers):
            self._diagnostics.refused["not_finite_output"] += 1
            return False
        if self.available:
            self._publisher.publish(message)
            self.published += 1
        return self.available

    def _advertise(self) -> None:
        topic = self.topic
        self._publisher = self._node.create_publisher(
            message_class(topic.type_name), name_of(topic), profile_of(topic, self._depth)
        )
