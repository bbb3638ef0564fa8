# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The publishers of a replay: serialised messages go out as they are.

But for raw bytes without a time of receipt: they get the log's.
"""

import time
from collections import Counter
from collections.abc import Iterable

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher

from msss_graphslam.messages import topics
from msss_graphslam.messages.topics import Topic
from msss_graphslam.nodes.replay.receipt import with_receipt
from msss_graphslam.nodes.replay.selection import relative_name
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.recorded_topics import RecordedTopic
from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.qos import DEEP, name_of, profile_of

__all__ = ["Output"]

_WINDOW = DEEP * 3 // 4


class Output:
    """A publisher for each recorded topic; ``by_name`` holds them by the package's names."""

    def __init__(self, node: Node, recorded: Iterable[RecordedTopic]) -> None:
        self.by_name: dict[str, Publisher] = {}
        self._by_bag_name: dict[str, Publisher] = {}
        self._open: Counter[str] = Counter()
        for topic in recorded:
            name = relative_name(topic.name)
            known = topics.find(topic.name) or Topic(name, topic.type_name)
            kind = message_class(topic.type_name)
            publisher = node.create_publisher(kind, name_of(known), profile_of(known))
            self.by_name[name] = self._by_bag_name[topic.name] = publisher

    def publish(self, raw: RawMessage) -> bool:
        """Publish one message; return whether it can be one at all."""
        if raw.channel.message_encoding != "cdr" or len(raw.data) < 4:
            return False
        is_raw = topics.find(raw.channel.topic) == topics.SONAR_RAW
        data = with_receipt(raw.data, raw.log_ns) if is_raw else raw.data
        self._by_bag_name[raw.channel.topic].publish(data)
        self._open[raw.channel.topic] += 1
        return True

    @property
    def is_full(self) -> bool:
        """Whether a topic has nearly as many messages under way as its history keeps."""
        return max(self._open.values(), default=0) >= _WINDOW

    def all_acknowledged(self, wait: float) -> bool:
        """Whether every listener has got everything; at most ``wait`` [s] are spent on it."""
        until = time.monotonic() + wait
        done = all(
            publisher.wait_for_all_acked(Duration(seconds=max(until - time.monotonic(), 0.0)))
            for publisher in self.by_name.values()
        )
        if done:
            self._open.clear()
        return done
