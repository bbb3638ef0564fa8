# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What topics a recording has, and how much of each."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from msss_graphslam.recordings.mcap_reading import McapContent

__all__ = ["RecordedTopic", "recorded_topics"]


@dataclass(frozen=True, slots=True)
class RecordedTopic:
    """One topic of a recording."""

    name: str
    type_name: str
    count: int


def recorded_topics(contents: Iterable[McapContent]) -> dict[str, RecordedTopic]:
    """Return the topics with at least one readable message, by name."""
    counts: Counter[str] = Counter()
    types: dict[str, str] = {}
    for content in contents:
        for identifier, count in content.counts.items():
            channel = content.channels[identifier]
            schema = content.schemas.get(channel.schema_id)
            counts[channel.topic] += count
            types[channel.topic] = schema.name if schema else "unknown"
    return {name: RecordedTopic(name, types[name], counts[name]) for name in sorted(counts)}
