# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The nodes that a replay waits for."""

from collections.abc import Collection, Mapping, Sequence

from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from msss_graphslam.messages import topics
from msss_graphslam.nodes.names import DRIVER
from msss_graphslam.nodes.replay.links import MADE_BY, Links

__all__ = ["Audience"]

_LISTENS_TO = {
    DRIVER: (topics.SONAR_RAW.name,),
    "dead_reckoning": tuple(
        topic.name for topic in (topics.SONAR_PING, topics.IMU, topics.PRESSURE, topics.DVL)
    ),
    "scan_generation": (topics.SONAR_PING.name,),
    "back_end": (topics.POSE.name,),
    "bag_recorder": tuple(topic.name for topic in (*topics.INPUTS, topics.ODOM, topics.POSE)),
}


class Audience:
    """Whether the nodes of these names, in the own namespace, listen to what is replayed.

    Parameters
    ----------
    node
        The replay's node.
    names
        Names of nodes. Of those unknown to the package one subscription is enough.
    publishers
        The replay's publishers, by the package's topic names.
    """

    def __init__(
        self, node: Node, names: Sequence[str], publishers: Mapping[str, Publisher]
    ) -> None:
        self.names = names
        self._node = node
        self._publishers = publishers
        self._links = Links(node)
        self._made = {
            topic
            for topic, source in MADE_BY.items()
            if source in names and topic not in publishers
        }

    def missing(self, but: Collection[str] = ()) -> dict[str, str]:
        """Return by node what it does not listen to yet; ``but`` are nodes left out."""
        heard = {name: self._endpoints(name) for name in self._publishers}
        lacks = {name: self._lacking(name, heard) for name in self.names if name not in but}
        return {name: ", ".join(lacking) for name, lacking in lacks.items() if lacking}

    def members(self) -> frozenset[bytes]:
        """Return the identifiers of all their subscriptions: a node started again has new ones."""
        return frozenset(
            bytes(endpoint.endpoint_gid)
            for topic in self._publishers
            for endpoint in self._endpoints(topic)
            if endpoint.node_name in self.names
        )

    def _lacking(self, name: str, heard: Mapping[str, list[TopicEndpointInfo]]) -> list[str]:
        joined = {
            topic
            for topic, endpoints in heard.items()
            if any(endpoint.node_name == name for endpoint in endpoints)
            and self._are_matched(topic, endpoints)
        }
        known = _LISTENS_TO.get(name, ())
        made = self._made.intersection(known)
        joined |= {topic for topic in made if self._links.reach(topic, name)}
        wanted = [topic for topic in known if topic in made or topic in self._publishers]
        if wanted:
            return [topic for topic in wanted if topic not in joined]
        return [] if joined else ["any topic"]

    def _are_matched(self, topic: str, endpoints: Sequence[TopicEndpointInfo]) -> bool:
        """Whether the publisher itself knows all that the graph shows."""
        return self._publishers[topic].get_subscription_count() >= len(endpoints)

    def _endpoints(self, topic: str) -> list[TopicEndpointInfo]:
        """Return the subscriptions that a topic can serve."""
        publisher = self._publishers[topic]
        is_volatile = publisher.qos_profile.durability == DurabilityPolicy.VOLATILE
        return [
            endpoint
            for endpoint in self._node.get_subscriptions_info_by_topic(publisher.topic_name)
            if self._is_near(endpoint) and not (is_volatile and _is_latched(endpoint))
        ]

    def _is_near(self, endpoint: TopicEndpointInfo) -> bool:
        return bool(endpoint.node_namespace == self._node.get_namespace())


def _is_latched(endpoint: TopicEndpointInfo) -> bool:
    return bool(endpoint.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL)
