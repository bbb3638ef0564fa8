# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The records of an mcap file, found again behind damage.

Format: https://mcap.dev/spec. A record is an opcode, a length of 8 bytes and its content; a chunk
is a record whose content holds more records, compressed and with a checksum.
"""

import re
import struct
from collections.abc import Iterator
from io import BytesIO
from mmap import ACCESS_READ, mmap
from typing import BinaryIO, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Chunk
from mcap.stream_reader import get_chunk_data_stream
from zstandard import ZstdError

from msss_graphslam.recordings.damage import Damage

__all__ = ["MAGIC", "READ_ERRORS", "Record", "inner_records", "load", "walk"]

MAGIC = b"\x89MCAP0\r\n"

READ_ERRORS = (
    McapError,
    ZstdError,
    RuntimeError,
    ValueError,
    MemoryError,
    OverflowError,
    struct.error,
)
"""Whatever the libraries raise on bytes that are not what they should be."""

_WANTED = {
    Opcode.HEADER,
    Opcode.SCHEMA,
    Opcode.CHANNEL,
    Opcode.MESSAGE,
    Opcode.CHUNK,
    Opcode.STATISTICS,
}
_PREFIX = struct.Struct("<BQ")
_FOOTER = struct.Struct("<BQQQI8s")
_CHUNK_START = re.compile(
    rb"\x06.{4}\x00{4}"  # opcode, length
    rb".{16}.{4}\x00{4}.{4}"  # times, unpacked size, checksum
    rb"(?:\x04\x00{3}zstd|\x03\x00{3}lz4|\x00{4})"  # compression
    rb".{4}\x00{4}",  # packed size
    re.DOTALL,
)
_CHUNK_FIXED = 8 + 8 + 8 + 4 + 4 + 8
_NAME_LENGTH_AT = _PREFIX.size + 28


class Record(NamedTuple):
    """Where a record's content lies [bytes]; its opcode and length lie before it."""

    opcode: int
    start: int
    end: int


def walk(stream: BinaryIO, size: int, damage: Damage) -> Iterator[tuple[Record, bytes]]:
    """Yield the outer records in order, each with its data: a chunk's content is unpacked.

    A chunk that does not unpack is counted as damage and left out. Behind a record that is none,
    the next chunk is looked for from the last place that can be trusted; what is jumped over is
    damage.
    """
    position = trusted = len(MAGIC)
    while position < size:
        record = _record_at(stream, position, size)
        if record is None:
            following = _resume(stream, trusted, position, size)
            damage.skipped_bytes += max(following - position, 0)
            position = trusted = following
            continue
        if record.opcode == Opcode.FOOTER:
            return
        position = record.end
        is_chunk = record.opcode == Opcode.CHUNK
        trusted = record.start if is_chunk else trusted
        if record.opcode not in _WANTED:
            continue
        try:
            data = load(stream, record)
        except READ_ERRORS:
            damage.broken_chunks += 1
            continue
        trusted = position if is_chunk else trusted
        yield record, data


def load(stream: BinaryIO, record: Record) -> bytes:
    """Return a chunk's records, or any other record's content; raises one of READ_ERRORS."""
    stream.seek(record.start)
    content = stream.read(record.end - record.start)
    if record.opcode != Opcode.CHUNK:
        return content
    chunk = Chunk.read(ReadDataStream(BytesIO(content)))
    unpacked, length = get_chunk_data_stream(chunk, validate_crc=True)
    return unpacked.read(length)


def inner_records(record: Record, data: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield opcode, start and end of the records that a record's data holds: a chunk's, or itself.

    Raises ValueError where they do not fit into the data.
    """
    if record.opcode != Opcode.CHUNK:
        yield record.opcode, 0, len(data)
        return
    position, size = 0, len(data)
    while position < size:
        opcode, length = _PREFIX.unpack_from(data, position)
        start = position + _PREFIX.size
        position = start + length
        if position > size:
            raise ValueError("a record is longer than its chunk")
        yield opcode, start, position


def _record_at(stream: BinaryIO, position: int, size: int) -> Record | None:
    stream.seek(position)
    prefix = stream.read(_PREFIX.size)
    if len(prefix) < _PREFIX.size:
        return None
    opcode, length = _PREFIX.unpack(prefix)
    start = position + _PREFIX.size
    record = Record(opcode, start, start + length)
    if opcode == 0 or record.end > size:
        return None
    if opcode == Opcode.FOOTER and record.end + len(MAGIC) < size:
        return None
    if opcode == Opcode.CHUNK and not _is_chunk(prefix + stream.read(_CHUNK_FIXED + 4)):
        return None
    return record


def _is_chunk(head: bytes) -> bool:
    """Whether the lengths at the head of a chunk fit each other."""
    found = _CHUNK_START.match(head)
    if found is None:
        return False
    _, length = _PREFIX.unpack_from(head)
    name_length = int.from_bytes(head[_NAME_LENGTH_AT : _NAME_LENGTH_AT + 4], "little")
    packed_at = _NAME_LENGTH_AT + 4 + name_length
    packed = int.from_bytes(head[packed_at : packed_at + 8], "little")
    return bool(length == _CHUNK_FIXED + name_length + packed)


def _resume(stream: BinaryIO, trusted: int, position: int, size: int) -> int:
    """Return where to read on: at the next chunk, at the summary, or at the end of the file."""
    with mmap(stream.fileno(), 0, access=ACCESS_READ) as view:
        for found in _CHUNK_START.finditer(view, trusted):
            head = found.group()
            end = found.start() + _PREFIX.size + int.from_bytes(head[1:9], "little")
            if _is_chunk(head) and end <= size:
                return found.start()
    stream.seek(max(size - _FOOTER.size, 0))
    tail = stream.read()
    if len(tail) == _FOOTER.size:
        opcode, length, summary, _, _, magic = _FOOTER.unpack(tail)
        if (opcode, length, magic) == (Opcode.FOOTER, 20, MAGIC) and position < summary < size:
            return int(summary)
    return size
