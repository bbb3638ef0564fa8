# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From the bytes of a line, cut anywhere and damaged anyhow, to frames.

``@`` and line feed are normal data, so a packet is known by all that it says of itself. Where one
fails, the search goes on at its second byte: a whole packet inside or behind it is found. A
packet never waits for one before it: as soon as its own header is there, that one is broken.
"""

import re
from collections import Counter

from msss_graphslam.micron.frame import HEADER_SIZE, HOST, Frame
from msss_graphslam.micron.header import (
    broken_body,
    header_fault,
    next_header,
    packet_size,
)
from msss_graphslam.micron.traces import reaches_into_next

__all__ = ["Framer"]

_PIECE = 1 << 16
_START = re.compile(rb"@(?:[0-9A-F]{4}|[0-9A-F]{0,3}\Z)")
_SWALLOWED = "it reaches into the next packet"


class Framer:
    """Finds the packets in a stream of bytes; what comes out does not depend on its chunks.

    Attributes
    ----------
    refused : Counter[str]
        What looked like a packet and was none, by reason, and stretches of other bytes as
        "noise".
    skipped_bytes : int
        Bytes that belong to no packet.
    """

    def __init__(self) -> None:
        self.refused: Counter[str] = Counter()
        self.skipped_bytes = 0
        self._buffer = bytearray()
        self._in_noise = False
        self._searched = 0

    @property
    def pending(self) -> int:
        """Bytes that wait for more of the same packet: always fewer than the longest has."""
        return len(self._buffer)

    @property
    def missing(self) -> int:
        """Bytes that a packet lacks that has begun, or its header as long as that is not whole."""
        if not self._buffer:
            return 0
        whole = HEADER_SIZE
        if len(self._buffer) >= HEADER_SIZE:
            whole = packet_size(self._buffer, 0)
        return max(whole - len(self._buffer), 0)

    def feed(self, data: bytes | bytearray | memoryview) -> list[Frame]:
        """Return the packets that these bytes complete, in order."""
        frames: list[Frame] = []
        for start in range(0, len(data), _PIECE):
            self._buffer += data[start : start + _PIECE]
            self._take(frames)
        return frames

    def reset(self) -> None:
        """Forget a packet that has begun, as after a line was lost; its bytes are skipped."""
        self._skip(len(self._buffer))
        self._buffer.clear()
        self._in_noise = False
        self._searched = 0

    def _take(self, frames: list[Frame]) -> None:
        """Move all that can be decided from the buffer to the frames, or skip it."""
        start = self._next_start(0)
        while (verdict := self._judge(start)) is not None:
            if verdict:
                self.refused[verdict] += 1
                self._in_noise = True
                self._skip(1)
                start = self._next_start(start + 1)
            else:
                end = start + packet_size(self._buffer, start)
                frames.append(_opened(bytes(self._buffer[start:end])))
                self._in_noise = False
                start = self._next_start(end)
        del self._buffer[:start]
        self._searched = max(0, self._searched - start)

    def _next_start(self, start: int) -> int:
        """Skip to where the next packet may begin."""
        found = _START.search(self._buffer, start)
        place = len(self._buffer) if found is None else found.start()
        self._skip(place - start)
        return place

    def _skip(self, size: int) -> None:
        """Count bytes that belong to no packet, and the stretch if it begins with them."""
        self.skipped_bytes += size
        if size and not self._in_noise:
            self.refused["noise"] += 1
            self._in_noise = True

    def _judge(self, start: int) -> str | None:
        """Return why there is no packet at this place, "" if there is one, None if it is open."""
        buffer = self._buffer
        if len(buffer) - start < HEADER_SIZE:
            return None
        if fault := header_fault(buffer, start):
            return fault
        end = start + packet_size(buffer, start)
        if next_header(buffer, max(start + 1, self._searched), end) is not None:
            return _SWALLOWED
        if len(buffer) < end:
            self._searched = max(start + 1, len(buffer) - HEADER_SIZE + 1)
            return None
        packet = bytes(buffer[start:end])
        return broken_body(packet) or (_SWALLOWED if _suspect(packet) else "")


def _suspect(packet: bytes) -> bool:
    """Say whether a reply ends in a damaged header; commands are too short to lose as much."""
    return packet[7] != HOST and reaches_into_next(packet)


def _opened(packet: bytes) -> Frame:
    """Return the frame of a packet that was found good."""
    source, destination, _, kind, sequence, node = packet[7:HEADER_SIZE]
    return Frame(kind, packet[HEADER_SIZE:-1], source, destination, sequence, node)
