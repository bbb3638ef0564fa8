# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A node that keeps what it takes, publishers to it, and what it says of itself."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from rclpy.node import Node
from rclpy.qos import QoSProfile

from msss_graphslam.core.types import Beam
from msss_graphslam.messages import decoding, encoding, topics
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.node import SlamNode
from msss_graphslam.ros.qos import STREAM

PING = topics.SONAR_PING
SECOND = 1_000_000_000


class Listener(SlamNode):
    """Keeps the stamps of the beams it takes."""

    def __init__(self, **rules: Any) -> None:
        super().__init__("listener", ("dead_reckoning",), ("dead_reckoning",))
        self.taken: list[float] = []
        self.resets = 0
        self.heard = self.listen(PING, decoding.beam, self.take, **rules)

    def take(self, beam: Beam) -> None:
        if beam.bearing > 3.0:
            raise RuntimeError("cannot look there")
        self.taken.append(beam.stamp_ns / SECOND)

    def on_reset(self) -> None:
        self.resets += 1

    def on_save(self) -> tuple[bool, str]:
        raise OSError("disk full")


class Bench:
    """A listener, publishers to it, and what it says on /diagnostics."""

    def __init__(self, graph: Any, **rules: Any) -> None:
        self.graph = graph
        self.node = graph.add(Listener(**rules))
        self.other = graph.add(Node("other"))
        self.said: list[Any] = []
        array = message_class("diagnostic_msgs/msg/DiagnosticArray")
        self.other.create_subscription(array, "/diagnostics", self._hear, 10)
        self._services: dict[str, Any] = {}

    def _hear(self, message: Any) -> None:
        self.said.append(message.status[0])

    def publisher(self, profile: QoSProfile = STREAM, name: str = PING.name) -> Any:
        heard = self.node.heard.subscription
        before = heard.get_publisher_count()
        publisher = self.other.create_publisher(message_class(PING.type_name), name, profile)
        self.graph.until(publisher.get_subscription_count)
        self.graph.until(lambda: heard.get_publisher_count() > before)
        return publisher

    def status(self, condition: Callable[[Any], bool]) -> Any:
        """Return the first status from now on that fulfils the condition."""
        self.said.clear()
        return self.graph.until(lambda: next(filter(condition, self.said), None))

    def saying(self, text: str) -> Any:
        return self.status(lambda status: text in status.message)

    def refused(self, reason: str, count: int) -> None:
        self.graph.until(lambda: self.node.diagnostics.refused[reason] == count)

    def call(self, name: str, kind: str = "Trigger", **fields: Any) -> Any:
        service = message_class(f"std_srvs/srv/{kind}")
        client = self.other.create_client(
            service, f"{self.node.get_fully_qualified_name()}/{name}"
        )
        return self.graph.answer(client, service.Request(**fields))


def ping(stamp: float, bearing: float = 0.5) -> Any:
    beam = Beam(round(stamp * SECOND), bearing, np.arange(1.0, 6.0), np.arange(5.0))
    return encoding.laser_scan(make, beam, "sonar_link", 0.04)


def rows(status: Any) -> dict[str, str]:
    return {row.key: row.value for row in status.values}
