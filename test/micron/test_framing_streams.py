# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Long streams: garbage between packets, any chunks, hostile data, and a plain second reader."""

from itertools import pairwise

import numpy as np
import pytest
from micron.packet_makers import beam, drawn_packets
from micron.slow_framer import slow_packets

from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import Reboot


def found(stream: bytes, framer: Framer | None = None) -> list[bytes]:
    return [frame.encode() for frame in (framer or Framer()).feed(stream)]


def chunks(stream: bytes, random: np.random.Generator, largest: int) -> list[bytes]:
    sizes = random.integers(1, largest + 1, len(stream))
    cuts = [0, *np.cumsum(sizes[: np.searchsorted(np.cumsum(sizes), len(stream))]), len(stream)]
    return [stream[a:b] for a, b in pairwise(cuts)]


def damaged(stream: bytes, random: np.random.Generator) -> bytes:
    """Lose single bytes and two stretches."""
    whole = np.frombuffer(stream, dtype=np.uint8)
    kept = random.random(len(whole)) > 1e-3
    for start in random.integers(0, len(whole), 2):
        kept[start : start + random.integers(300)] = False
    return whole[kept].tobytes()


def state(framer: Framer) -> tuple[object, ...]:
    return dict(framer.refused), framer.skipped_bytes, framer.pending


def test_f1_garbage_between_packets_costs_none() -> None:
    random = np.random.default_rng(1)
    for seed in range(300):
        packets = drawn_packets(random, 6, kind=seed % 3)
        stream = b""
        for packet in packets:
            part = packet[: random.integers(len(packet))]
            garbage = [random.bytes(int(random.integers(1, 400))), part, b"@" * 50, b"@0341"]
            stream += garbage[int(random.integers(4))] + packet
        assert found(stream) == packets


def test_f3_chunks_make_no_difference() -> None:
    for seed in range(1000):
        random = np.random.default_rng(seed)
        packets = drawn_packets(random, 8, kind=seed % 3)
        stream = damaged(b"".join(packets), random) if seed % 2 else b"".join(packets)
        at_once, framer = Framer(), Framer()
        expected = at_once.feed(stream)
        largest = 4096 if seed % 3 else int(random.integers(1, 40))
        frames = [f for chunk in chunks(stream, random, largest) for f in framer.feed(chunk)]
        assert frames == expected
        assert state(framer) == state(at_once)


@pytest.mark.parametrize("data", [b"@", b"\n", b"@\n", b"@\n\n", b"@0341"])
def test_f4_data_full_of_starts_and_ends(data: bytes) -> None:
    packets = [beam((data * size)[:size]) for size in (*range(1, 300), 1499, 1500)]
    framer = Framer()
    assert found(b"".join(packets), framer) == packets
    assert state(framer) == ({}, 0, 0)


def test_it_finds_what_trying_every_place_finds() -> None:
    for seed in range(60):
        random = np.random.default_rng(seed)
        data = np.frombuffer(b"".join(drawn_packets(random, 6, seed % 3)), dtype=np.uint8)
        kept = data[random.random(len(data)) > 0.004].copy()
        struck = random.random(len(kept)) < 0.004
        kept[struck] = random.choice(np.frombuffer(b"@\n0\x02\xff", dtype=np.uint8), struck.sum())
        stream = kept.tobytes() + Reboot().frame().encode() + bytes(1600)
        assert found(stream) == slow_packets(stream)
