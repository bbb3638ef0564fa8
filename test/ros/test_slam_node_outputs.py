# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a node gives out: topics, latched or not, and its diagnostics."""

from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from listening_node import Bench, rows
from rclpy.node import Node

from msss_graphslam.messages import topics
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.node import SlamNode
from msss_graphslam.ros.qos import LATCHED, STREAM


def test_what_is_latched_comes_late_and_what_is_not_finite_never(bench: Bench) -> None:
    output = bench.node.offer(topics.KEYFRAMES)
    path = make("nav_msgs/msg/Path")
    path.header.frame_id = "map"
    assert output.publish(path, np.zeros(3), 1.0)
    assert not output.publish(make("nav_msgs/msg/Path"), np.array([0.0, np.nan]))
    assert bench.node.diagnostics.refused["not_finite_output"] == 1
    heard: list[Any] = []
    bench.other.create_subscription(type(path), "graph/keyframes", heard.append, LATCHED)
    bench.graph.until(lambda: heard)
    assert [message.header.frame_id for message in heard] == ["map"]


def test_without_the_package_of_a_message_its_topic_is_left_out(bench: Bench) -> None:
    output = bench.node.offer(topics.Topic("tf", "no_such_msgs/msg/TFMessage"))
    assert not output.available
    assert not output.publish(object())


def test_values_are_always_finite_and_never_end_the_node(bench: Bench) -> None:
    bench.node.diagnostics.values.update(
        {"nan": lambda: float("nan"), "broken": lambda: 1 / 0, "size": lambda: np.float64(0.25)}
    )
    found = rows(bench.status(lambda status: "size" in rows(status)))
    assert (found["nan"], found["broken"], found["size"]) == ("none", "none", "0.25")
    assert bench.node.diagnostics.refused["internal_error"] > 0


def test_warnings_and_errors_stand_until_cleared(bench: Bench) -> None:
    bench.node.diagnostics.warn("turn is slow")
    bench.node.diagnostics.error("no sonar")
    status = bench.saying("no sonar; turn is slow")
    assert status.level == b"\x02"
    bench.node.diagnostics.clear()
    assert bench.status(lambda status: status.level == b"\x00").message == "running"


class Talker(SlamNode):
    """Offers a latched topic and one that is not."""

    def __init__(self) -> None:
        super().__init__("talker")
        self.latched = self.offer(topics.CORRECTION)
        self.stream = self.offer(topics.ODOM)


def test_after_a_reset_nothing_of_before_is_given_to_who_comes_late(graph: Any) -> None:
    node, other = graph.add(Talker()), graph.add(Node("other"))
    odometry = topics.CORRECTION.type_name
    node.latched.publish(make(odometry, child_frame_id="before"))
    reset = message_class("std_srvs/srv/Trigger")
    assert graph.answer(other.create_client(reset, "talker/reset"), reset.Request()).success
    heard: list[str] = []
    other.create_subscription(
        message_class(odometry),
        topics.CORRECTION.name,
        lambda message: heard.append(message.child_frame_id),
        LATCHED,
    )
    node.latched.publish(make(odometry, child_frame_id="after"))
    graph.until(lambda: heard)
    assert heard == ["after"]
    assert other.count_publishers(topics.CORRECTION.name) == 1


def test_who_listens_hears_on_after_a_reset(graph: Any) -> None:
    node, other = graph.add(Talker()), graph.add(Node("other"))
    heard: list[str] = []
    for topic in (topics.CORRECTION, topics.ODOM):
        other.create_subscription(
            message_class(topic.type_name),
            topic.name,
            lambda message: heard.append(message.child_frame_id),
            LATCHED if topic.latched else STREAM,
        )
    graph.until(lambda: node.latched.subscribers and node.stream.subscribers)
    node.latched.publish(make(topics.CORRECTION.type_name, child_frame_id="latched before"))
    graph.until(lambda: heard)
    for output in (node.latched, node.stream):
        output.reset()
    node.latched.publish(make(topics.CORRECTION.type_name, child_frame_id="latched"))
    node.stream.publish(make(topics.ODOM.type_name, child_frame_id="stream"))
    graph.until(lambda: len(heard) == 3)
    assert sorted(heard[1:]) == ["latched", "stream"]
