# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A probe in the graph: what comes on which topic, when it was sent, when it arrived."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from msss_graphslam.messages.topics import Topic
from msss_graphslam.nodes.replay.lead import header_stamp_ns
from msss_graphslam.ros.messages import available, message_class
from msss_graphslam.ros.qos import DEEP, name_of, profile_of
from msss_graphslam.ros.visiting import visitor

__all__ = ["Arrivals", "Probe", "probing"]


@dataclass(slots=True)
class Arrivals:
    """The messages of one topic, by the system's clock [ns].

    ``stamps`` are those in their headers, ``sent`` when they were published, ``received`` when the
    middleware had them in this process, before any Python; ``sizes`` of the serialised messages.
    """

    stamps: list[int] = field(default_factory=list)
    sent: list[int] = field(default_factory=list)
    received: list[int] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)

    def clear(self) -> None:
        """Forget what has come so far."""
        for values in (self.stamps, self.sent, self.received, self.sizes):
            values.clear()


class Probe:
    """Listens to topics without decoding them; ``arrivals`` by the topic's name."""

    def __init__(self, node: Node) -> None:
        self.arrivals: dict[str, Arrivals] = {}
        self._node = node
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)

    def listen(
        self, topics: Iterable[Topic], take: Callable[[bytes], object] = lambda _: None
    ) -> None:
        """Note what comes on these topics; ``take`` is given the serialised messages as well."""
        for topic in topics:
            if available(topic.type_name):
                self._subscribe(topic, take)

    def spin(self, seconds: float) -> None:
        """Take what comes, at most one message."""
        self._executor.spin_once(timeout_sec=seconds)

    def _subscribe(self, topic: Topic, take: Callable[[bytes], object]) -> None:
        arrivals = self.arrivals[topic.name] = Arrivals()

        def receive(data: bytes, info: dict[str, int]) -> None:
            arrivals.stamps.append(header_stamp_ns(data) or 0)
            arrivals.sent.append(info["source_timestamp"])
            arrivals.received.append(info["received_timestamp"])
            arrivals.sizes.append(len(data))
            take(data)

        # rclpy declares one argument; a callback with two is given the message's information.
        callback: Any = receive
        self._node.create_subscription(
            message_class(topic.type_name),
            name_of(topic),
            callback,
            profile_of(topic, DEEP),
            raw=True,
        )


@contextmanager
def probing() -> Iterator[Probe]:
    """Give a probe."""
    with visitor("probe", "") as node:
        yield Probe(node)
