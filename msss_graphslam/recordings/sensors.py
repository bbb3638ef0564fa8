# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a recording that an estimator works on, and how each is read."""

from functools import partial

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Beam, Measurement
from msss_graphslam.messages import decoding, topics
from msss_graphslam.messages.topics import Topic
from msss_graphslam.recordings.direct import (
    DirectBeams,
    DirectReading,
    depth_at,
    inertial_at,
    true_pose_at,
)
from msss_graphslam.recordings.raw_sonar import RawSonar
from msss_graphslam.recordings.source import AnySource, Source

__all__ = ["sensor_sources", "sonar_source", "truth_source"]


def sonar_source(topic: Topic, configuration: Configuration) -> AnySource[Beam]:
    """Return what reads beams from pings, or from the bytes of the head's port."""
    if topic == topics.SONAR_RAW:
        return RawSonar(configuration.micron)
    return Source(topic, decoding.beam, DirectReading(DirectBeams().take, alignment=4))


def sensor_sources(configuration: Configuration) -> list[AnySource[Measurement]]:
    """Return what reads the sensors beside the sonar."""
    sensors = configuration.sensors
    depth = partial(decoding.depth, sensors=sensors)
    return [
        Source(topics.IMU, decoding.inertial, DirectReading(inertial_at)),
        Source(topics.PRESSURE, depth, DirectReading(depth_at(sensors))),
        Source(topics.DVL, decoding.body_velocity),
    ]


def truth_source() -> Source[decoding.TruePose]:
    """Return what reads the true poses."""
    direct = DirectReading(true_pose_at, texts=2)
    return Source(topics.GROUND_TRUTH, decoding.true_pose, direct)
