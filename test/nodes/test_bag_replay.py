# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Replay into real subscribers: bit by bit, in order, at their pace, to the very end."""

import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from head_bytes import packets, raw_messages
from nodes.processes import LIMIT, Domain, NodeProcess, TestNode, domain, wait_until
from sample_bags import BEAM_PERIOD_NS, START_NS, sensor_messages, write_bag

from msss_graphslam.messages import topics
from msss_graphslam.nodes.replay.lead import header_stamp_ns
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.qos import STREAM, profile_of

pytestmark = pytest.mark.slow

SENSORS = (topics.GROUND_TRUTH, topics.DVL, topics.PRESSURE, topics.IMU, topics.SONAR_PING)
TRIGGER = message_class("std_srvs/srv/Trigger")
SET_BOOL = message_class("std_srvs/srv/SetBool")


@pytest.fixture
def at() -> Iterator[Domain]:
    with domain() as found:
        yield found


class Listener(TestNode):
    """Passes for dead reckoning: takes every sensor's bytes, and may tell how far it is."""

    def __init__(self, of: Domain, *, namespace: str = "/", remapped: str = "") -> None:
        super().__init__(of, "dead_reckoning", namespace)
        self.received: defaultdict[str, list[bytes]] = defaultdict(list)
        self.called: list[str] = []
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


def test_bytes_alone_are_said_to_want_the_driver(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive", raw_messages(packets(3)))
    waited = {"wait_for": "[dead_reckoning, scan_generation]"}
    with replay(at, bag, **waited) as process:
        process.wait_for_output(r"waiting for micron_driver \(sonar/raw\).*sonar:=raw")


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


def test_a_fast_replay_stays_within_a_second_of_dead_reckoning(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive", sensor_messages(250))
    ahead: list[int] = []
    with Listener(at) as listener:
        newest = Newest(listener)

        def settle() -> None:
            """Take only half of what is there, and say so: the lead is what has come since."""
            if newest.stamp_ns:
                ahead.append(newest.stamp_ns - newest.told_ns)
                newest.tell(min(newest.stamp_ns, newest.told_ns + 200_000_000))

        listener.node.create_timer(0.02, settle)
        with replay(at, bag) as process:
            assert process.wait() == 0
            assert "1250 messages, 0 stalls" in process.output
        wait_until(lambda: listener.count == 1250, "all messages")
        assert max(ahead) <= 1_000_000_000
        assert newest.told_ns >= START_NS + 249 * BEAM_PERIOD_NS - 500_000_000


def test_a_fast_replay_stays_within_seconds_of_scan_generation(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive", sensor_messages(500))
    ahead: list[int] = []
    with Listener(at) as listener:
        newest = Newest(listener, topics.SCAN_PROGRESS)

        def take() -> None:
            if newest.stamp_ns:
                ahead.append(newest.stamp_ns - newest.told_ns)
                newest.tell(min(newest.stamp_ns, newest.told_ns + 100_000_000))

        listener.node.create_timer(0.02, take)
        with replay(at, bag) as process:
            assert process.wait() == 0
            assert "2500 messages, 0 stalls" in process.output
        assert 4_000_000_000 < max(ahead) <= 6_000_000_000
        assert newest.told_ns >= START_NS + 499 * BEAM_PERIOD_NS - 500_000_000


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


def test_at_the_end_each_node_saves_when_it_is_through(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive")
    listener = Listener(at)
    listener.answer("back_end/save")
    listener.answer("dead_reckoning/save", refusals=2)
    with listener, replay(at, bag, conclude=True) as process:
        assert process.wait() == 0
        assert listener.called == ["dead_reckoning/save"] * 3 + ["back_end/save"]
        assert "dead_reckoning is done: call 3" in process.output
        assert listener.count == 250


def test_a_node_that_is_started_again_while_it_saves_is_asked_again(
    tmp_path: Path, at: Domain
) -> None:
    bag = write_bag(tmp_path / "dive")
    asked, over = threading.Event(), threading.Event()

    def hang(_: Any, response: Any) -> Any:
        """Take the question and give no answer, as one that has died."""
        asked.set()
        over.wait()
        return response

    with Listener(at) as listener, TestNode(at, "first") as first:
        listener.answer("dead_reckoning/save")
        first.node.create_service(TRIGGER, "back_end/save", hang)
        with replay(at, bag, conclude=True) as process:
            assert asked.wait(LIMIT)
            listener.answer("back_end/save")
            code = process.wait()
            over.set()
        assert code == 0
        assert listener.called == ["dead_reckoning/save", "back_end/save"]
        assert "back_end is done: call 1" in process.output


def test_each_lap_begins_with_a_reset_from_the_end_to_the_beginning(
    tmp_path: Path, at: Domain
) -> None:
    bag = write_bag(tmp_path / "dive")
    listener = Listener(at)
    for name in ("dead_reckoning", "front_end", "back_end"):
        listener.answer(f"{name}/reset")
    with listener, replay(at, bag, loop=True) as process:
        wait_until(lambda: listener.count >= 500, "two laps")
        assert process.interrupt() == 0
        assert listener.called[:3] == ["back_end/reset", "front_end/reset", "dead_reckoning/reset"]
        pings = listener.received["sonar/ping"]
        assert pings[:100] == recorded(bag)["sonar/ping"] * 2


@pytest.mark.parametrize("wait_for", ["[dead_reckoning]", "['']"])
def test_an_interrupt_ends_it_cleanly(tmp_path: Path, at: Domain, wait_for: str) -> None:
    bag = write_bag(tmp_path / "dive")
    with TestNode(at) as other, replay(at, bag, rate=0.01, wait_for=wait_for) as process:
        wait_until(lambda: other.node.count_publishers("sonar/ping"), "the publisher")
        assert process.interrupt(5.0) == 0
        assert "Traceback" not in process.output


@pytest.mark.parametrize(
    ("parameters", "complaint"),
    [
        ({"bag": "nowhere"}, "nowhere: no such file or folder"),
        ({"bag": "''"}, "parameter bag is missing"),
        ({"topics": "[camera]"}, "no topic camera, only /dvl/twist"),
        ({"start_offset": 2.5}, "start_offset 2.5 s lies behind the end, the bag spans 2.0 s"),
        ({"rate": -1.0}, "parameter rate is -1.0, must be a number of at least 0"),
        ({"rate": "fast"}, "parameter rate is 'fast'"),
    ],
)
def test_what_cannot_be_replayed_is_told_in_one_line(
    tmp_path: Path, at: Domain, parameters: dict[str, Any], complaint: str
) -> None:
    bag = write_bag(tmp_path / "dive")
    options = {"bag": bag, "wait_for": "['']", **parameters}
    with at.start("bag_replay", **options) as process:
        assert process.wait() == 1
        assert complaint in process.output
        assert len(process.output.splitlines()) == 1
