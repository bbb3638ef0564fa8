# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Who hears what nodes make of the data that are replayed to them."""

from contextlib import suppress
from typing import Any

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from msss_graphslam.messages import topics
from msss_graphslam.nodes.names import DRIVER
from msss_graphslam.ros.diagnostics import TOPIC
from msss_graphslam.ros.messages import message_class

__all__ = ["MADE_BY", "Links", "listeners"]

MADE_BY = {
    topics.SONAR_PING.name: DRIVER,
    topics.ODOM.name: "dead_reckoning",
    topics.POSE.name: "dead_reckoning",
}
"""Topics that keep nothing for those who come late, and who publishes them."""

_DEPTH = 100


def listeners(topic: str) -> str:
    """Return the publisher's row that says how many listeners it knows."""
    return f"listeners/{topic}"


class Links:
    """The graph shows who subscribes; only the publisher knows whom it reaches already."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._namespace = node.get_namespace()
        self._counts: dict[str, int] = {}
        self._reached: set[bytes] = set()
        kind = message_class("diagnostic_msgs/msg/DiagnosticArray")
        node.create_subscription(kind, TOPIC, self._hear, _DEPTH)

    def reach(self, topic: str, name: str) -> bool:
        """Whether the node of that name, in the own namespace, gets the topic from now on."""
        full_name = self._node.resolve_topic_name(topic)
        endpoints = self._node.get_subscriptions_info_by_topic(full_name)
        if self._counts.get(topic, 0) >= len(endpoints):
            self._reached |= {_identifier(endpoint) for endpoint in endpoints}
        return any(
            (endpoint.node_name, endpoint.node_namespace) == (name, self._namespace)
            and _identifier(endpoint) in self._reached
            for endpoint in endpoints
        )

    def _hear(self, message: Any) -> None:
        for status in message.status:
            rows = {entry.key: entry.value for entry in status.values}
            for topic, source in MADE_BY.items():
                if status.name == f"{self._namespace.rstrip('/')}/{source}":
                    with suppress(ValueError):
                        self._counts[topic] = int(rows.get(listeners(topic), "0"))


def _identifier(endpoint: TopicEndpointInfo) -> bytes:
    return bytes(endpoint.endpoint_gid)
