# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""An mcap file with checksums that appears under its name only when it is whole."""

from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from mcap.writer import CompressionType, Writer

__all__ = ["McapFile"]

# Deviation from rosbags' writer: that one leaves the chunks' checksums out, and a flipped byte
# would pass for data. A chunk is the unit that damage takes away, hence small.
_CHUNK_BYTES = 256 * 1024


class McapFile:
    """A file of serialised messages being written: zstd chunks with CRC, profile ``ros2``.

    It is a context manager; an exception inside leaves nothing behind, or with ``keeps_partial``
    the unfinished file ``partial``.
    """

    def __init__(self, path: Path, keeps_partial: bool = False) -> None:
        self.path = path
        self._keeps_partial = keeps_partial
        self.partial = path.with_name(f".{path.name}.part")

    def __enter__(self) -> Self:
        """Begin the file."""
        self._stream: BinaryIO = self.partial.open("wb")
        self._writer = Writer(
            self._stream, chunk_size=_CHUNK_BYTES, compression=CompressionType.ZSTD
        )
        self._writer.start(profile="ros2", library="msss_graphslam")
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Finish the file and give it its name, or remove it after an error."""
        try:
            with self._stream:
                if kind is None:
                    self._writer.finish()  # type: ignore[no-untyped-call]
            if kind is None:
                self.partial.replace(self.path)
        finally:
            if not self._keeps_partial:
                self.partial.unlink(missing_ok=True)

    def flush(self) -> None:
        """End the chunk, and hand over to the operating system."""
        self._writer.flush()  # type: ignore[no-untyped-call]

    def add_schema(self, name: str, encoding: str, definition: bytes) -> int:
        """Register a message definition and return its id."""
        return int(self._writer.register_schema(name, encoding, definition))

    def add_channel(
        self, topic: str, schema_id: int, encoding: str, metadata: dict[str, str]
    ) -> int:
        """Register a topic and return its channel's id."""
        return int(self._writer.register_channel(topic, encoding, schema_id, metadata))

    def add_message(
        self, channel: int, data: bytes, log_ns: int, publish_ns: int, sequence: int = 0
    ) -> None:
        """Append one serialised message."""
        self._writer.add_message(channel, log_ns, data, publish_ns, sequence)
