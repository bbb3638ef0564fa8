# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Packets found in a stream: whole ones all of them, others never, whatever lies between."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from micron.packet_makers import COMMANDS, REPLIES, beam

from msss_graphslam.micron.frame import HEAD, HOST, Frame
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import Alive, HeadInformation, Packet, decode_packet

ALIVE = Alive(HeadInformation.CENTRED).frame().encode()
REFUSED_HEADERS = {
    "its two lengths differ": (5, 0x0F),
    "unknown type": (10, 99),
    "unknown node": (12, 3),
    "part of a message": (11, 0x81),
    "wrong count": (9, 12),
}


def found(stream: bytes, framer: Framer | None = None) -> list[bytes]:
    return [frame.encode() for frame in (framer or Framer()).feed(stream)]


def state(framer: Framer) -> tuple[object, ...]:
    return dict(framer.refused), framer.skipped_bytes, framer.pending


@given(st.lists(st.one_of(REPLIES, COMMANDS), max_size=8))
def test_whole_packets_come_out_as_they_were_sent(packets: list[Packet]) -> None:
    framer = Framer()
    frames = framer.feed(b"".join(packet.frame().encode() for packet in packets))
    assert [decode_packet(frame) for frame in frames] == packets
    assert not framer.refused
    assert state(framer) == ({}, 0, 0)


@pytest.mark.parametrize("data", [bytes, bytearray, memoryview])
def test_any_bytes_like_object_is_read(data: type) -> None:
    assert Framer().feed(data(ALIVE)) == [Alive(HeadInformation.CENTRED).frame()]


@pytest.mark.parametrize("reason", REFUSED_HEADERS)
def test_a_header_that_contradicts_itself_is_refused(reason: str) -> None:
    place, value = REFUSED_HEADERS[reason]
    damaged = bytearray(ALIVE)
    damaged[place] = value
    framer = Framer()
    assert found(damaged + ALIVE, framer) == [ALIVE]
    assert framer.refused == {reason: 1}
    assert framer.skipped_bytes == len(ALIVE)


@pytest.mark.parametrize(
    ("source", "destination"), [(HOST, HEAD), (HEAD, HEAD), (HOST, HOST), (HEAD, 0), (15, HOST)]
)
def test_a_reply_comes_from_the_head_and_goes_to_the_host(source: int, destination: int) -> None:
    framer = Framer()
    assert not framer.feed(Frame(4, bytes(8), source, destination).encode())
    assert framer.refused == {"unknown node": 1}


@pytest.mark.parametrize("size", [0, 7, 9, 11, 161])
def test_a_length_that_its_type_never_has_is_refused(size: int) -> None:
    framer = Framer()
    assert not framer.feed(Frame.from_head(4, bytes(size)).encode())
    assert framer.refused == {"its length is not its type's": 1}


def test_lower_case_digits_are_no_header() -> None:
    packet = beam(bytes(166))
    assert packet[:5] == b"@00CD"
    framer = Framer()
    assert not framer.feed(packet[:1] + packet[1:5].lower() + packet[5:])
    assert framer.refused == {"noise": 1}


def test_the_longest_beam_is_read_and_a_longer_one_refused() -> None:
    longest = beam(bytes(1500))
    assert found(longest) == [longest]
    framer = Framer()
    assert not framer.feed(beam(bytes(1501)))
    assert framer.refused == {"its length is not its type's": 1}
    assert framer.pending == 0


@pytest.mark.parametrize("place", [13, 14, 42, 43])
def test_a_beam_whose_inner_sizes_differ_is_refused(place: int) -> None:
    damaged = bytearray(beam(bytes(300)))
    damaged[place] ^= 1
    framer = Framer()
    assert found(damaged + ALIVE, framer) == [ALIVE]
    assert framer.refused == {"its inner sizes differ": 1}


@pytest.mark.parametrize("size", [1, 17, 52, 68])
@pytest.mark.parametrize("form", [0x00, 0x01, 0x0F, 0x1D, 0x1E])
def test_the_form_of_a_head_command_has_its_length(size: int, form: int) -> None:
    packet = Frame.to_head(19, bytes([form]) + bytes(size - 1)).encode()
    fits = {1: 0x0F, 17: 0x1E, 52: 0x01, 68: 0x1D}[size] == form
    assert found(packet + ALIVE) == ([packet] if fits else []) + [ALIVE]


def test_a_packet_cut_short_costs_no_other() -> None:
    packet = beam(bytes(range(256)) * 3 + bytes(26))
    for cut in range(1, len(packet)):
        framer = Framer()
        assert found(packet[:cut] + packet + ALIVE, framer) == [packet, ALIVE]
        assert framer.skipped_bytes == cut


def test_a_false_promise_holds_nothing_back() -> None:
    promise = beam(bytes(1500))[:13]
    framer = Framer()
    assert found(promise + b"junk", framer) == []
    assert found(ALIVE, framer) == [ALIVE]
    assert framer.refused == {"it reaches into the next packet": 1}


def test_a_false_promise_is_seen_through_byte_by_byte() -> None:
    stream = beam(bytes(1500))[:13] + b"junk" + ALIVE
    framer = Framer()
    assert [len(framer.feed(stream[i : i + 1])) for i in range(39)] == [0] * 38 + [1]
    assert framer.refused == {"it reaches into the next packet": 1}


def test_a_packet_comes_out_with_its_last_byte() -> None:
    framer = Framer()
    assert [len(framer.feed(ALIVE[i : i + 1])) for i in range(22)] == [0] * 21 + [1]


def test_a_reset_forgets_what_has_begun() -> None:
    framer = Framer()
    framer.feed(ALIVE[:10])
    framer.reset()
    assert framer.pending == 0
    assert framer.skipped_bytes == 10
    assert found(ALIVE[10:] + ALIVE, framer) == [ALIVE]


def test_noise_is_counted_by_its_stretches() -> None:
    framer = Framer()
    for noise in (b"@@@", b"@12", b"", b"\n\n"):
        found(noise + ALIVE, framer)
    assert framer.refused == {"noise": 3}
    assert framer.skipped_bytes == 8
