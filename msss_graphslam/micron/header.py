# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What makes a packet's header and its sizes valid.

There is no checksum. What a packet says several times over has to agree: its length in digits
and in binary, the head's node, the count, and the length that its type prescribes.
"""

import re
import struct
from collections.abc import Container
from typing import Final

from msss_graphslam.micron.frame import HEAD, HEADER_SIZE, HOST, SINGLE, MessageType

__all__ = ["MAXIMUM_SIZE", "broken_body", "header_fault", "next_header", "packet_size"]

Buffer = bytes | bytearray

_UNCOUNTED = 6
_BEAM_OVERHEAD = 45
_MOST_BINS = 1500
MAXIMUM_SIZE: Final = _BEAM_OVERHEAD + _MOST_BINS
"""Bytes of the longest packet: a beam of the most bins that any driver asks a head for."""
_REPLY = (HEAD, HOST)
_COMMAND = (HOST, HEAD)
_SIZES: dict[int, tuple[tuple[int, int], Container[int]]] = {
    MessageType.HEAD_DATA: (_REPLY, range(_BEAM_OVERHEAD + 1, MAXIMUM_SIZE + 1)),
    MessageType.ALIVE: (_REPLY, {22}),
    MessageType.VERSION_DATA: (_REPLY, {25}),
    MessageType.USER_DATA: (_REPLY, {175, 264}),
    MessageType.FPGA_VERSION_DATA: (_REPLY, {28}),
    MessageType.CALIBRATION_DATA: (_REPLY, {80}),
    MessageType.HEAD_COMMAND: (_COMMAND, {15, 31, 66, 82}),
    MessageType.SEND_DATA: (_COMMAND, {18}),
    MessageType.SEND_VERSION: (_COMMAND, {14}),
    MessageType.SEND_USER_DATA: (_COMMAND, {14}),
    MessageType.REBOOT: (_COMMAND, {14}),
    MessageType.STOP_ALIVES: (_COMMAND, {14}),
}
_COMMAND_FORMS = {15: 0x0F, 31: 0x1E, 66: 0x01, 82: 0x1D}
_NUMBERS = struct.Struct("<HBBBBBB")
_SIZE_FIELD = struct.Struct("<H")
_HEADER_SHAPE = re.compile(rb"@[0-9A-F]{4}..(?:\x02\xff|\xff\x02)..\x80\x02", re.DOTALL)


def packet_size(buffer: Buffer, start: int) -> int:
    """Return the whole size that the header at ``start`` promises, 13 bytes being there."""
    return int(_SIZE_FIELD.unpack_from(buffer, start + 5)[0]) + _UNCOUNTED


def header_fault(buffer: Buffer, start: int) -> str:
    """Return what is wrong with the 13 bytes that begin with ``@`` and four digits, or ""."""
    length, source, destination, count, kind, sequence, node = _NUMBERS.unpack_from(
        buffer, start + 5
    )
    if int(buffer[start + 1 : start + 5], 16) != length:
        return "its two lengths differ"
    direction, sizes = _SIZES.get(kind, (None, ()))
    if direction is None:
        return "unknown type"
    if (source, destination) != direction or node != HEAD:
        return "unknown node"
    if sequence != SINGLE:
        return "part of a message"
    if length + _UNCOUNTED not in sizes:
        return "its length is not its type's"
    if count != (0 if kind == MessageType.HEAD_DATA else length - 5):
        return "wrong count"
    return ""


def next_header(buffer: Buffer, start: int, end: int) -> int | None:
    """Return where the first whole, valid header between two places begins, if there is one."""
    found = _HEADER_SHAPE.search(buffer, start, end)
    while found is not None and header_fault(buffer, found.start()):
        found = _HEADER_SHAPE.search(buffer, found.start() + 1, end)
    return None if found is None else found.start()


def broken_body(packet: bytes) -> str:
    """Return what is wrong with a packet of the promised size behind its header, or ""."""
    if packet[-1:] != b"\n":
        return "no line feed at its end"
    kind = packet[10]
    if kind == MessageType.HEAD_DATA and not _sizes_agree(packet):
        return "its inner sizes differ"
    if kind == MessageType.HEAD_COMMAND and packet[HEADER_SIZE] != _COMMAND_FORMS[len(packet)]:
        return "its length is not its form's"
    return ""


def _sizes_agree(packet: bytes) -> bool:
    """Say whether a beam's own two sizes fit that of the packet."""
    total = _SIZE_FIELD.unpack_from(packet, HEADER_SIZE)[0]
    data = _SIZE_FIELD.unpack_from(packet, _BEAM_OVERHEAD - 3)[0]
    return bool(total == len(packet) - 14 and data == len(packet) - _BEAM_OVERHEAD)
