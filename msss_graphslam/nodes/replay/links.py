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
from msss_graphslam.ros.outputs import listeners

__all__ = ["MADE_BY", "Links"]

MADE_BY = {
    topics.SONAR_PING.name: DRIVER,
    topics.ODOM.name: "dead_reckoning",
    topics.POSE.name: "dead_reckoning",
}
"""Topics that keep nothing for those who come late, and who publishes them."""

_DEPTH = 100


class Links:
    """The graph shows who subscribes; only the publisher knows whom it reaches already."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._namespace = node.get_namespace()
        self._counts = dict.fromkeys(MADE_BY, 0)
        self._reached: dict[str, set[bytes]] = {topic: set() for topic in MADE_BY}
        kind = message_class("diagnostic_msgs/msg/DiagnosticArray")
        node.create_subscription(kind, TOPIC, self._hear, _DEPTH)

    def reach(self, topic: str, name: str) -> bool:
        """Whether the node of that name, in the own namespace, gets the topic from now on."""
        full_name = self._node.resolve_topic_name(topic)
        endpoints = self._node.get_subscriptions_info_by_topic(full_name)
        reached = self._reached[topic]
        if self._counts[topic] >= len(endpoints):
            reached |= {_identifier(endpoint) for endpoint in endpoints}
        return any(
            (endpoint.node_name, endpoint.node_namespace) == (name, self._namespace)
            and _identifier(endpoint) in reached
            for endpoint in endpoints
        )

    def _hear(self, message: Any) -> None:
        for status in message.status:
            rows = {entry.key: entry.value for entry in status.values}
            for topic, source in MADE_BY.items():
                if status.name == f"{self._namespace.rstrip('/')}/{source}":
                    with suppress(ValueError):
                        self._note(topic, int(rows.get(listeners(topic), "0")))

    def _note(self, topic: str, count: int) -> None:
        if count < self._counts[topic]:
            # A publisher that was started again: it has to find them anew.
            self._reached[topic].clear()
        self._counts[topic] = count


def _identifier(endpoint: TopicEndpointInfo) -> bytes:
    return bytes(endpoint.endpoint_gid)
