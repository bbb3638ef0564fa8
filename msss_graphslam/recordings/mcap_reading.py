# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Every whole message of an mcap file, damaged or not."""

import heapq
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from io import BytesIO
from itertools import count
from pathlib import Path
from struct import Struct
from typing import BinaryIO, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Schema, Statistics

from msss_graphslam.recordings.damage import Damage
from msss_graphslam.recordings.mcap_records import (
    MAGIC,
    READ_ERRORS,
    Record,
    inner_records,
    load,
    walk,
)

__all__ = ["McapContent", "RawMessage", "merge"]

_MESSAGE_HEAD = Struct("<HIQQ")


class RawMessage(NamedTuple):
    """One message as its bytes lie in the file."""

    channel: Channel
    schema: Schema | None
    log_ns: int
    publish_ns: int
    sequence: int
    data: bytes


class _Block(NamedTuple):
    """A record with messages: a chunk, or a message outside of chunks."""

    record: Record
    first_ns: int
    last_ns: int


class McapContent:
    """What one file holds: found in one pass that checks everything, read in further ones.

    ``counts`` are the readable messages by channel id, ``blocks`` where they lie.
    """

    def __init__(self, path: Path, promised: int | None = None) -> None:
        self.path = path
        self.damage = Damage()
        self.channels: dict[int, Channel] = {}
        self.schemas: dict[int, Schema] = {}
        self.counts: Counter[int] = Counter()
        self.blocks: list[_Block] = []
        self._promised = promised
        self._has_header = False
        with path.open("rb") as stream:
            size = path.stat().st_size
            for record, data in walk(stream, size, self.damage):
                self._take(record, data)
            stream.seek(max(size - len(MAGIC), 0))
            self.damage.truncated = stream.read() != MAGIC
        self._settle()

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing of an mcap file in it."""
        return not (self._has_header or self.blocks or self.damage.broken_chunks)

    def messages(self, block: _Block, stream: BinaryIO) -> list[RawMessage]:
        """Return the messages of one block, without those of unknown channels."""
        data = load(stream, block.record)
        found = []
        for record in inner_records(block.record, data):
            if record.opcode != Opcode.MESSAGE:
                continue
            channel_id, sequence, log_ns, publish_ns = _MESSAGE_HEAD.unpack_from(
                data, record.start
            )
            channel = self.channels.get(channel_id)
            if channel is not None:
                body = data[record.start + _MESSAGE_HEAD.size : record.end]
                schema = self.schemas.get(channel.schema_id)
                found.append(RawMessage(channel, schema, log_ns, publish_ns, sequence, body))
        return found

    def _take(self, record: Record, data: bytes) -> None:
        try:
            if record.opcode == Opcode.HEADER:
                self._has_header = True
            elif record.opcode == Opcode.STATISTICS:
                self._take_statistics(data)
            else:
                self._take_block(record, data)
        except READ_ERRORS:
            self.damage.broken_chunks += 1

    def _take_block(self, outer: Record, data: bytes) -> None:
        counts: Counter[int] = Counter()
        times: list[int] = []
        for record in inner_records(outer, data):
            if record.opcode == Opcode.MESSAGE:
                channel_id, _, log_ns, _ = _MESSAGE_HEAD.unpack_from(data, record.start)
                counts[channel_id] += 1
                times.append(log_ns)
            else:
                self._define(record.opcode, data[record.start : record.end])
        if times:
            self.counts.update(counts)
            self.blocks.append(_Block(outer, min(times), max(times)))

    def _define(self, opcode: int, content: bytes) -> None:
        stream = ReadDataStream(BytesIO(content))
        if opcode == Opcode.CHANNEL:
            channel = Channel.read(stream)
            self.channels.setdefault(channel.id, channel)
        elif opcode == Opcode.SCHEMA:
            schema = Schema.read(stream)
            self.schemas.setdefault(schema.id, schema)

    def _take_statistics(self, content: bytes) -> None:
        statistics = Statistics.read(ReadDataStream(BytesIO(content)))
        if statistics.message_count == sum(statistics.channel_message_counts.values()):
            self._promised = statistics.message_count

    def _settle(self) -> None:
        """Compare what was read with what was promised."""
        for unknown in set(self.counts) - set(self.channels):
            del self.counts[unknown]
        if self._promised is not None:
            self.damage.lost_messages = max(self._promised - self.counts.total(), 0)
        elif self.damage:
            self.damage.lost_messages = None


def merge(contents: Iterable[McapContent]) -> Iterator[RawMessage]:
    """Yield the messages of several files in the order of their log times.

    No more than the blocks that overlap in time are held in memory.
    """
    pending: list[tuple[int, int, RawMessage]] = []
    order = count()
    with ExitStack() as files:
        blocks = [
            (block, content, stream)
            for content in contents
            for stream in [files.enter_context(content.path.open("rb"))]
            for block in content.blocks
        ]
        for block, content, stream in sorted(blocks, key=lambda entry: entry[0].first_ns):
            while pending and pending[0][0] < block.first_ns:
                yield heapq.heappop(pending)[2]
            for message in content.messages(block, stream):
                heapq.heappush(pending, (message.log_ns, next(order), message))
        while pending:
            yield heapq.heappop(pending)[2]
