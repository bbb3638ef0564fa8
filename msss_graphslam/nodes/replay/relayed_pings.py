# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Who hears the beams that a driver makes of the bytes that are replayed."""

from contextlib import suppress
from typing import Any

from rclpy.node import Node

from msss_graphslam.messages import topics
from msss_graphslam.nodes.names import DRIVER
from msss_graphslam.ros.diagnostics import TOPIC
from msss_graphslam.ros.messages import message_class

__all__ = ["LISTENERS", "RelayedPings"]

LISTENERS = f"listeners/{topics.SONAR_PING.name}"
"""The driver's row that says how many listeners its publisher knows."""

_DEPTH = 100


class RelayedPings:
    """The graph shows who subscribes; only the driver knows whom its beams reach already."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._reached = 0
        self._topic = node.resolve_topic_name(topics.SONAR_PING.name)
        self._driver = f"{node.get_namespace().rstrip('/')}/{DRIVER}"
        kind = message_class("diagnostic_msgs/msg/DiagnosticArray")
        node.create_subscription(kind, TOPIC, self._hear, _DEPTH)

    def reach(self, name: str) -> bool:
        """Whether the node of that name, in the own namespace, gets every beam from now on."""
        endpoints = self._node.get_subscriptions_info_by_topic(self._topic)
        namespace = self._node.get_namespace()
        listens = any((e.node_name, e.node_namespace) == (name, namespace) for e in endpoints)
        return listens and self._reached >= len(endpoints)

    def _hear(self, message: Any) -> None:
        for status in message.status:
            if status.name == self._driver:
                rows = {entry.key: entry.value for entry in status.values}
                with suppress(ValueError):
                    self._reached = int(rows.get(LISTENERS, "0"))
