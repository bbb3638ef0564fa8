# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Reading recordings: whole messages in log order, decoded into measurements."""

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Beam, Measurement, Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.messages import topics
from msss_graphslam.messages.topics import Topic
from msss_graphslam.recordings.damage import Damage
from msss_graphslam.recordings.files import mcap_files
from msss_graphslam.recordings.mcap_reading import McapContent, RawMessage, merge
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.recorded_topics import RecordedTopic, recorded_topics
from msss_graphslam.recordings.sensors import sensor_sources, sonar_source, truth_source
from msss_graphslam.recordings.source import AnySource, Given
from msss_graphslam.recordings.typestore import UndecodableError, decode

_LOG_DELAY_NS = 2_000_000_000
_SETTLING_NS = 60_000_000_000

__all__ = ["Recording", "open_recording"]


def open_recording(path: Path | str) -> "Recording":
    """Open an mcap file or a rosbag2 folder; everything readable of it is found.

    Raises UserError where there is no such thing, or nothing in it.
    """
    path = Path(path)
    try:
        contents = [McapContent(file, promised) for file, promised in mcap_files(path).items()]
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from error
    if all(content.is_empty for content in contents):
        raise UserError(f"{path}: not an mcap recording, or nothing of it is readable")
    recording = Recording(path, contents)
    if not recording.topics:
        raise UserError(f"{path}: the recording holds no message ({recording.damage})")
    return recording


class Recording:
    """A recording, open for reading.

    Attributes
    ----------
    path
        Where it lies.
    topics
        The topics with at least one readable message, by name.
    start_ns, end_ns
        First and last log time.
    damage
        What could not be read.
    """

    def __init__(self, path: Path, contents: list[McapContent]) -> None:
        self.path = path
        self.topics = recorded_topics(contents)
        self.damage = Damage.total(content.damage for content in contents)
        blocks = [block for content in contents for block in content.blocks]
        self.start_ns = min((block.first_ns for block in blocks), default=0)
        self.end_ns = max((block.last_ns for block in blocks), default=0)
        self._contents = contents

    def messages(
        self, names: Collection[str] | None = None, span_ns: range | None = None
    ) -> Iterator[RawMessage]:
        """Return the messages in the order of log times: of all topics and times, or of these."""
        return merge(self._contents, names, span_ns)

    def find(self, topic: Topic) -> RecordedTopic | None:
        """Return the recorded topic of that name, under any namespace.

        The plain name goes before one in a namespace; several namespaces raise UserError.
        """
        fitting = [name for name in self.topics if topics.find(name) == topic]
        if topic.absolute in fitting:
            return self.topics[topic.absolute]
        if len(fitting) > 1:
            raise UserError(
                f"{self.path}: several topics could be {topic.name}: {', '.join(fitting)};"
                " keep one of them in the bag"
            )
        return self.topics[fitting[0]] if fitting else None

    def measurements(
        self, refusals: Counter[str], configuration: Configuration
    ) -> Iterator[Measurement]:
        """Yield what the sensors measured, in the order of log times.

        What cannot be used is counted in ``refusals`` by reason. Raises UserError without a sonar.
        """
        self._require_sonar()
        sources = [sonar_source(self.sonar_topic, configuration), *sensor_sources(configuration)]
        return self._records(sources, refusals)

    def ground_truth(self, refusals: Counter[str] | None = None) -> Trajectory | None:
        """Return the true trajectory for evaluation, or None where there is none."""
        refusals = Counter() if refusals is None else refusals
        poses = list(self._records([truth_source()], refusals))
        if not poses:
            return None
        stamps = np.array([pose.stamp_ns for pose in poses], dtype=np.int64)
        return Trajectory(stamps, np.array([pose.pose for pose in poses]))

    def beams(
        self, start_ns: int, end_ns: int, configuration: Configuration | None = None
    ) -> Iterator[Beam]:
        """Yield the beams logged between two times or shortly after, without counting refusals.

        Raw bytes are read from a minute before: how long replies take is known from others.
        """
        source = sonar_source(self.sonar_topic, configuration or Configuration())
        recorded = self.find(source.topic)
        first_ns = start_ns - (_SETTLING_NS if source.topic == topics.SONAR_RAW else 0)
        span_ns = range(first_ns, end_ns + _LOG_DELAY_NS + 1)
        for raw in self.messages([recorded.name] if recorded else [], span_ns):
            yield from source.records_of(raw, Counter())

    def mounting(self) -> Mounting | None:
        """Return where the head sits, if the bag's static transforms say so."""
        recorded = self.find(topics.STATIC_TRANSFORMS)
        if recorded is None or recorded.type_name != topics.STATIC_TRANSFORMS.type_name:
            return None
        for raw in self.messages([recorded.name]):
            try:
                message = decode(raw.data, recorded.type_name)
            except UndecodableError:
                continue
            found = Mounting.from_transforms(message)
            if found is not None:
                return found
        return None

    def completed(self, configuration: Configuration) -> Configuration:
        """Return the configuration with the bag's mounting of the head, unless it has its own."""
        mounting = self.mounting()
        return configuration if mounting is None else mounting.completes(configuration)

    @property
    def sonar_topic(self) -> Topic:
        """Where the beams are: in pings, or only in the bytes of the head's port."""
        has_raw_only = not self.find(topics.SONAR_PING) and self.find(topics.SONAR_RAW)
        return topics.SONAR_RAW if has_raw_only else topics.SONAR_PING

    def _records(
        self, sources: Sequence[AnySource[Given]], refusals: Counter[str]
    ) -> Iterator[Given]:
        by_name: dict[str, AnySource[Given]] = {}
        for source in sources:
            recorded = self.find(source.topic)
            if recorded is None:
                continue
            if recorded.type_name == source.topic.type_name:
                by_name[recorded.name] = source
            else:
                refusals[f"{source.topic.label}_wrong_type"] += recorded.count
        for raw in self.messages(by_name):
            yield from by_name[raw.channel.topic].records_of(raw, refusals)

    def _require_sonar(self) -> None:
        topic = self.sonar_topic
        recorded = self.find(topic)
        if recorded is None:
            raise UserError(
                f"{self.path}: no topic {topics.SONAR_PING.absolute} or"
                f" {topics.SONAR_RAW.absolute}, only {', '.join(sorted(self.topics))}; rename the"
                " sonar's topic, or make the bag by `msss convert`"
            )
        if recorded.type_name != topic.type_name:
            content = "one beam" if topic == topics.SONAR_PING else "the port's bytes"
            raise UserError(
                f"{self.path}: {recorded.name} is of type {recorded.type_name}, must be"
                f" {topic.type_name} with {content} a message; make the bag by `msss convert`"
            )
