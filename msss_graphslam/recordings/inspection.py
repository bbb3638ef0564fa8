# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a recording holds, what it lacks, and what that costs."""

from collections import Counter, defaultdict
from collections.abc import Collection
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Beam, Inertial, Stamps
from msss_graphslam.errors import UserError
from msss_graphslam.messages import topics
from msss_graphslam.recordings.damage import Damage
from msss_graphslam.recordings.reader import Recording, open_recording
from msss_graphslam.recordings.recorded_topics import RecordedTopic
from msss_graphslam.recordings.sonar_settings import SonarObserver, SonarSettings

__all__ = ["Gap", "InspectionReport", "Lack", "TopicReport", "inspect", "lacks"]

# A silence longer than this many median periods is a gap: at least three messages are missing.
_GAP_PERIODS = 3.5
_LISTED_GAPS = 10

_COSTS = {
    topics.IMU: "heading comes from scan matching only; a turn's distortion by rotation and tilt"
    " is not corrected",
    topics.PRESSURE: "depth is unknown: z stays 0",
    topics.DVL: "speed is assumed (dead_reckoning.surge_speed); its error is corrected by scan"
    " matching only",
    topics.GROUND_TRUTH: "errors cannot be computed",
}


@dataclass(frozen=True, slots=True)
class Gap:
    """A silence: after how many seconds of the recording, and for how long [s]."""

    start: float
    duration: float


@dataclass(frozen=True, slots=True)
class TopicReport:
    """One topic: ``rate`` [Hz] from the median period, and the longest of its gaps."""

    name: str
    type_name: str
    count: int
    rate: float | None
    gap_count: int
    longest_gaps: tuple[Gap, ...]


@dataclass(frozen=True, slots=True)
class Lack:
    """An input that is missing, and what that costs."""

    name: str
    cost: str


@dataclass(frozen=True, slots=True)
class InspectionReport:
    """All that ``inspect`` finds; ``can_run`` says whether an estimator could work on it.

    ``problem`` is empty if so, else the reason in one line. ``sonar_topic`` is what the beams were
    read from: pings, or the bytes of the head's port where there are no pings.
    """

    path: str
    start_ns: int
    duration: float
    topics: tuple[TopicReport, ...]
    sonar: SonarSettings | None
    sonar_topic: str
    lacks: tuple[Lack, ...]
    refused: dict[str, int]
    damage: Damage
    problem: str

    @property
    def can_run(self) -> bool:
        """Whether an estimator could work on the recording."""
        return not self.problem

    def as_dict(self) -> dict[str, Any]:
        """Return the report as plain values, ready for JSON."""
        return {**asdict(self), "can_run": self.can_run}


def inspect(path: Path | str, configuration: Configuration | None = None) -> InspectionReport:
    """Read a recording through and report. Raises UserError where it cannot be opened."""
    recording = open_recording(path)
    stamps = _log_times(recording)
    refused: Counter[str] = Counter()
    observer = SonarObserver()
    inertial: set[str] = set()
    problem = sonar_topic = ""
    try:
        sonar_topic = recording.sonar_topic.absolute
        for measurement in recording.measurements(refused, configuration or Configuration()):
            if isinstance(measurement, Beam):
                observer.take(measurement)
            elif isinstance(measurement, Inertial):
                inertial |= _parts(measurement)
    except UserError as error:
        problem = str(error)
    settings = observer.settings()
    if settings is None and not problem:
        problem = f"{recording.path}: not one beam of the sonar can be used"
    return InspectionReport(
        path=str(recording.path),
        start_ns=recording.start_ns,
        duration=(recording.end_ns - recording.start_ns) * 1e-9,
        topics=tuple(
            _topic_report(topic, stamps[topic.name], recording.start_ns)
            for topic in recording.topics.values()
        ),
        sonar=settings,
        sonar_topic=sonar_topic,
        lacks=tuple(lacks(recording, inertial)),
        refused=dict(refused),
        damage=recording.damage,
        problem=problem,
    )


def _log_times(recording: Recording) -> dict[str, Stamps]:
    times: defaultdict[str, list[int]] = defaultdict(list)
    for message in recording.messages():
        times[message.channel.topic].append(message.log_ns)
    return {name: np.array(stamps, dtype=np.int64) for name, stamps in times.items()}


def _topic_report(topic: RecordedTopic, stamps: Stamps, start_ns: int) -> TopicReport:
    periods = np.diff(stamps) * 1e-9
    median = float(np.median(periods)) if periods.size else 0.0
    silent = np.flatnonzero(periods > _GAP_PERIODS * median) if median > 0.0 else np.array([], int)
    longest = silent[np.argsort(-periods[silent], kind="stable")[:_LISTED_GAPS]]
    return TopicReport(
        name=topic.name,
        type_name=topic.type_name,
        count=topic.count,
        rate=1.0 / median if median > 0.0 else None,
        gap_count=len(silent),
        longest_gaps=tuple(
            Gap((int(stamps[i]) - start_ns) * 1e-9, float(periods[i])) for i in longest
        ),
    )


def _parts(sample: Inertial) -> set[str]:
    given = {"orientation": sample.orientation, "angular_velocity": sample.angular_velocity}
    return {name for name, value in given.items() if value is not None}


def lacks(recording: Recording, inertial: Collection[str] = ()) -> list[Lack]:
    """Return what a recording does not have; ``inertial`` names the parts its IMU does give."""
    missing = [
        Lack(topic.absolute, cost) for topic, cost in _COSTS.items() if not recording.find(topic)
    ]
    if set(inertial) == {"angular_velocity"}:
        missing.append(
            Lack("imu orientation", "heading is integrated from rates; roll, pitch are 0")
        )
    if set(inertial) == {"orientation"}:
        missing.append(Lack("imu angular velocity", "heading follows the compass and its noise"))
    return missing
