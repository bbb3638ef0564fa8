# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The recorder: what was published is in the bag; what is killed can be salvaged."""

import re
import signal
from pathlib import Path

import pytest
from nodes.processes import Domain, TestNode, wait_until
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sample_bags import sensor_messages

from msss_graphslam.messages import topics
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import TYPES
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.qos import profile_of

CLOCK = "rosgraph_msgs/msg/Clock"

pytestmark = pytest.mark.slow


def publish(source: TestNode, beams: int = 50) -> dict[str, list[bytes]]:
    """Publish every sensor's messages once the recorder listens; return their bytes."""
    publishers = {}
    for name, _, _ in sensor_messages(1):
        topic = topics.find(name)
        assert topic is not None
        kind = message_class(topic.type_name)
        publishers[name] = source.node.create_publisher(kind, topic.name, profile_of(topic))
    for publisher in publishers.values():
        wait_until(publisher.get_subscription_count, "the recorder")
    sent: dict[str, list[bytes]] = {name: [] for name in publishers}
    for name, message, _ in sensor_messages(beams):
        data = bytes(TYPES.serialize_cdr(message, message.__msgtype__))
        publishers[name].publish(data)
        sent[name].append(data)
    return sent


def watch(source: TestNode) -> list[dict[str, int]]:
    """Return a list that grows with the recorder's counts."""
    counts: list[dict[str, int]] = []

    def take(message: object) -> None:
        for status in message.status:
            rows = {row.key: row.value for row in status.values}
            counts.append({k: int(v) for k, v in rows.items() if re.match("recorded/", k)})

    kind = message_class("diagnostic_msgs/msg/DiagnosticArray")
    source.node.create_subscription(kind, "/diagnostics", take, 100)
    return counts


@pytest.mark.parametrize(("name", "namespace"), [("dive", "/"), ("dive.mcap", "/auv")])
def test_what_is_published_is_in_the_bag(
    tmp_path: Path, at: Domain, name: str, namespace: str
) -> None:
    bag = tmp_path / name
    prefix = namespace.rstrip("/")
    options = {"output": bag, "namespace": prefix}
    with (
        TestNode(at, namespace=namespace) as source,
        at.start("bag_recorder", **options) as process,
    ):
        counts = watch(source)
        sent = publish(source)
        wait_until(lambda: counts and counts[-1][f"recorded/{prefix}/ground_truth"] == 50, "all")
        assert not bag.exists()
        assert process.interrupt() == 0
    read: dict[str, list[bytes]] = {}
    for raw in open_recording(bag).messages():
        read.setdefault(raw.channel.topic, []).append(raw.data)
    assert read.pop("/diagnostics")
    assert read == {f"{prefix}{topic}": messages for topic, messages in sent.items()}


def test_in_a_replay_the_log_has_the_times_of_its_clock(tmp_path: Path, at: Domain) -> None:
    bag = tmp_path / "dive.mcap"
    seconds = 1_000_000_000
    with (
        TestNode(at) as source,
        at.start("bag_recorder", output=bag, use_sim_time=True) as process,
    ):
        counts = watch(source)
        clock = source.node.create_publisher(message_class(CLOCK), "/clock", 10)
        publish(source, 3)
        wait_until(lambda: counts and counts[-1]["recorded//ground_truth"] == 3, "the first")
        wait_until(clock.get_subscription_count, "the recorder")
        for second in (100, 101):
            clock.publish(make(CLOCK, clock=make("builtin_interfaces/msg/Time", sec=second)))
        publish(source, 3)
        wait_until(lambda: counts[-1]["recorded//ground_truth"] == 6, "the others")
        assert process.interrupt() == 0
    times = [r.log_ns for r in open_recording(bag).messages() if r.channel.topic == "/imu/data"]
    assert times[: len(times) // 2] == [100 * seconds] * (len(times) // 2)
    assert all(101 * seconds <= time < 102 * seconds for time in times[len(times) // 2 :])
    assert times


def test_what_a_kill_leaves_is_kept_aside(tmp_path: Path, at: Domain) -> None:
    bag = tmp_path / "dive"
    with TestNode(at) as source, at.start("bag_recorder", output=bag) as process:
        counts = watch(source)
        publish(source)
        seen = wait_until(lambda: [c for c in counts if c["recorded//ground_truth"] == 50], "all")
        known = len(seen)
        wait_until(lambda: len(counts) >= known + 3, "the next flushes")
        process.kill()
    assert not bag.exists()
    with at.start("bag_recorder", output=bag) as process:
        process.wait_for_output("an earlier recording was cut off")
        process.wait_for_output("recording into")
        assert process.interrupt() == 0
    kept = open_recording(tmp_path / "dive.unfinished-1")
    assert kept.topics["/sonar/ping"].count == 50
    assert kept.damage.truncated
    assert bag.exists()


def test_an_existing_bag_is_not_touched(tmp_path: Path, at: Domain) -> None:
    bag = tmp_path / "dive.mcap"
    bag.write_bytes(b"precious")
    with at.start("bag_recorder", output=bag) as process:
        assert process.wait() == 1
        assert "exists already" in process.output
        assert len(process.output.splitlines()) == 1
    assert bag.read_bytes() == b"precious"


def test_without_an_output_it_says_so(at: Domain) -> None:
    with at.start("bag_recorder") as process:
        assert process.wait() == 1
        assert "parameter output is missing" in process.output


def test_a_termination_finishes_the_bag(tmp_path: Path, at: Domain) -> None:
    bag = tmp_path / "dive.mcap"
    with at.start("bag_recorder", output=bag) as process:
        process.wait_for_output("recording into")
        process.signal(signal.SIGTERM)
        assert process.wait() == 0
    assert [entry.name for entry in tmp_path.iterdir()] == ["dive.mcap"]


@pytest.mark.parametrize("is_first", [True, False])
def test_a_publisher_without_a_guarantee_is_heard_too(
    tmp_path: Path, at: Domain, *, is_first: bool
) -> None:
    """As some drivers are, whether or not one with a guarantee is there as well."""
    bag = tmp_path / "dive"
    reliable = profile_of(topics.SONAR_PING)
    _, message, _ = next(one for one in sensor_messages(1) if one[0] == "/sonar/ping")
    data = bytes(TYPES.serialize_cdr(message, message.__msgtype__))
    modest = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    kind = message_class(topics.SONAR_PING.type_name)
    with TestNode(at) as source, at.start("bag_recorder", output=bag) as process:
        publisher = source.node.create_publisher(kind, topics.SONAR_PING.name, modest)
        if not is_first:
            other = source.node.create_publisher(kind, topics.SONAR_PING.name, reliable)
            wait_until(other.get_subscription_count, "the recorder")
        process.wait_for_output("sonar/ping is offered without a guarantee")
        wait_until(publisher.get_subscription_count, "the recorder")
        counts = watch(source)

        def recorded() -> bool:
            publisher.publish(data)
            return bool(counts and counts[-1]["recorded//sonar/ping"])

        wait_until(recorded, "a recorded beam")
        assert process.interrupt() == 0
        assert process.output.count("without a guarantee") == 1
    assert open_recording(bag).topics["/sonar/ping"].count > 0
