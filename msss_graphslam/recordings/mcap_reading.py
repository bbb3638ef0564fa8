# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Every whole message of an mcap file, damaged or not."""

from bisect import bisect_left
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import ExitStack
from io import BytesIO
from operator import attrgetter
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
_MESSAGE = int(Opcode.MESSAGE)
_log_time = attrgetter("log_ns")


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
    channel_ids: frozenset[int]


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

    def channels_of(self, topics: Collection[str] | None) -> dict[int, Channel]:
        """Return the channels of the topics (all without ``topics``) by id."""
        return {
            number: channel
            for number, channel in self.channels.items()
            if topics is None or channel.topic in topics
        }

    def messages(
        self, block: _Block, stream: BinaryIO, channels: Mapping[int, Channel]
    ) -> list[RawMessage]:
        """Return the messages of one block in these channels, by id."""
        data = load(stream, block.record)
        heads = {
            number: (channel, self.schemas.get(channel.schema_id))
            for number, channel in channels.items()
        }
        found = []
        for opcode, start, end in inner_records(block.record, data):
            if opcode != _MESSAGE:
                continue
            number, sequence, log_ns, publish_ns = _MESSAGE_HEAD.unpack_from(data, start)
            if number in heads:
                body = data[start + _MESSAGE_HEAD.size : end]
                found.append(RawMessage(*heads[number], log_ns, publish_ns, sequence, body))
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
        for opcode, start, end in inner_records(outer, data):
            if opcode == _MESSAGE:
                channel_id, _, log_ns, _ = _MESSAGE_HEAD.unpack_from(data, start)
                counts[channel_id] += 1
                times.append(log_ns)
            else:
                self._define(opcode, data[start:end])
        if times:
            self.counts.update(counts)
            self.blocks.append(_Block(outer, min(times), max(times), frozenset(counts)))

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


def merge(
    contents: Iterable[McapContent],
    topics: Collection[str] | None = None,
    span_ns: range | None = None,
) -> Iterator[RawMessage]:
    """Yield the messages of several files in the order of their log times.

    Only those of the topics and of the span, where these are given. No more than the blocks that
    overlap in time are held in memory.
    """
    pending: list[RawMessage] = []
    with ExitStack() as files:
        wanted = [
            (block, content, stream, channels)
            for content in contents
            for stream in [files.enter_context(content.path.open("rb"))]
            for channels in [content.channels_of(topics)]
            for block in content.blocks
            if not block.channel_ids.isdisjoint(channels) and _overlaps(block, span_ns)
        ]
        for block, content, stream, channels in sorted(
            wanted, key=lambda entry: entry[0].first_ns
        ):
            ready = bisect_left(pending, block.first_ns, key=_log_time)
            yield from pending[:ready]
            found = content.messages(block, stream, channels)
            if span_ns is not None:
                found = [message for message in found if message.log_ns in span_ns]
            # A stable sort: messages of the same time stay in the order of the file.
            pending = sorted(pending[ready:] + found, key=_log_time)
        yield from pending


def _overlaps(block: _Block, span_ns: range | None) -> bool:
    return span_ns is None or (block.first_ns < span_ns.stop and block.last_ns >= span_ns.start)
