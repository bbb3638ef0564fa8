# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The pace of a replay: its clock, its lead before the listeners, and how it waits for them."""

import time
from pathlib import Path
from typing import Any

import pytest
from nodes.processes import Domain, TestNode, wait_until
from nodes.replay_listener import SET_BOOL, Listener, Newest, recorded, replay
from sample_bags import BEAM_PERIOD_NS, START_NS, sensor_messages, write_bag

from msss_graphslam.messages import topics
from msss_graphslam.ros.messages import message_class

pytestmark = pytest.mark.slow


def test_a_pause_holds_everything_back(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive")
    with TestNode(at) as other, replay(at, bag) as process:
        assert other.call(SET_BOOL, "bag_replay/pause", data=True).success
        with Listener(at) as listener:
            wait_until(lambda: listener.node.count_publishers("sonar/ping"), "the publisher")
            time.sleep(1.0)
            assert listener.count == 0
            assert process.is_running
            assert other.call(SET_BOOL, "bag_replay/pause", data=False).success
            assert process.wait() == 0
            wait_until(lambda: listener.count == 250, "all messages")


def test_the_clock_goes_with_the_log(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive")
    times: list[int] = []
    clock = message_class("rosgraph_msgs/msg/Clock")
    listener = Listener(at)

    def take(message: Any) -> None:
        times.append(message.clock.sec * 10**9 + message.clock.nanosec)

    listener.node.create_subscription(clock, "/clock", take, 100)
    with listener, replay(at, bag, rate=10) as process:
        assert process.wait() == 0
    assert times == sorted(times)
    assert len(times) >= 10
    assert times[0] >= START_NS
    assert times[-1] <= START_NS + 50 * BEAM_PERIOD_NS


def test_without_a_clock_nobody_publishes_it(tmp_path: Path, at: Domain) -> None:
    with TestNode(at) as other, replay(at, write_bag(tmp_path / "dive"), clock=False):
        wait_until(lambda: other.node.count_publishers("sonar/ping"), "the publisher")
        assert other.node.count_publishers("/clock") == 0


def lagging(listener: Listener, newest: Newest, step_ns: int) -> list[int]:
    """Take no more than a step at a time, and say so; return the leads [ns] as they come."""
    ahead: list[int] = []

    def take() -> None:
        if newest.stamp_ns:
            ahead.append(newest.stamp_ns - newest.told_ns)
            newest.tell(min(newest.stamp_ns, newest.told_ns + step_ns))

    listener.node.create_timer(0.02, take)
    return ahead


def test_a_fast_replay_stays_within_a_second_of_dead_reckoning(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive", sensor_messages(250))
    with Listener(at) as listener:
        newest = Newest(listener)
        ahead = lagging(listener, newest, 200_000_000)
        with replay(at, bag) as process:
            assert process.wait() == 0
            assert "1250 messages, 0 stalls" in process.output
        wait_until(lambda: listener.count == 1250, "all messages")
        assert max(ahead) <= 1_000_000_000
        assert newest.told_ns >= START_NS + 249 * BEAM_PERIOD_NS - 500_000_000


def test_a_fast_replay_stays_within_seconds_of_scan_generation(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive", sensor_messages(500))
    with Listener(at) as listener:
        newest = Newest(listener, topics.SCAN_PROGRESS)
        ahead = lagging(listener, newest, 100_000_000)
        with replay(at, bag) as process:
            assert process.wait() == 0
            assert "2500 messages, 0 stalls" in process.output
        assert 4_000_000_000 < max(ahead) <= 6_000_000_000
        assert newest.told_ns >= START_NS + 499 * BEAM_PERIOD_NS - 500_000_000


def test_a_dead_listener_costs_patience_and_is_counted(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive")
    with Listener(at) as listener:
        Newest(listener)
        with replay(at, bag, patience=0.5) as process:
            assert process.wait() == 0
            assert "no progress for 5 s" in process.output
            assert "replayed 250 messages, 1 stalls" in process.output
            assert "dead reckoning has not reached the end" in process.output
        wait_until(lambda: listener.count == 250, "all messages")


def test_a_node_that_leaves_is_waited_for(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive", sensor_messages(200))
    with replay(at, bag, rate=2) as process:
        with Listener(at) as first:
            wait_until(lambda: first.count > 20, "the first messages")
        process.wait_for_output(r"waiting for dead_reckoning \(")
        with Listener(at) as second:
            assert process.wait() == 0
            wait_until(lambda: second.received["sonar/ping"], "the rest")
            last = recorded(bag)["sonar/ping"][-1]
            wait_until(lambda: second.received["sonar/ping"][-1] == last, "the last beam")
