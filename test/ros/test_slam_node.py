# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A node with real inputs and outputs: what it takes, what it refuses, what it says of it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from msss_graphslam.core.types import Beam
from msss_graphslam.messages import decoding, encoding, topics
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.node import SlamNode
from msss_graphslam.ros.qos import LATCHED, STREAM

PING = topics.SONAR_PING
SECOND = 1_000_000_000
Start = Callable[..., Any]


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


@pytest.fixture
def bench(graph: Any) -> Bench:
    return Bench(graph)


def ping(stamp: float, bearing: float = 0.5) -> Any:
    beam = Beam(round(stamp * SECOND), bearing, np.arange(1.0, 6.0), np.arange(5.0))
    return encoding.laser_scan(make, beam, "sonar_link", 0.04)


def rows(status: Any) -> dict[str, str]:
    return {row.key: row.value for row in status.values}


def test_a_quiet_node_is_well_and_says_who_it_is(bench: Bench) -> None:
    status = bench.status(lambda _: True)
    assert (status.level, status.message) == (b"\x00", "running")
    assert (status.name, status.hardware_id) == ("/listener", "msss_graphslam")
    assert rows(status)["age/sonar/ping"] == "none"


def test_what_is_taken_is_counted(bench: Bench) -> None:
    publisher = bench.publisher()
    for stamp in (1.0, 1.1, 1.2):
        publisher.publish(ping(stamp))
    bench.graph.until(lambda: bench.node.taken == [1.0, 1.1, 1.2])
    found = rows(bench.status(lambda status: rows(status)["received/sonar/ping"] == "3"))
    assert (found["lost/sonar/ping"], found["gaps/sonar/ping"]) == ("0", "0")
    assert float(found["rate/sonar/ping"]) > 0.0
    assert float(found["age/sonar/ping"]) >= 0.0


def test_no_message_ends_the_node_and_each_is_counted(bench: Bench) -> None:
    publisher = bench.publisher()
    for stamp, bearing in ((1.0, float("nan")), (1.1, 3.1), (1.2, 3.1), (1.3, 0.5)):
        publisher.publish(ping(stamp, bearing))
    bench.graph.until(lambda: bench.node.taken == [1.3])
    assert dict(bench.node.diagnostics.refused) == {
        "beam_bearing_not_finite": 1,
        "internal_error": 2,
    }
    status = bench.saying("refused 3 in the last 10 s")
    assert status.level == b"\x01"
    assert rows(status)["refused/internal_error"] == "2"


def test_a_message_that_breaks_its_decoder_is_undecodable(graph: Any) -> None:
    bench = Bench(graph)
    pressures: list[Any] = []
    bench.node.listen(topics.PRESSURE, lambda message: message.no_such_field, pressures.append)
    kind = message_class(topics.PRESSURE.type_name)
    publisher = bench.other.create_publisher(kind, "pressure", STREAM)
    graph.until(publisher.get_subscription_count)
    publisher.publish(kind())
    bench.refused("pressure_undecodable", 1)
    assert pressures == []


def test_a_clock_that_went_back_is_told_and_forgiven_on_reset(bench: Bench) -> None:
    publisher = bench.publisher()
    for stamp in (100.0, 5.0, 6.0):
        publisher.publish(ping(stamp))
    bench.refused("stamp_not_increasing", 2)
    bench.saying("clock of sonar/ping went back by 94.000 s; refused until it has caught up")
    assert bench.call("reset").success
    assert bench.node.resets == 1
    publisher.publish(ping(7.0))
    bench.graph.until(lambda: bench.node.taken == [100.0, 7.0])
    assert "clock" not in bench.status(lambda _: True).message


def test_inputs_without_order_take_what_comes(graph: Any) -> None:
    bench = Bench(graph, ordered=False)
    publisher = bench.publisher()
    for stamp in (2.0, 1.0, 1.0):
        publisher.publish(ping(stamp))
    graph.until(lambda: bench.node.taken == [2.0, 1.0, 1.0])


def test_a_paused_node_drops_and_counts(bench: Bench) -> None:
    publisher = bench.publisher()
    assert bench.call("pause", "SetBool", data=True).message == "paused"
    publisher.publish(ping(1.0))
    bench.refused("paused", 1)
    assert bench.saying("paused").level == b"\x01"
    assert bench.call("pause", "SetBool", data=False).message == "running"
    publisher.publish(ping(2.0))
    bench.graph.until(lambda: bench.node.taken == [2.0])


def test_a_save_that_fails_says_why(bench: Bench) -> None:
    answer = bench.call("save")
    assert (answer.success, "disk full" in answer.message) == (False, True)


def test_of_two_publishers_the_first_heard_is_followed(graph: Any) -> None:
    bench = Bench(graph, single=True)
    first = bench.publisher()
    for i in range(2000):
        first.publish(ping(1.0 + 0.01 * i))
    graph.until(lambda: len(bench.node.taken) == 2000)
    second = bench.publisher()
    for stamp in (30.0, 40.0):
        second.publish(ping(stamp + 0.1))
        first.publish(ping(stamp))
    bench.refused("second_publisher", 2)
    graph.until(lambda: bench.node.taken[-2:] == [30.0, 40.0])
    assert bench.saying("2 publishers on sonar/ping").level == b"\x01"
    bench.other.destroy_publisher(first)
    graph.until(lambda: bench.other.count_publishers(PING.name) == 1)
    second.publish(ping(50.0))
    graph.until(lambda: bench.node.taken[-1] == 50.0)


def test_silence_on_a_required_input_is_an_error(graph: Any) -> None:
    bench = Bench(graph, required=True)
    assert bench.saying("no input on sonar/ping for").level == b"\x02"


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


def test_a_change_of_parameters_that_fails_ends_nothing(bench: Bench) -> None:
    bench.node.on_parameters = lambda _: 1 / 0
    from rclpy.parameter import Parameter

    (result,) = bench.node.set_parameters([Parameter("dead_reckoning.patience", value=3.0)])
    assert result.successful
    assert bench.node.diagnostics.refused["internal_error"] == 1
    assert bench.node.parameters.configuration.dead_reckoning.patience == 3.0


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
