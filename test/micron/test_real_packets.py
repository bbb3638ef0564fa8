# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Packets of real heads: all are found, read, and written as they came."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from micron.recorded_packets import hex_packets, seanet_frames, udp_datagrams

from msss_graphslam.micron.beam import beam_of
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import (
    HeadControl,
    HeadData,
    Sweep,
    UserData,
    VersionData,
    decode_packet,
)


@pytest.fixture(scope="module")
def udp_beams() -> list[HeadData]:
    framer = Framer()
    packets = [decode_packet(frame) for part in udp_datagrams() for frame in framer.feed(part)]
    return [packet for packet in packets if isinstance(packet, HeadData)]


@pytest.fixture(scope="module")
def seanet_packets() -> list[object]:
    return [decode_packet(frame) for frame in seanet_frames()]


def test_the_udp_log_holds_765_beams_and_they_are_written_as_they_came() -> None:
    stream = b"".join(udp_datagrams())
    framer = Framer()
    frames = framer.feed(stream)
    rewritten = b"".join(decode_packet(frame).frame().encode() for frame in frames)
    assert len(frames) == 765
    assert stream[24:].startswith(rewritten)
    assert framer.refused == {"noise": 1}
    assert framer.skipped_bytes == 24
    assert framer.pending == len(stream) - 24 - len(rewritten) < 839


def test_the_seanet_log_holds_468_beams_and_they_are_written_as_they_came() -> None:
    frames = list(seanet_frames())
    packets = [decode_packet(frame) for frame in frames]
    kinds = Counter(type(packet) for packet in packets)
    assert kinds == {HeadData: 468, UserData: 1, VersionData: 1}
    assert [packet.frame() for packet in packets] == frames
    framer = Framer()
    stream = b"".join(packet.frame().encode() for packet in packets)
    assert framer.feed(stream) == frames
    assert not framer.refused


def test_packets_written_out_as_text() -> None:
    packets = hex_packets()
    assert len(packets) == 4
    frames = Framer().feed(b"".join(packets))
    assert [decode_packet(frame).frame().encode() for frame in frames] == packets


def test_fields_of_the_udp_log(udp_beams: list[HeadData]) -> None:
    first = udp_beams[0]
    assert (first.device_type, first.range_scale, first.transmit) == (0x11, 500, 0x05333333)
    assert (first.gain, first.slope, first.ad_span, first.ad_low) == (0x3A, 0x73, 0x87, 0x22)
    assert (first.ad_interval, first.left_limit, first.right_limit) == (133, 1778, 4622)
    assert (first.step, first.bearing, first.bins) == (32, 3118, 794)
    assert {beam.sweep for beam in udp_beams} == {0, Sweep.LEFT_LIMIT, Sweep.RIGHT_LIMIT}
    beam = beam_of(first, 0, 1500.0)
    assert beam.ranges[-1] == pytest.approx(50.66, abs=0.01)
    assert np.degrees(beam.bearing) == pytest.approx(82 * 0.05625)


def test_bearings_rise_where_the_head_scans_right(udp_beams: list[HeadData]) -> None:
    for before, after in pairwise(udp_beams):
        if before.sweep == Sweep.NORMAL:
            right = HeadControl.SCAN_RIGHT in before.control
            assert (after.bearing > before.bearing) == right


def test_fields_of_the_seanet_log(seanet_packets: list[object]) -> None:
    beams = [packet for packet in seanet_packets if isinstance(packet, HeadData)]
    assert {beam.device_type for beam in beams} == {2}
    assert {(beam.left_limit, beam.right_limit, beam.step) for beam in beams} == {(2400, 4000, 64)}
    assert {(beam.bins, beam.ad_interval) for beam in beams} == {(642, 33)}
    assert beam_of(beams[0], 0, 1500.0).ranges[-1] == pytest.approx(10.16, abs=0.01)
    assert VersionData(0x31, 0x11, 0, 0xB012, 0x2AEB) in seanet_packets
