# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A listener to a replay that passes for dead reckoning, and how far it says it is."""

from collections import defaultdict
from pathlib import Path
from typing import Any

from nodes.processes import Domain, NodeProcess, TestNode
from sample_bags import START_NS

from msss_graphslam.messages import topics
from msss_graphslam.nodes.replay.lead import header_stamp_ns
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.ros.diagnostics import TOPIC
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.outputs import listeners
from msss_graphslam.ros.qos import STREAM, profile_of

SENSORS = (topics.GROUND_TRUTH, topics.DVL, topics.PRESSURE, topics.IMU, topics.SONAR_PING)
TRIGGER = message_class("std_srvs/srv/Trigger")
SET_BOOL = message_class("std_srvs/srv/SetBool")


class Listener(TestNode):
    """Passes for dead reckoning: takes every sensor's bytes, and may tell how far it is."""

    def __init__(self, of: Domain, *, namespace: str = "/", remapped: str = "") -> None:
        super().__init__(of, "dead_reckoning", namespace)
        self.received: defaultdict[str, list[bytes]] = defaultdict(list)
        self.called: list[str] = []
        kind = message_class("diagnostic_msgs/msg/DiagnosticArray")
        self._diagnostics = self.node.create_publisher(kind, TOPIC, 10)
        for topic in SENSORS:
            name = remapped if remapped and topic == topics.SONAR_PING else topic.name
            self._listen(topic, name)

    @property
    def count(self) -> int:
        return sum(map(len, self.received.values()))

    def answer(self, service: str, refusals: int = 0) -> None:
        """Offer a Trigger service that refuses so many times before it agrees."""

        def serve(_: Any, response: Any) -> Any:
            self.called.append(service)
            response.success = self.called.count(service) > refusals
            response.message = f"call {self.called.count(service)}"
            return response

        self.node.create_service(TRIGGER, service, serve)

    def tells(self, topic: topics.Topic, count: int) -> bool:
        """Say in the diagnostics how many listeners dead reckoning's publisher knows."""
        row = make("diagnostic_msgs/msg/KeyValue", key=listeners(topic.name), value=str(count))
        name = self.node.get_fully_qualified_name()
        status = make("diagnostic_msgs/msg/DiagnosticStatus", name=name, values=[row])
        self._diagnostics.publish(make("diagnostic_msgs/msg/DiagnosticArray", status=[status]))
        return True

    def _listen(self, topic: topics.Topic, name: str) -> None:
        kind = message_class(topic.type_name)
        take = self.received[topic.name].append
        self.node.create_subscription(
            kind, name, lambda data: take(bytes(data)), profile_of(topic), raw=True
        )


def replay(at: Domain, bag: Path, *arguments: str, **parameters: Any) -> NodeProcess:
    defaults = {"rate": 0.0, "conclude": False, "wait_for": "[dead_reckoning]"}
    return at.start("bag_replay", *arguments, bag=bag, **{**defaults, **parameters})


def recorded(bag: Path, start: float = 0.0) -> dict[str, list[bytes]]:
    recording = open_recording(bag)
    content = defaultdict(list)
    for raw in recording.messages():
        if raw.log_ns >= recording.start_ns + start * 1e9:
            content[topics.find(raw.channel.topic).name].append(raw.data)
    return dict(content)


class Newest:
    """How far the sensors have come, and what was told of it."""

    def __init__(self, listener: Listener, topic: topics.Topic = topics.SETTLED_ODOMETRY) -> None:
        self.told_ns = START_NS
        self._received = listener.received
        self._topic = topic
        kind = message_class(topic.type_name)
        self._publisher = listener.node.create_publisher(kind, topic.name, STREAM)

    @property
    def stamp_ns(self) -> int:
        pings = self._received["sonar/ping"]
        return (header_stamp_ns(pings[-1]) or 0) if pings else 0

    def tell(self, stamp_ns: int) -> None:
        self.told_ns = stamp_ns
        message = make(self._topic.type_name)
        header = getattr(message, "header", message)
        header.stamp.sec, header.stamp.nanosec = divmod(stamp_ns, 10**9)
        self._publisher.publish(message)
