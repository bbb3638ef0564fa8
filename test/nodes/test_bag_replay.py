# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Replay into real subscribers: every message, bit by bit and in order."""

from pathlib import Path

import pytest
from head_bytes import packets, raw_messages
from nodes.processes import Domain, TestNode, wait_until
from nodes.replay_listener import Listener, recorded, replay
from sample_bags import sensor_messages, write_bag

from msss_graphslam.messages import topics
from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.qos import STREAM

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("name", ["dive", "dive.mcap"])
def test_every_message_arrives_as_it_is(tmp_path: Path, at: Domain, name: str) -> None:
    bag = write_bag(tmp_path / name)
    with Listener(at) as listener, replay(at, bag) as process:
        assert process.wait() == 0
        wait_until(lambda: listener.count == 250, "all messages")
        assert listener.received == recorded(bag)
        assert "replayed 250 messages, 0 stalls" in process.output


def test_only_these_topics_from_there_on(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive")
    options = {"start_offset": 1, "topics": "[sonar/ping, /pressure]"}
    with Listener(at) as listener, replay(at, bag, **options) as process:
        assert process.wait() == 0
        expected = recorded(bag, 1.0)
        assert 0 < len(expected["pressure"]) < 50
        wait_until(lambda: listener.count == 50, "all messages")
        assert listener.received["pressure"] == expected["pressure"]
        assert listener.received["sonar/ping"] == expected["sonar/ping"]


def test_namespaces_and_remapping(tmp_path: Path, at: Domain) -> None:
    messages = [(f"/boat{name}", message, stamp) for name, message, stamp in sensor_messages()]
    bag = write_bag(tmp_path / "dive", messages)
    arguments = ("-r", "sonar/ping:=head/beam")
    listener = Listener(at, namespace="/auv", remapped="head/beam")
    with listener, replay(at, bag, *arguments, namespace="/auv") as process:
        assert process.wait() == 0
        wait_until(lambda: listener.count == 250, "all messages")
        assert listener.received == recorded(bag)


def test_nothing_is_sent_before_everybody_listens(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive")
    names = "[dead_reckoning, scan_generation]"
    with Listener(at) as listener, replay(at, bag, wait_for=names) as process:
        process.wait_for_output(r"waiting for scan_generation \(sonar/ping\)")
        assert listener.count == 0
        with TestNode(at, "scan_generation") as late:
            pings: list[bytes] = []
            kind = message_class(topics.SONAR_PING.type_name)
            late.node.create_subscription(kind, "sonar/ping", pings.append, STREAM, raw=True)
            assert process.wait() == 0
            wait_until(lambda: len(pings) == 50 and listener.count == 250, "all messages")


def test_nothing_is_sent_before_the_poses_that_come_of_it_are_heard(
    tmp_path: Path, at: Domain
) -> None:
    bag = write_bag(tmp_path / "dive")
    names = "[dead_reckoning, back_end]"
    with Listener(at) as listener, replay(at, bag, wait_for=names) as process:
        process.wait_for_output(r"waiting for back_end \(pose\)")
        with TestNode(at, "back_end") as late:
            kind = message_class(topics.POSE.type_name)
            late.node.create_subscription(kind, "pose", lambda _: None, STREAM)
            listener.tells(topics.POSE, 0)
            process.wait_for_output(r"(?s)(waiting for back_end \(pose\).*){2}")
            assert listener.count == 0
            listener.tells(topics.POSE, 1)
            assert process.wait() == 0
            wait_until(lambda: listener.count == 250, "all messages")


def test_bytes_alone_are_said_to_want_the_driver(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive", raw_messages(packets(3)))
    waited = {"wait_for": "[dead_reckoning, scan_generation]"}
    with replay(at, bag, **waited) as process:
        process.wait_for_output(r"waiting for micron_driver \(sonar/raw\).*sonar:=raw")
