# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A node as a process, fed and heard by the test, and a short made-up dive."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
from nodes.processes import Domain, TestNode, domain, wait_until

from msss_graphslam.config.groups import Sensors
from msss_graphslam.core.types import Beam, BodyVelocity, Inertial, Measurement
from msss_graphslam.messages import decoding, encoding, topics
from msss_graphslam.messages.hydrostatics import pressure_at
from msss_graphslam.messages.topics import Topic
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.qos import DEEP, name_of, profile_of

__all__ = ["BEAMS_A_TURN", "START_NS", "Fed", "dive", "fed", "measurement_of"]

START_NS = 1_700_000_000_000_000_000
BEAMS_A_TURN = 60
BINS = (np.arange(200) + 0.5) * 0.1
SENSORS = Sensors()

DECODERS: dict[Topic, Callable[[Any], Measurement]] = {
    topics.IMU: decoding.inertial,
    topics.PRESSURE: partial(decoding.depth, sensors=SENSORS),
    topics.DVL: decoding.body_velocity,
    topics.SONAR_PING: decoding.beam,
}


class Fed:
    """What sends to a node, and gathers what it says by topic."""

    def __init__(self, test: TestNode, node_name: str) -> None:
        self._test, self._name = test, node_name
        self._heard: dict[Topic, list[Any]] = {}
        self._publishers: dict[Topic, Any] = {}
        self._lock = threading.Lock()

    def hear(self, topic: Topic) -> None:
        """Gather what comes on the topic."""
        messages = self._heard.setdefault(topic, [])
        kind = message_class(topic.type_name)
        profile = profile_of(topic, DEEP)
        self._test.node.create_subscription(kind, name_of(topic), messages.append, profile)
        wait_until(
            lambda: self._test.node.count_publishers(name_of(topic)) > 0, f"{topic.name} offered"
        )

    def heard(self, topic: Topic) -> list[Any]:
        return list(self._heard[topic])

    def offer(self, topic: Topic) -> None:
        """Advertise the topic and wait until the node subscribes to it."""
        kind = message_class(topic.type_name)
        profile = profile_of(topic, DEEP)
        publisher = self._test.node.create_publisher(kind, name_of(topic), profile)
        wait_until(lambda: publisher.get_subscription_count() > 0, f"{topic.name} subscribed")
        self._publishers[topic] = publisher

    def send(self, topic: Topic, message: Any) -> None:
        self._publishers[topic].publish(message)

    def listens_to(self, topic: Topic) -> bool:
        return self._test.node.count_subscribers(name_of(topic)) > 0

    def trigger(self, service: str) -> Any:
        """Return the answer of the node's service."""
        kind = message_class("std_srvs/srv/Trigger")
        return self._test.call(kind, f"/{self._name}/{service}")

    def diagnostic(self, key: str) -> str:
        """Return the newest value under the key, empty if there is none."""
        for message in reversed(self.heard(DIAGNOSTICS)):
            values = {entry.key: entry.value for entry in message.status[0].values}
            if message.status[0].name == f"/{self._name}":
                return str(values.get(key, ""))
        return ""


DIAGNOSTICS = Topic("diagnostics", "diagnostic_msgs/msg/DiagnosticArray")


@contextmanager
def fed(node_name: str, **parameters: Any) -> Iterator[Fed]:
    """Start the node in a domain of its own; give what feeds and hears it."""
    with domain() as own, TestNode(own) as test, process(own, node_name, **parameters):
        feeder = Fed(test, node_name)
        feeder.hear(DIAGNOSTICS)
        yield feeder


def process(own: Domain, node_name: str, **parameters: Any) -> Any:
    return own.start(node_name, **parameters)


def measurement_of(topic: Topic, message: Any) -> Measurement:
    """Return what the nodes read from the message."""
    return DECODERS[topic](message)


def dive(turns: float = 1.2, start_ns: int = START_NS) -> list[tuple[Topic, Any]]:
    """Return the messages of a straight run in a round basin, in the order of their stamps.

    A beam each 0.1 s, IMU at 20 Hz, pressure at 5 Hz, DVL at 2 Hz.
    """
    seconds = turns * BEAMS_A_TURN * 0.1
    sent = [(stamp, topics.IMU, _imu(stamp)) for stamp in _stamps(start_ns, 0.05, seconds)]
    sent += [
        (stamp, topics.PRESSURE, encoding.fluid_pressure(make, stamp, PRESSURE, "base_link"))
        for stamp in _stamps(start_ns + 3_000_000, 0.2, seconds)
    ]
    sent += [
        (stamp, topics.DVL, encoding.twist(make, _velocity(stamp), "base_link"))
        for stamp in _stamps(start_ns + 5_000_000, 0.5, seconds)
    ]
    sent += [
        (stamp, topics.SONAR_PING, _beam(stamp, number))
        for number, stamp in enumerate(_stamps(start_ns + 7_000_000, 0.1, seconds))
    ]
    return [(topic, message) for _, topic, message in sorted(sent, key=lambda one: one[0])]


PRESSURE = pressure_at(-2.0, SENSORS)


def _stamps(first_ns: int, period: float, seconds: float) -> list[int]:
    return [first_ns + round(n * period * 1e9) for n in range(int(seconds / period))]


def _imu(stamp_ns: int) -> Any:
    sample = Inertial(stamp_ns, np.array([0.01, -0.02, 0.5]), np.zeros(3))
    return encoding.imu(make, sample, "imu_link")


def _velocity(stamp_ns: int) -> BodyVelocity:
    return BodyVelocity(stamp_ns, np.array([0.3, 0.0, 0.0]), np.eye(3) * 1e-4)


def _beam(stamp_ns: int, number: int) -> Any:
    bearing = float(np.float32((number % BEAMS_A_TURN) * 2.0 * np.pi / BEAMS_A_TURN - np.pi))
    echo = 200.0 * np.exp(-(((BINS - 8.0) / 0.3) ** 2)) + 10.0
    return encoding.laser_scan(make, Beam(stamp_ns, bearing, BINS, np.rint(echo)), "sonar", 0.1)
