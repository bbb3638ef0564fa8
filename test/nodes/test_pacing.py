# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a replay decides without ROS: when, how far ahead, which topics."""

import struct
from pathlib import Path

import pytest
from mcap.records import Channel
from sample_bags import START_NS, sensor_messages, write_bag

from msss_graphslam.errors import UserError
from msss_graphslam.nodes.replay.lead import Lead, header_stamp_ns
from msss_graphslam.nodes.replay.pacing import BATCH_NS, Pace, batches
from msss_graphslam.nodes.replay.progress import Progress
from msss_graphslam.nodes.replay.selection import relative_name, select
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import make

SECOND = 1_000_000_000


class Watch:
    """A clock that goes when told to."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def raw(log_ns: int) -> RawMessage:
    channel = Channel(id=1, topic="/a", message_encoding="cdr", metadata={}, schema_id=1)
    return RawMessage(channel, None, log_ns, log_ns, 0, b"")


def stamped(stamp_ns: int, order: str = "<") -> bytes:
    seconds, nanoseconds = divmod(stamp_ns, SECOND)
    head = b"\x00\x01\x00\x00" if order == "<" else b"\x00\x00\x00\x00"
    return head + struct.pack(f"{order}iI", seconds, nanoseconds)


def test_the_first_message_is_due_at_once_and_the_next_in_its_time() -> None:
    watch = Watch()
    pace = Pace(2.0, watch)
    assert pace.delay(START_NS) == 0.0
    assert pace.delay(START_NS + SECOND) == pytest.approx(0.5)
    watch.now += 0.4
    assert pace.delay(START_NS + SECOND) == pytest.approx(0.1)
    watch.now += 0.2
    assert pace.delay(START_NS + SECOND) == 0.0


def test_everything_is_due_at_once_without_a_rate() -> None:
    pace = Pace(0.0, Watch())
    assert [pace.delay(START_NS + second * SECOND) for second in (0, 1, 1000)] == [0.0] * 3


def test_a_short_delay_is_caught_up_and_a_long_one_is_not() -> None:
    for lateness, expected in ((0.4, 0.6), (0.6, 1.0)):
        watch = Watch()
        pace = Pace(1.0, watch)
        pace.delay(START_NS)
        watch.now += 1.0 + lateness
        assert pace.delay(START_NS + SECOND) == 0.0
        assert pace.delay(START_NS + 2 * SECOND) == pytest.approx(expected)


def test_after_a_restart_time_counts_from_the_next_message() -> None:
    watch = Watch()
    pace = Pace(1.0, watch)
    pace.delay(START_NS)
    watch.now += 50.0
    pace.restart()
    assert pace.delay(START_NS + SECOND) == 0.0
    assert pace.delay(START_NS + 2 * SECOND) == pytest.approx(1.0)


def test_batches_keep_the_order_and_their_span() -> None:
    times = [0, 1, BATCH_NS - 1, BATCH_NS, BATCH_NS + 5, 7 * BATCH_NS, 7 * BATCH_NS]
    found = [[message.log_ns for message in batch] for batch in batches(map(raw, times))]
    assert found == [times[:3], times[3:5], times[5:]]
    assert list(batches([])) == []


def test_stamps_are_read_in_both_byte_orders() -> None:
    assert header_stamp_ns(stamped(START_NS + 7)) == START_NS + 7
    assert header_stamp_ns(stamped(START_NS + 7, ">")) == START_NS + 7


@pytest.mark.parametrize("data", [b"", b"\x00\x01\x00\x00" + b"\x01" * 7, b"\x07" * 40])
def test_bytes_that_are_no_message_have_no_stamp(data: bytes) -> None:
    assert header_stamp_ns(data) is None


@pytest.mark.parametrize("offset_ns", [0, 3600 * SECOND, -77])
def test_the_lead_is_counted_in_sensor_time_whatever_the_logs_clock(offset_ns: int) -> None:
    lead = Lead(SECOND)
    for tenth in range(11):
        log_ns = START_NS + tenth * SECOND // 10
        lead.sent(log_ns, stamped(log_ns + offset_ns))
        assert not lead.is_too_long
    lead.sent(START_NS + SECOND + 1, stamped(START_NS + SECOND + 1 + offset_ns))
    assert lead.is_too_long
    assert lead.settled(START_NS + 1 + offset_ns)
    assert not lead.is_too_long


def test_what_is_told_twice_is_no_news() -> None:
    lead = Lead(SECOND)
    assert [lead.settled(1), lead.settled(1), lead.settled(2)] == [True, False, True]


def test_a_senseless_stamp_does_not_change_the_lead() -> None:
    lead = Lead(SECOND)
    for tenth in range(9):
        lead.sent(START_NS + tenth, stamped(START_NS + tenth))
    lead.sent(START_NS + 9, stamped(2**31 * SECOND - 1))
    lead.settled(START_NS + 9)
    assert not lead.is_too_long
    assert lead.is_over


def test_a_release_allows_the_limit_once_more() -> None:
    lead = Lead(SECOND)
    lead.sent(START_NS, b"")
    lead.sent(START_NS + 2 * SECOND, b"")
    assert lead.is_too_long
    lead.release()
    assert not lead.is_too_long
    lead.sent(START_NS + 3 * SECOND, b"")
    assert not lead.is_too_long
    lead.sent(START_NS + 3 * SECOND + 1, b"")
    assert lead.is_too_long


def test_it_is_over_when_dead_reckoning_has_come_to_the_end() -> None:
    lead = Lead(SECOND)
    assert lead.is_over
    lead.sent(START_NS, stamped(START_NS))
    lead.sent(START_NS + SECOND, stamped(START_NS + SECOND))
    assert not lead.is_over
    lead.settled(START_NS)
    assert not lead.is_over
    lead.settled(START_NS + SECOND - SECOND // 10)
    assert lead.is_over
    lead.restart()
    assert lead.is_over


def test_progress_is_told_once_at_each_tenth() -> None:
    watch = Watch()
    progress = Progress(START_NS, START_NS + 100 * SECOND, watch)
    told = []
    for second in range(0, 101, 5):
        watch.now = 100.0 + second / 4.0
        told.append(progress.at(START_NS + second * SECOND))
    lines = [line for line in told if line]
    assert len(lines) == 10
    assert lines[2] == "replayed 30 %: 30.0 s of 100.0 s, 4.0 x real time"


def selected(path: Path, *wanted: str, but: str = "") -> list[str]:
    recording = open_recording(path)
    usable, _ = select(recording, wanted, lambda type_name: type_name != but)
    return sorted(topic.name for topic in usable)


def test_all_inputs_are_replayed_unless_some_are_named(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "dive")
    everything = ["/dvl/twist", "/ground_truth", "/imu/data", "/pressure", "/sonar/ping"]
    assert selected(bag) == everything
    assert selected(bag, "imu/data", "/pressure") == ["/imu/data", "/pressure"]
    assert selected(bag, but="sensor_msgs/msg/Imu") == [n for n in everything if "imu" not in n]


def test_outputs_are_not_replayed_and_raw_bytes_only_without_pings(tmp_path: Path) -> None:
    bytes_message = make("std_msgs/msg/UInt8MultiArray")
    odometry = make("nav_msgs/msg/Odometry")
    others = [("/sonar/raw", bytes_message, START_NS), ("/odom", odometry, START_NS)]
    with_pings = write_bag(tmp_path / "both", [*sensor_messages(2), *others])
    assert "/sonar/raw" not in selected(with_pings)
    assert "/odom" not in selected(with_pings)
    assert selected(with_pings, "odom") == ["/odom"]
    assert selected(write_bag(tmp_path / "raw", others)) == ["/sonar/raw"]


def test_a_namespace_in_the_bag_is_left_behind(tmp_path: Path) -> None:
    messages = [(f"/auv{topic}", message, stamp) for topic, message, stamp in sensor_messages(2)]
    assert selected(write_bag(tmp_path / "dive", messages), "sonar/ping") == ["/auv/sonar/ping"]
    assert relative_name("/auv/sonar/ping") == "sonar/ping"
    assert relative_name("/camera/info") == "camera/info"


def test_a_bag_without_what_is_asked_is_refused(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "dive")
    with pytest.raises(UserError, match="no topic camera, only /dvl/twist, /ground_truth"):
        selected(bag, "imu/data", "camera")
    foreign = [("/a", make("std_msgs/msg/String"), 1)]
    with pytest.raises(UserError, match="nothing to replay"):
        selected(write_bag(tmp_path / "foreign", foreign))
