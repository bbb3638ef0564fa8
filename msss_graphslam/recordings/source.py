# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One topic of a recording, read as records."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

from msss_graphslam.messages import Refusal
from msss_graphslam.messages.order import StampOrder
from msss_graphslam.messages.topics import Topic
from msss_graphslam.recordings.direct import DirectReading
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.typestore import UndecodableError, decode

__all__ = ["AnySource", "Record", "Source", "message_of"]


class _Stamped(Protocol):
    @property
    def stamp_ns(self) -> int:
        """Acquisition time."""


Record = TypeVar("Record", bound=_Stamped)
Given = TypeVar("Given", covariant=True)


class AnySource(Protocol[Given]):
    """One topic of a recording; a message may give any number of records."""

    @property
    def topic(self) -> Topic:
        """The topic."""

    def records_of(self, raw: RawMessage, refusals: Counter[str]) -> Sequence[Given]:
        """Return the records that are complete with this message; count what is refused."""


@dataclass(slots=True)
class Source(Generic[Record]):
    """Turns the raw messages of a topic into records with increasing stamps.

    What ``direct`` does not read, ``decode`` makes of the whole message.
    """

    topic: Topic
    decode: Callable[[Any], Record]
    direct: DirectReading[Record] | None = None
    _order: StampOrder = field(default_factory=StampOrder)

    def records_of(self, raw: RawMessage, refusals: Counter[str]) -> Sequence[Record]:
        """Return the record, or none where the message is refused and counted."""
        try:
            record = self._read(raw)
            self._order.check(record.stamp_ns)
        except Refusal as refusal:
            refusals[refusal.reason] += 1
            return ()
        return (record,)

    def _read(self, raw: RawMessage) -> Record:
        if self.direct is None:
            return self.decode(message_of(raw, self.topic))
        record = self.direct.read(raw.data)
        if record is None:
            record = self.decode(message_of(raw, self.topic))
            self.direct.learn(raw.data)
        return record


def message_of(raw: RawMessage, topic: Topic) -> Any:
    """Return the message that was recorded of the topic, or raise Refusal."""
    try:
        return decode(raw.data, topic.type_name)
    except UndecodableError as error:
        raise Refusal(f"{topic.label}_undecodable") from error
