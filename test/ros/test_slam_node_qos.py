# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How a node gets on with its publishers: qualities of service, overrides, namespaces."""

from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("rclpy")

from listening_node import PING, Bench, Listener, ping, rows
from rclpy.qos import QoSProfile, ReliabilityPolicy

from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.qos import STREAM

Start = Callable[..., Any]

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
OVERRIDE = "qos_overrides./red/sonar/ping.subscription.reliability"


def test_a_publisher_that_does_not_fit_is_named_with_its_override(started: Start) -> None:
    bench = Bench(started("-r", "__ns:=/red"))
    kind = message_class(PING.type_name)
    bench.other.create_publisher(kind, "/red/sonar/ping", BEST_EFFORT)
    status = bench.saying("a publisher on sonar/ping has a RELIABILITY that does not fit")
    assert status.level == b"\x02"
    assert status.message.endswith(OVERRIDE)
    assert status.name == "/red/listener"


def test_the_override_helps(started: Start) -> None:
    bench = Bench(started("-r", "__ns:=/red", "-p", f"{OVERRIDE}:=best_effort"))
    publisher = bench.publisher(BEST_EFFORT, "/red/sonar/ping")
    publisher.publish(ping(1.0))
    bench.graph.until(lambda: bench.node.taken == [1.0])


@pytest.mark.parametrize(
    "value", ["reliability:=perhaps", "depth:=9000", "history:=keep_all", "depth:=deep"]
)
def test_an_override_that_cannot_be_used_ends_nothing(started: Start, value: str) -> None:
    bench = Bench(started("-p", f"qos_overrides./sonar/ping.subscription.{value}"))
    assert bench.saying("qos_overrides of sonar/ping not used").level == b"\x02"
    bench.publisher().publish(ping(1.0))
    bench.graph.until(lambda: bench.node.taken == [1.0])


def test_messages_that_overran_the_history_are_counted(started: Start) -> None:
    bench = Bench(started("-p", "qos_overrides./sonar/ping.subscription.depth:=5"))
    publisher = bench.publisher()
    publisher.publish(ping(0.5))
    bench.graph.until(lambda: bench.node.taken)
    for i in range(1, 106):
        publisher.publish(ping(1.0 + 0.5 * i))
    publisher.wait_for_all_acked()
    bench.graph.until(lambda: bench.node.taken[-1:] == [53.5])
    lost = 106 - len(bench.node.taken)
    assert lost > 0
    bench.status(lambda status: rows(status)["lost/sonar/ping"] == str(lost))


def test_vehicles_in_namespaces_do_not_hear_each_other(started: Start) -> None:
    bench = Bench(started("-r", "__ns:=/red"))
    kind = message_class(PING.type_name)
    blue = bench.other.create_publisher(kind, "/blue/sonar/ping", STREAM)
    red = bench.publisher(name="/red/sonar/ping")
    blue.publish(ping(1.0))
    red.publish(ping(2.0))
    bench.graph.until(lambda: bench.node.taken == [2.0])


def test_a_parameter_out_of_range_is_an_error_that_ends_nothing(started: Start) -> None:
    bench = Bench(started("-p", "dead_reckoning.patience:=1000.0"))
    status = bench.saying("dead_reckoning.patience = 1000.0: must lie in [0.1, 600]; 2.0 is used")
    assert status.level == b"\x02"


def test_the_frames_have_the_prefix(started: Start) -> None:
    node = started("-p", "frame_prefix:=red/").add(Listener())
    assert node.frame("base_link") == "red/base_link"
