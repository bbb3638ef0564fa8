# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Damaged packets are refused, and no input stops the framer or fills the memory."""

import numpy as np
import pytest
from micron.packet_makers import ALIVE_HEADER, beam, drawn_packets

from benchmarks.micron_faults import FAULTS, Fault, tallied
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.header import MAXIMUM_SIZE

ONE_KIND = [fault for fault in FAULTS if not (fault.lost and fault.flipped)]
PIECE = 1 << 16


@pytest.mark.parametrize("fault", ONE_KIND, ids=lambda fault: fault.name)
def test_f2_lost_and_flipped_bytes(fault: Fault) -> None:
    *_, tally = tallied(fault, packets=3000, seed=7)
    assert tally.damaged == 0
    assert tally.accepted_whole == tally.whole
    assert 0 < tally.whole < tally.sent


def test_f2_is_able_to_fail() -> None:
    # What no receiver can see: packets of whose bytes none was lost, but for their data.
    *_, tally = tallied(Fault("", lost=0.0, flipped=1e-2), packets=1000, seed=7)
    assert tally.accepted > 5 * tally.accepted_whole


@pytest.mark.parametrize("bins", [227, 235, 483, 491])
def test_a_length_with_a_line_feed_in_it(bins: int) -> None:
    """The packet loses as many bytes as put the next one's line feed at its end."""
    packet = beam(bytes([7]) * bins)
    place = packet.index(b"\n")
    assert place in (5, 13)
    framer = Framer()
    frames = framer.feed(packet[: -place - 10] + packet[-9:] + packet)
    assert [frame.encode() for frame in frames] == [packet]
    assert framer.refused == {"it reaches into the next packet": 1}


@pytest.mark.parametrize(
    ("bins", "lost_places"), [(483, [0]), (483, [0, 3]), (483, [2, 3, 4]), (300, [])]
)
def test_a_damaged_length_with_a_line_feed_in_it(bins: int, lost_places: list[int]) -> None:
    """Beams of one setting have the same length; another's is known when it is whole."""
    packet, follower = beam(bytes([7]) * bins), bytearray(beam(bytes([7]) * 483))
    for place in reversed(lost_places):
        del follower[place]
    lost = follower.index(b"\n") + 1
    framer = Framer()
    frames = framer.feed(packet[: -lost - 9] + packet[-9:] + bytes(follower))
    assert [frame.encode() for frame in frames] == ([] if lost_places else [follower])
    assert framer.refused["it reaches into the next packet"] == 1


@pytest.mark.parametrize("hit", range(13))
@pytest.mark.parametrize("lose", [False, True])
def test_a_damaged_header_is_no_data(hit: int, lose: bool) -> None:
    """The next header is damaged, and one of its data stands as a line feed at the end."""
    lost = 60
    follower = bytearray(beam(bytes([7]) * 15 + b"\n" * 10 + bytes([9]) * 275))
    if lose:
        del follower[hit]
    else:
        follower[hit] ^= 0x15
    packet = beam(bytes([7]) * 300)
    framer = Framer()
    assert framer.feed(packet[: -lost - 50] + packet[-50:] + bytes(follower)) == []
    assert framer.refused["it reaches into the next packet"] == 1


def test_a_header_cut_off_by_the_end_is_no_data() -> None:
    """One bit is enough to make a line feed of the sender's number."""
    packet = beam(bytes([7]) * 300)
    for place in (7, 10, 12):
        follower = bytearray(packet)
        follower[place] ^= 0x08
        framer = Framer()
        stream = packet[: -place - 51] + packet[-50:] + bytes(follower) + packet
        assert [frame.encode() for frame in framer.feed(stream)] == [packet]


def test_ten_megabytes_of_anything() -> None:
    random = np.random.default_rng(11)
    for chunk in (fuzz_of_noise, fuzz_with_headers):
        framer, fed, taken = Framer(), 0, 0
        while fed < 5_000_000:
            data = chunk(random)
            frames = framer.feed(data)
            fed += len(data)
            taken += sum(frame.size for frame in frames)
            assert framer.pending < MAXIMUM_SIZE
            assert taken + framer.skipped_bytes + framer.pending == fed
        assert framer.refused["noise"] > 0


def fuzz_of_noise(random: np.random.Generator) -> bytes:
    return random.bytes(int(random.integers(1, 3 * PIECE)))


def fuzz_with_headers(random: np.random.Generator) -> bytes:
    parts = []
    for _ in range(40):
        packets = drawn_packets(random, 1)
        header = [packets[0][:13], packets[0][:44], packets[0], ALIVE_HEADER, b"@0@00"]
        parts.append(header[int(random.integers(5))])
        parts.append(random.bytes(int(random.integers(1, 200))))
    return b"".join(parts)
