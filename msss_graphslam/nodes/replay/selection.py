# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which topics of a recording are replayed. No ROS."""

from collections.abc import Callable, Sequence

from msss_graphslam.errors import UserError
from msss_graphslam.messages import topics
from msss_graphslam.messages.topics import Topic
from msss_graphslam.recordings.reader import Recording
from msss_graphslam.recordings.recorded_topics import RecordedTopic

__all__ = ["relative_name", "select"]


def relative_name(name: str) -> str:
    """Return the name under which a bag's topic is published: without the bag's namespace."""
    known = topics.find(name)
    return known.name if known else name.lstrip("/")


def select(
    recording: Recording, wanted: Sequence[str], available: Callable[[str], bool]
) -> tuple[list[RecordedTopic], list[RecordedTopic]]:
    """Return the topics to replay, and those left out because their type is not installed.

    ``wanted`` are full names or names of the package's topics; without any the inputs are meant.
    Raises UserError where the bag has none of them, or not all that were named.
    """
    found = [_named(recording, name) for name in wanted] if wanted else _inputs(recording)
    usable = [topic for topic in found if available(topic.type_name)]
    if not usable:
        raise UserError(
            f"{recording.path}: nothing to replay, the bag has only"
            f" {', '.join(sorted(recording.topics))}; name some by the parameter topics, or make"
            " a bag by `msss convert`"
        )
    return usable, [topic for topic in found if topic not in usable]


def _named(recording: Recording, name: str) -> RecordedTopic:
    full = recording.topics.get(name) or recording.topics.get(f"/{name}")
    known = next((t for t in topics.INPUTS + topics.OUTPUTS if t.name == name.lstrip("/")), None)
    found = full or (recording.find(known) if known else None)
    if found is None:
        raise UserError(
            f"{recording.path}: no topic {name}, only {', '.join(sorted(recording.topics))}"
        )
    return found


def _inputs(recording: Recording) -> list[RecordedTopic]:
    found: dict[Topic, RecordedTopic | None] = {
        topic: recording.find(topic) for topic in topics.INPUTS
    }
    if found[topics.SONAR_PING] is not None:
        found[topics.SONAR_RAW] = None
    return [recorded for recorded in found.values() if recorded is not None]
