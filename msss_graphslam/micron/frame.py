# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The envelope that all packets of a Tritech SeaNet head share.

Source: Tritech's serial protocol as public drivers use it, checked on recordings of real heads.
All numbers are little-endian:

====== ===== ==========================================================
offset bytes content
====== ===== ==========================================================
0      1     ``@``
1      4     length in upper-case hexadecimal digits: all bytes but six
5      2     the same length in binary
7      1     sender: 0xFF the host, 0x02 the head
8      1     receiver
9      1     bytes that follow, without the line feed; 0 in mtHeadData
10     1     message type
11     1     sequence: bit 7 the last packet, the others its number
12     1     node of the head
13     n     payload
13 + n 1     line feed
====== ===== ==========================================================
"""

import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import Self

__all__ = ["HEAD", "HEADER_SIZE", "HOST", "OVERHEAD", "SINGLE", "Frame", "MessageType"]

HOST = 0xFF
HEAD = 0x02
SINGLE = 0x80
"""Sequence of a message that is one packet: number 0 and the last."""
HEADER_SIZE = 13
"""Bytes before the payload."""
OVERHEAD = 14
"""Bytes of a packet beside its payload."""
_UNCOUNTED = 6
_HEADER = struct.Struct("<HBBBBBB")


class MessageType(IntEnum):
    """What a packet is: the types that a Micron DST sends or takes."""

    VERSION_DATA = 1
    HEAD_DATA = 2
    ALIVE = 4
    USER_DATA = 6
    REBOOT = 16
    HEAD_COMMAND = 19
    SEND_VERSION = 23
    SEND_USER_DATA = 24
    SEND_DATA = 25
    FPGA_VERSION_DATA = 57
    CALIBRATION_DATA = 63
    STOP_ALIVES = 66


@dataclass(frozen=True, slots=True)
class Frame:
    """One packet, its envelope opened.

    ``type`` is a plain number, as a head may send what :class:`MessageType` does not know.
    ``count`` is what the packet says of its own size; None stands for what the protocol asks.
    """

    type: int
    payload: bytes
    source: int
    destination: int
    sequence: int = SINGLE
    node: int = HEAD
    count: int | None = None

    @classmethod
    def from_head(cls, message_type: int, payload: bytes) -> Self:
        """Return a reply of the head."""
        return cls(message_type, payload, source=HEAD, destination=HOST)

    @classmethod
    def to_head(cls, message_type: int, payload: bytes = b"") -> Self:
        """Return a command of the host."""
        return cls(message_type, payload, source=HOST, destination=HEAD)

    @property
    def size(self) -> int:
        """Bytes of the whole packet."""
        return len(self.payload) + OVERHEAD

    def encode(self) -> bytes:
        """Return the whole packet, from ``@`` to line feed.

        Raises
        ------
        ValueError
            If the payload is too long for its length or count, or a number is no byte.
        """
        length = self.size - _UNCOUNTED
        count = self._expected_count() if self.count is None else self.count
        try:
            header = _HEADER.pack(
                length, self.source, self.destination, count, self.type, self.sequence, self.node
            )
        except struct.error as error:
            message = f"no packet can carry {self.size} bytes of type {self.type}: {error}"
            raise ValueError(message) from error
        return b"@%04X" % length + header + self.payload + b"\n"

    def _expected_count(self) -> int:
        """Return the bytes after the count, line feed aside: type, sequence, node, payload."""
        return 0 if self.type == MessageType.HEAD_DATA else len(self.payload) + 3
