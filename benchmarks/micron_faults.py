# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How many damaged packets the framer takes for good: bytes lost or flipped one by one.

``python -m benchmarks.micron_faults`` ends with 1 if a packet with structural damage got through
where bytes were lost or flipped. Where both happen at once, some have to: a packet that lost one
byte, and whose neighbour's ``@`` became a line feed, cannot be told from a good one.
"""

import sys
from argparse import ArgumentParser
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from time import process_time

import numpy as np
from numpy.typing import NDArray

from benchmarks.micron_stream import Sent, sent_bytes
from msss_graphslam.micron.framing import Framer

__all__ = ["FAULTS", "RATES", "Fault", "Tally", "main", "tallied"]

RATES = (1e-4, 1e-3, 1e-2)
_STRUCTURE = (*range(13), -1)
_BEAM_STRUCTURE = (*_STRUCTURE, 13, 14, 42, 43)
_BEAM = 2


@dataclass(frozen=True, slots=True)
class Fault:
    """The chance of a byte to be lost and to be replaced by another."""

    name: str
    lost: float
    flipped: float


FAULTS = tuple(
    Fault(f"{name} {rate:g}", rate * lost, rate * flipped)
    for name, lost, flipped in (("lost", 1, 0), ("flipped", 0, 1), ("both", 0.5, 0.5))
    for rate in RATES
)


@dataclass(slots=True)
class Tally:
    """What became of the packets sent; ``whole`` are those without any fault."""

    sent: int = 0
    whole: int = 0
    accepted: int = 0
    accepted_whole: int = 0
    damaged: int = 0
    bytes: int = 0
    seconds: float = 0.0

    def __str__(self) -> str:
        refused = self.whole - self.accepted_whole
        speed = self.bytes / max(self.seconds, 1e-9) / 1e6
        return (
            f"{self.sent} sent, {self.accepted} accepted, {self.damaged} of them damaged in "
            f"structure; {refused} of {self.whole} whole ones refused; {speed:.1f} MB/s"
        )


def tallied(fault: Fault, packets: int, seed: int) -> Iterator[Tally]:
    """Send packets through the fault, block by block; yield what has become of all so far."""
    random = np.random.default_rng(seed)
    framer, tally = Framer(), Tally()
    while tally.sent < packets:
        sent = sent_bytes(random)
        kept = np.flatnonzero(random.random(len(sent.data)) >= fault.lost)
        flipped = random.random(len(kept)) < fault.flipped
        change = random.integers(1, 256, len(kept), dtype=np.uint8) * flipped
        received = sent.data[kept] ^ change
        faults = np.ones(len(sent.data), dtype=np.int64)
        faults[kept] = flipped
        _add(tally, framer, sent, received, kept, faults)
        yield tally


def _add(
    tally: Tally,
    framer: Framer,
    sent: Sent,
    received: NDArray[np.uint8],
    kept: NDArray[np.intp],
    faults: NDArray[np.int64],
) -> None:
    stream = received.tobytes()
    start = process_time()
    frames = framer.feed(stream)
    framer.reset()
    tally.seconds += process_time() - start
    tally.bytes += len(stream)
    tally.sent += len(sent.starts)
    faulty = np.add.reduceat(faults, sent.starts)
    tally.whole += int((faulty == 0).sum())
    tally.accepted += len(frames)
    position = 0
    for frame in frames:
        packet = frame.encode()
        position = stream.index(packet, position)
        origin = kept[position : position + len(packet)]
        position += len(packet)
        number = int(np.searchsorted(sent.starts, origin[-1], side="right")) - 1
        original = sent.data[sent.starts[number] : sent.ends[number]].tobytes()
        tally.accepted_whole += packet == original and not faulty[number]
        tally.damaged += not _same_structure(packet, original, origin, sent.starts[number])


def _same_structure(packet: bytes, original: bytes, origin: NDArray[np.intp], start: int) -> bool:
    """Say whether the bytes are those of one packet in one piece, its header and sizes intact.

    The ``@`` is left out: one that stands before a packet which lost its own is as good.
    """
    if len(packet) != len(original) or not np.array_equal(
        origin[1:], np.arange(start + 1, start + len(original))
    ):
        return False
    places = _BEAM_STRUCTURE if original[10] == _BEAM else _STRUCTURE
    return all(packet[place] == original[place] for place in places)


def main(arguments: Sequence[str] | None = None) -> None:
    """Send a million packets through each fault; print a line for each."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--packets", type=int, default=1_000_000, help="packets a fault and rate")
    parser.add_argument("--seed", type=int, default=1, help="seed of packets and faults")
    parser.add_argument("--only", default="", help="faults whose name begins so")
    options = parser.parse_args(arguments)
    damaged = 0
    for fault in FAULTS:
        if fault.name.startswith(options.only):
            tally = _shown(fault, options.packets, options.seed)
            damaged += tally.damaged if not (fault.lost and fault.flipped) else 0
    sys.exit(damaged > 0)


def _shown(fault: Fault, packets: int, seed: int) -> Tally:
    """Return the tally of one fault; a line on standard error shows how far it is."""
    tally = Tally()
    tallies = tallied(fault, packets, seed)
    while block := list(islice(tallies, 20)):
        tally = block[-1]
        print(f"\r{fault.name}: {tally.sent} of {packets}", end="", file=sys.stderr, flush=True)
    print("\r", end="", file=sys.stderr)
    print(f"{fault.name:>14}: {tally}", flush=True)
    return tally


if __name__ == "__main__":
    main()
