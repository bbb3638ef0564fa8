# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The recording that is replayed: looked at before anything starts, and for its truth."""

from collections import Counter
from functools import cache
from pathlib import Path

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Trajectory
from msss_graphslam.messages import topics
from msss_graphslam.recordings.reader import open_recording

__all__ = ["configured_for", "needs_driver", "truth_of"]


def configured_for(bag: Path, configuration: Configuration) -> Configuration:
    """Return the configuration with the bag's mounting of the head, unless it has its own.

    Raises UserError where the bag cannot be read, or has no sonar.
    """
    recording = open_recording(bag)
    recording.measurements(Counter(), configuration)
    return recording.completed(configuration)


def needs_driver(bag: Path) -> bool:
    """Whether the beams have to be decoded from the bytes of the head's port."""
    return open_recording(bag).sonar_topic == topics.SONAR_RAW


@cache
def truth_of(bag: Path) -> Trajectory | None:
    """Return the bag's ground truth, for the evaluation alone, or None where it has none."""
    return open_recording(bag).ground_truth()
