# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One topic of a recording, read as records."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

from msss_graphslam.messages import Refusal
from msss_graphslam.messages.order import StampOrder
from msss_graphslam.messages.topics import Topic
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.typestore import UndecodableError, decode

__all__ = ["Record", "Source"]


class _Stamped(Protocol):
    @property
    def stamp_ns(self) -> int:
        """Acquisition time."""


Record = TypeVar("Record", bound=_Stamped)


@dataclass(slots=True)
class Source(Generic[Record]):
    """Turns the raw messages of a topic into records with increasing stamps."""

    topic: Topic
    decode: Callable[[Any], Record]
    _order: StampOrder = field(default_factory=StampOrder)

    def record_of(self, raw: RawMessage, refusals: Counter[str]) -> Record | None:
        """Return the record, or None where the message is refused and counted."""
        try:
            record = self.decode(self._message(raw))
            self._order.check(record.stamp_ns)
        except Refusal as refusal:
            refusals[refusal.reason] += 1
            return None
        return record

    def _message(self, raw: RawMessage) -> Any:
        try:
            return decode(raw.data, self.topic.type_name)
        except UndecodableError as error:
            raise Refusal(f"{self.topic.label}_undecodable") from error
