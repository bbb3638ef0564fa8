# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A node with real inputs: what it takes, what it refuses, what it says of it."""

from typing import Any

import pytest

pytest.importorskip("rclpy")

from listening_node import PING, Bench, ping, rows

from msss_graphslam.messages import topics
from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.qos import STREAM


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


def test_a_change_of_parameters_that_fails_ends_nothing(bench: Bench) -> None:
    bench.node.on_parameters = lambda _: 1 / 0
    from rclpy.parameter import Parameter

    (result,) = bench.node.set_parameters([Parameter("dead_reckoning.patience", value=3.0)])
    assert result.successful
    assert bench.node.diagnostics.refused["internal_error"] == 1
    assert bench.node.parameters.configuration.dead_reckoning.patience == 3.0
