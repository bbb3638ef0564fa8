# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Messages read where their numbers lie say what the same say when they are decoded whole."""

from collections import Counter
from collections.abc import Callable
from dataclasses import fields, replace
from math import inf, nan
from struct import pack, pack_into
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.records import Channel

from msss_graphslam.config.groups import Sensors
from msss_graphslam.core.types import Beam, Inertial
from msss_graphslam.messages import decoding, encoding, topics
from msss_graphslam.recordings.direct import (
    DirectBeams,
    DirectReading,
    depth_at,
    inertial_at,
    true_pose_at,
)
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.source import Source
from msss_graphslam.recordings.typestore import TYPES, make

SENSORS = Sensors()
CODES = np.array([1.0, 0.0, 255.0, 17.0])
BEAM = Beam(10**18, 0.5, np.array([0.25, 0.5, 0.75, 1.0]), CODES)
IMU = Inertial(10**18, np.array([0.1, 0.2, 0.3]), np.array([0.4, 0.5, 0.6]))
CHANNEL = Channel(1, "/", "cdr", {}, 0)

Feed = list[bytes]
Sources = tuple[Callable[[], Source[Any]], Callable[[], Source[Any]]]


def ping(frame: str = "sonar_link", beam: Beam = BEAM) -> Any:
    return encoding.laser_scan(make, beam, frame, 0.04)


def imu(frame: str = "imu_link", sample: Inertial = IMU) -> Any:
    return encoding.imu(make, sample, frame)


def pressure(frame: str = "base_link") -> Any:
    return encoding.fluid_pressure(make, 10**18, 150_000.0, frame)


def truth(frame: str = "map") -> Any:
    message = encoding.ground_truth(make, 10**18, np.arange(6.0) * 0.1)
    message.header.frame_id = frame
    return message


def depth(message: Any) -> Any:
    return decoding.depth(message, SENSORS)


KINDS: dict[str, tuple[Callable[..., Any], topics.Topic, Any, Callable[[], Any]]] = {
    "beam": (
        ping,
        topics.SONAR_PING,
        decoding.beam,
        lambda: DirectReading(DirectBeams().take, alignment=4),
    ),
    "imu": (imu, topics.IMU, decoding.inertial, lambda: DirectReading(inertial_at)),
    "pressure": (pressure, topics.PRESSURE, depth, lambda: DirectReading(depth_at(SENSORS))),
    "truth": (
        truth,
        topics.GROUND_TRUTH,
        decoding.true_pose,
        lambda: DirectReading(true_pose_at, texts=2),
    ),
}


def encoded(message: Any, *, little_endian: bool = True) -> bytes:
    data = TYPES.serialize_cdr(message, message.__msgtype__, little_endian=little_endian)
    return bytes(data)


def stamped(data: bytes, number: int) -> bytes:
    """Return the little-endian message with a stamp that lies ``number`` s later."""
    changed = bytearray(data)
    pack_into("<i", changed, 4, 1_000_000_000 + number)
    return bytes(changed)


def heard(feed: Feed, source: Source[Any]) -> tuple[list[Any], Counter[str]]:
    """Every number of the records, to be compared bit by bit, and what was refused."""
    refused: Counter[str] = Counter()
    raw = [RawMessage(CHANNEL, None, 0, 0, 0, data) for data in feed]
    records = [record for one in raw for record in source.records_of(one, refused)]
    return [
        [np.asarray(getattr(record, field.name)).tobytes() for field in fields(record)]
        for record in records
    ], refused


def assert_same(kind: str, feed: Feed) -> Counter[str]:
    _, topic, decode, direct = KINDS[kind]
    quick, refused = heard(feed, Source(topic, decode, direct()))
    whole, expected = heard(feed, Source(topic, decode))
    assert quick == whole
    assert refused == expected
    return refused


def taken(kind: str, first: bytes, second: bytes) -> bool:
    """Whether the second is read without being decoded, once the first was."""
    reading = KINDS[kind][3]()
    assert reading.read(first) is None
    reading.learn(first)
    return reading.read(second) is not None


kinds = pytest.mark.parametrize("kind", KINDS)
frames = ["", "a", "ab", "abc", "abcd", "abcde", "a_much_longer_frame", "ü"]


@kinds
@pytest.mark.parametrize(
    "frame", ["", "a", "ab", "abc", "abcd", "abcde", "a_much_longer_frame", "ü"]
)
def test_texts_of_any_length_move_the_numbers(kind: str, frame: str) -> None:
    data = encoded(KINDS[kind][0](frame))
    assert taken(kind, data, stamped(data, 1))
    assert not assert_same(kind, [stamped(data, number) for number in range(4)])


@kinds
def test_another_layout_is_learned_anew(kind: str) -> None:
    first, second = (encoded(KINDS[kind][0](frame)) for frame in ("one", "one_other_frame"))
    assert not taken(kind, first, second)
    order = [first, first, second, second, first, second]
    assert not assert_same(kind, [stamped(data, number) for number, data in enumerate(order)])


@kinds
def test_the_same_length_with_another_text_is_not_taken(kind: str) -> None:
    one, other = (encoded(KINDS[kind][0](frame)) for frame in ("abc", "abd"))
    assert len(one) == len(other)
    assert not taken(kind, one, other)


