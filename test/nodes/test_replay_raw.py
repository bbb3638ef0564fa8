# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Raw bytes in a replay: when they are sent at all, and with which time of receipt."""

from pathlib import Path

import pytest
from head_bytes import START_NS, packets, raw_messages
from sample_bags import sensor_messages, write_bag

pytest.importorskip("rclpy")

from msss_graphslam.messages import decoding, encoding, topics
from msss_graphslam.nodes.replay.receipt import with_receipt
from msss_graphslam.nodes.replay.selection import select
from msss_graphslam.nodes.replay.settings import ReplaySettings
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import TYPES, decode, make

TYPE = topics.SONAR_RAW.type_name
LOG_NS = START_NS + 5


def serialised(*, labelled: bool, label: str = "") -> bytes:
    message = encoding.raw_bytes(make, b"@\n\x00", START_NS)
    if label:
        message.layout.dim[0].label = label
    elif not labelled:
        message.layout.dim = []
    return bytes(TYPES.serialize_cdr(message, TYPE))


def test_a_time_that_is_there_stays() -> None:
    data = serialised(labelled=True)
    assert with_receipt(data, LOG_NS) is data


@pytest.mark.parametrize("label", ["", "bytes"])
def test_without_a_time_the_logs_is_put_in(label: str) -> None:
    data = with_receipt(serialised(labelled=False, label=label), LOG_NS)
    assert decoding.raw_bytes(decode(data, TYPE)) == decoding.RawBytes(LOG_NS, b"@\n\x00")


@pytest.mark.parametrize(
    "data", [b"", b"\x00\x01\x00\x00", serialised(labelled=True, label="received soon")]
)
def test_what_cannot_be_read_goes_out_as_it_is(data: bytes) -> None:
    assert with_receipt(data, LOG_NS) is data


def test_raw_bytes_are_left_out_beside_pings(tmp_path: Path) -> None:
    both = write_bag(tmp_path / "both", [*sensor_messages(2), *raw_messages(packets(2))])
    bare = write_bag(tmp_path / "bare", raw_messages(packets(2)))
    for bag, expected in ((both, False), (bare, True)):
        chosen, _ = select(open_recording(bag), [], lambda _: True)
        assert ("/sonar/raw" in {topic.name for topic in chosen}) == expected
    named, _ = select(open_recording(both), ["sonar/raw"], lambda _: True)
    assert [topic.name for topic in named] == ["/sonar/raw"]


@pytest.mark.parametrize(
    ("wait_for", "replayed", "expected"),
    [
        (["dead_reckoning", "scan_generation"], ["imu/data"], []),
        (["dead_reckoning", "scan_generation"], ["sonar/raw"], ["micron_driver"]),
        (["dead_reckoning"], ["sonar/raw"], []),
        ([], ["sonar/raw"], []),
    ],
)
def test_the_driver_is_waited_for_where_it_is_fed(
    wait_for: list[str], replayed: list[str], expected: list[str]
) -> None:
    settings = ReplaySettings("bag", 1.0, 0.0, False, [], wait_for, True, True, 60.0)
    assert settings.awaited(replayed) == [*expected, *wait_for]
