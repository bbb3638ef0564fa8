# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The file that Tritech's Seanet program records: ``.V4LOG``.

All numbers are little-endian:

====== ========== ======================================================================
offset type       content
====== ========== ======================================================================
0      text       ``SeaNetV4 Log File V1``
0x28   u32        offset of the first ping's record; before it, the program's settings
0x2C   u32        number of pings
0x34   u32        offset of the index: that of each ping's record, u32; ends the records
====== ========== ======================================================================

A record is its own size (u16), the time in days since 1899-12-30 (f64), and a packet from the
sender to the payload, without ``@``, lengths, count and line feed.
"""

import struct
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from math import isfinite
from pathlib import Path
from typing import NamedTuple

from msss_graphslam.errors import UserError
from msss_graphslam.micron.frame import Frame, MessageType

__all__ = ["LogRecord", "is_v4log", "read_v4log"]

_MAGIC = b"SeaNetV4 Log File V1"
_TABLE, _TABLE_OFFSET = struct.Struct("<IIII"), 0x28
_RECORD = struct.Struct("<HdBBBBB")
_EPOCH_DAYS, _NANOSECONDS_A_DAY = 25569.0, 86_400_000_000_000.0
_END_OF_TIME_NS = 2**31 * 1_000_000_000


class LogRecord(NamedTuple):
    """One packet and when it was recorded [ns]; the clock is that of the place."""

    recorded_ns: int
    frame: Frame


def is_v4log(path: Path) -> bool:
    """Whether the file begins as a V4LOG does."""
    if not path.is_file():
        return False
    with path.open("rb") as stream:
        return stream.read(len(_MAGIC)) == _MAGIC


def read_v4log(path: Path, refusals: Counter[str]) -> Iterator[LogRecord]:
    """Yield the packets; records that cannot be read are counted.

    A damaged record is left out. Without the index, which a file that is cut off lacks, what
    follows one is lost too: the pings that the file promises and does not hold are counted.
    Raises UserError where the file does not even reach its first record.
    """
    data = path.read_bytes()
    layout = _layout(path, data)
    position, unreadable, missing = layout.first, 0, layout.pings
    while position < layout.end:
        size, record = _record(data, position, layout.end)
        if not size:
            unreadable += 1
        elif record is None:
            refusals["record_stamp_invalid"] += 1
            missing -= 1
        else:
            missing -= record.frame.type == MessageType.HEAD_DATA
            yield record
        position = position + size if size else layout.next_start(position)
    if max(missing, unreadable) > 0:
        refusals["record_unreadable"] += max(missing, unreadable)


class _Layout(NamedTuple):
    """Where the records lie; ``starts`` is empty where the file has no sound index."""

    first: int
    end: int
    pings: int
    starts: tuple[int, ...]

    def next_start(self, position: int) -> int:
        """Return where the next ping's record begins, or the end of all."""
        following = bisect_right(self.starts, position)
        return self.starts[following] if following < len(self.starts) else self.end


def _layout(path: Path, data: bytes) -> _Layout:
    if len(data) < _TABLE_OFFSET + _TABLE.size:
        raise UserError(f"{path}: the V4LOG is cut off within its first {len(data)} bytes")
    first, pings, _, index = _TABLE.unpack_from(data, _TABLE_OFFSET)
    if not _TABLE_OFFSET + _TABLE.size <= first < len(data):
        raise UserError(f"{path}: the V4LOG is cut off before its first record, or damaged")
    end = index if first < index < len(data) else len(data)
    pings = min(pings, (max(index, len(data)) - first) // _RECORD.size)
    return _Layout(first, end, pings, _starts(data, first, pings, index))


def _starts(data: bytes, first: int, pings: int, index: int) -> tuple[int, ...]:
    size = 4 * pings
    if not pings or not first < index <= len(data) - size:
        return ()
    starts = struct.unpack_from(f"<{pings}I", data, index)
    rising = all(a < b for a, b in pairwise((*starts, index)))
    return starts if rising and starts[0] == first else ()


def _record(data: bytes, position: int, end: int) -> tuple[int, LogRecord | None]:
    """Return the record's size, 0 where there is no sound one, and what is in it."""
    if end - position < _RECORD.size:
        return 0, None
    size, days, *envelope = _RECORD.unpack_from(data, position)
    source, destination, message_type, sequence, node = envelope
    payload = data[position + _RECORD.size : position + size]
    if not _RECORD.size <= size <= end - position or source != node:
        return 0, None
    if message_type == MessageType.HEAD_DATA and payload[:2] != len(payload).to_bytes(2, "little"):
        return 0, None
    since_epoch = (days - _EPOCH_DAYS) * _NANOSECONDS_A_DAY
    if not (isfinite(since_epoch) and 0.0 <= since_epoch < _END_OF_TIME_NS):
        return size, None
    frame = Frame(message_type, payload, source, destination, sequence, node)
    return size, LogRecord(round(since_epoch), frame)