@kinds
def test_big_endian_is_decoded_whole(kind: str) -> None:
    message = KINDS[kind][0]()
    big = encoded(message, little_endian=False)
    reading = KINDS[kind][3]()
    reading.learn(big)
    assert reading.read(big) is None
    assert not assert_same(kind, [big])
    assert_same(kind, [encoded(message), big, stamped(encoded(message), 1)])


@kinds
def test_every_truncation_is_refused_alike(kind: str) -> None:
    data = encoded(KINDS[kind][0]())
    feed = [part for end in range(len(data)) for part in (data, data[:end])]
    assert assert_same(kind, feed)[f"{KINDS[kind][1].label}_undecodable"] > len(data) - 4


@kinds
def test_trailing_bytes_are_admitted_alike(kind: str) -> None:
    data = encoded(KINDS[kind][0]())
    feed = [
        stamped(data + bytes(extra), 2 * extra + again) for extra in range(9) for again in (0, 1)
    ]
    assert_same(kind, [data, *feed])


@kinds
@given(changes=st.lists(st.tuples(st.integers(0, 10**6), st.integers(0, 255)), min_size=1))
def test_any_bytes_say_the_same_either_way(kind: str, changes: list[tuple[int, int]]) -> None:
    data = encoded(KINDS[kind][0]())
    feed = [data]
    for place, value in changes:
        changed = bytearray(stamped(data, len(feed)))
        changed[place % len(data)] = value
        feed += [bytes(changed), stamped(data, len(feed) + 1)]
    assert_same(kind, feed)


@pytest.mark.parametrize("word", [nan, inf, -inf, -0.0, -1.0, 1e300])
@pytest.mark.parametrize("kind", ["imu", "pressure", "truth"])
def test_any_number_may_be_odd(kind: str, word: float) -> None:
    data = encoded(KINDS[kind][0]("base_link"))
    places = range((len(data) - 4) % 8 + 4, len(data) - 7, 8)
    feed = []
    for number, place in enumerate(places):
        changed = bytearray(stamped(data, number))
        pack_into("<d", changed, place, word)
        feed += [stamped(data, number), bytes(changed)]
    assert_same(kind, [data, *feed])


@pytest.mark.parametrize("number", [nan, inf, -inf, -0.0, -1e-30, 255.0, 255.0001, 256.0, 1e-40])
def test_any_number_of_a_beam_may_be_odd(number: float) -> None:
    data = encoded(ping("base_link"))
    feed = [data]
    for place in range(4, len(data) - 3, 4):
        changed = bytearray(stamped(data, len(feed)))
        changed[place : place + 4] = pack("<f", number)
        feed += [bytes(changed), stamped(data, len(feed) + 1)]
    assert_same("beam", feed)


@pytest.mark.parametrize("bearing", [nan, inf, -inf])
def test_a_bearing_that_is_none_is_refused(bearing: float) -> None:
    data = encoded(ping())
    odd = stamped(encoded(ping(beam=replace(BEAM, bearing=bearing))), 1)
    assert assert_same("beam", [data, odd]) == {"beam_bearing_not_finite": 1}


@pytest.mark.parametrize(
    ("code", "is_taken"), [(255.0, True), (255.00002, False), (-1e-45, False)]
)
def test_codes_from_both_sides(code: float, is_taken: bool) -> None:
    data = encoded(ping())
    changed = data[:-4] + pack("<f", code)
    assert taken("beam", data, changed) is is_taken
    assert_same("beam", [data, stamped(changed, 1)])


@pytest.mark.parametrize(("ranges", "codes"), [(5, 3), (3, 5), (8, 0), (0, 8), (2**31, 4), (4, 5)])
def test_counts_that_lie(ranges: int, codes: int) -> None:
    data = encoded(ping())
    lying = bytearray(stamped(data, 1))
    codes_at = len(data) - 4 * len(CODES) - 4
    pack_into("<I", lying, codes_at - 4 * len(CODES) - 4, ranges)
    pack_into("<I", lying, codes_at, codes)
    assert not taken("beam", data, bytes(lying))
    assert_same("beam", [data, bytes(lying), stamped(data, 2)])


def test_changed_bins_are_taken_over_and_checked() -> None:
    other = replace(BEAM, ranges=BEAM.ranges + 0.125)
    falling = replace(BEAM, ranges=BEAM.ranges[::-1])
    order = [BEAM, BEAM, other, BEAM, falling, other, falling, other]
    feed = [stamped(encoded(ping(beam=beam)), number) for number, beam in enumerate(order)]
    assert assert_same("beam", feed) == {"beam_ranges_not_increasing": 2}


def test_beams_share_their_bins() -> None:
    reading = KINDS["beam"][3]()
    data = encoded(ping())
    reading.learn(data)
    first, second = reading.read(data), reading.read(stamped(data, 1))
    assert first.ranges is second.ranges
    assert first.intensities is not second.intensities


@pytest.mark.parametrize(
    "sample", [replace(IMU, orientation=None), replace(IMU, angular_velocity=None)]
)
def test_what_an_imu_does_not_give_is_none(sample: Inertial) -> None:
    whole, part = encoded(imu()), encoded(imu(sample=sample))
    assert taken("imu", whole, part)
    assert not assert_same("imu", [whole, stamped(part, 1), stamped(whole, 2)])


def test_an_imu_without_anything_is_refused() -> None:
    empty = encoded(imu(sample=Inertial(1, None, None)))
    assert assert_same("imu", [encoded(imu()), stamped(empty, 1)]) == {"imu_without_data": 1}
