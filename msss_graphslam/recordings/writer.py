# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Writing bags: a rosbag2 folder, or a single mcap file where the path ends in ``.mcap``."""

import shutil
from collections.abc import Hashable
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import yaml

from msss_graphslam.errors import UserError
from msss_graphslam.recordings.files import require_absent
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.mcap_writing import McapFile
from msss_graphslam.recordings.metadata import TopicSummary, bag_metadata, parse_qos, qos_profile
from msss_graphslam.recordings.typestore import TYPES

__all__ = ["BagWriter"]


class BagWriter:
    """A bag being written; a context manager.

    The same messages give the same bytes. The bag appears under its name only when it is whole;
    an exception inside leaves nothing behind.

    Parameters
    ----------
    path
        ``NAME.mcap`` for a single file, which replaces an earlier one; else a rosbag2 folder,
        which must not exist yet (UserError).
    keeps_partial
        After an exception the unfinished file stays, for ``msss salvage``.
    """

    def __init__(self, path: Path | str, *, keeps_partial: bool = False) -> None:
        self.path = Path(path)
        self._keeps_partial = keeps_partial
        self._is_folder = self.path.suffix != ".mcap"
        self._partial = self.path.with_name(f".{self.path.name}.part")
        self._channels: dict[Hashable, tuple[int, TopicSummary]] = {}
        self._schemas: dict[tuple[str, str, bytes], int] = {}
        self._first_ns: int | None = None
        self._last_ns = 0

    def __enter__(self) -> Self:
        """Begin the bag; raises UserError where it cannot be written."""
        if self._is_folder:
            require_absent(self.path)
        try:
            self._file = McapFile(self._prepare(), self._keeps_partial).__enter__()
        except OSError as error:
            raise UserError(f"{self.path}: cannot be written ({error.strerror})") from error
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Finish the bag, or remove it after an error."""
        try:
            self._file.__exit__(kind, error, trace)
            if self._is_folder and kind is None:
                (self._partial / "metadata.yaml").write_text(self._metadata(), encoding="utf-8")
                self._partial.replace(self.path)
        finally:
            if self._is_folder and not self._keeps_partial:
                shutil.rmtree(self._partial, ignore_errors=True)

    @property
    def partial(self) -> Path:
        """Where the file grows until it is whole."""
        return self._file.partial

    def write(self, topic: str, message: Any, stamp_ns: int) -> None:
        """Append a message (of the types of ``typestore``) as received at ``stamp_ns``."""
        type_name = message.__msgtype__
        data = bytes(TYPES.serialize_cdr(message, type_name, little_endian=True))
        self.write_raw(topic, type_name, data, stamp_ns, stamp_ns)

    def write_raw(
        self, topic: str, type_name: str, data: bytes, log_ns: int, publish_ns: int
    ) -> None:
        """Append a serialised message (CDR) of a type of ``typestore``."""
        out = self._channels.get(topic) or self._register(topic, type_name)
        self._append(out, data, log_ns, publish_ns, 0)

    def flush(self) -> None:
        """Bring what was written so far into the file, where it outlives this process."""
        self._file.flush()

    def copy(self, raw: RawMessage) -> None:
        """Append a message of another bag as it is, with its definition and times."""
        key = (raw.channel.topic, raw.channel.message_encoding, raw.schema and raw.schema.name)
        out = self._channels.get(key) or self._register_copy(key, raw)
        self._append(out, raw.data, raw.log_ns, raw.publish_ns, raw.sequence)

    def _prepare(self) -> Path:
        """Make the folders, and return where the mcap file goes."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        if not self._is_folder:
            return self.path
        shutil.rmtree(self._partial, ignore_errors=True)
        self._partial.mkdir()
        return self._partial / f"{self.path.name}.mcap"

    def _append(
        self,
        out: tuple[int, TopicSummary],
        data: bytes,
        log_ns: int,
        publish_ns: int,
        sequence: int,
    ) -> None:
        channel, summary = out
        self._file.add_message(channel, data, log_ns, publish_ns, sequence)
        summary.count += 1
        self._first_ns = log_ns if self._first_ns is None else min(self._first_ns, log_ns)
        self._last_ns = max(self._last_ns, log_ns)

    def _register(self, topic: str, type_name: str) -> tuple[int, TopicSummary]:
        definition, _ = TYPES.generate_msgdef(type_name, ros_version=2)
        schema = self._schema(type_name, "ros2msg", definition.encode())
        summary = TopicSummary(
            topic, type_name, TYPES.hash_rihs01(type_name), [qos_profile(topic)]
        )
        metadata = {
            "offered_qos_profiles": yaml.safe_dump(summary.qos, sort_keys=False),
            "topic_type_hash": summary.type_hash,
        }
        channel = self._file.add_channel(topic, schema, "cdr", metadata)
        self._channels[topic] = channel, summary
        return channel, summary

    def _register_copy(self, key: Hashable, raw: RawMessage) -> tuple[int, TopicSummary]:
        known = raw.schema
        schema = self._schema(known.name, known.encoding, known.data) if known else 0
        metadata = raw.channel.metadata
        summary = TopicSummary(
            raw.channel.topic,
            known.name if known else "",
            metadata.get("topic_type_hash", ""),
            parse_qos(metadata.get("offered_qos_profiles", "")),
            encoding=raw.channel.message_encoding,
        )
        channel = self._file.add_channel(
            summary.name, schema, raw.channel.message_encoding, metadata
        )
        self._channels[key] = channel, summary
        return channel, summary

    def _schema(self, name: str, encoding: str, definition: bytes) -> int:
        key = (name, encoding, definition)
        if key not in self._schemas:
            self._schemas[key] = self._file.add_schema(name, encoding, definition)
        return self._schemas[key]

    def _metadata(self) -> str:
        summaries = [summary for _, summary in self._channels.values()]
        span_ns = range(self._first_ns or 0, self._last_ns)
        return bag_metadata(f"{self.path.name}.mcap", summaries, span_ns)
