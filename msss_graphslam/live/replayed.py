# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The recording that is replayed: looked at before anything starts, and for its truth.

As a program (``python3 -m msss_graphslam.live.replayed BAG PARAMETERS``) it tells a launch file.
"""

import json
import sys
from collections import Counter
from functools import cache
from pathlib import Path

import yaml

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.files import read_parameters
from msss_graphslam.core.types import Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.messages import topics
from msss_graphslam.recordings.reader import open_recording

__all__ = ["configured_for", "mounting_parameters", "needs_driver", "truth_of"]

_MOUNTING = ("mount_x", "mount_y", "mount_yaw")


def configured_for(bag: Path, configuration: Configuration) -> Configuration:
    """Return the configuration with the bag's mounting of the head, unless it has its own.

    Raises UserError where the bag cannot be read, or has no sonar.
    """
    recording = open_recording(bag)
    recording.measurements(Counter(), configuration)
    return recording.completed(configuration)


def mounting_parameters(bag: Path, parameters: Path) -> str:
    """Return, as a ROS parameter file, what the bag's mounting adds to a file of parameters.

    Empty where it adds nothing, and where one of the two cannot be used: the nodes say why.
    """
    names = [f"sonar.{name}" for name in _MOUNTING]
    try:
        given = {
            name: value for name, value in read_parameters(parameters).items() if name in names
        }
        before = Configuration().with_values(given)
        after = configured_for(bag, before)
    except UserError:
        return ""
    added = {
        name: getattr(after.sonar, name)
        for name in _MOUNTING
        if getattr(after.sonar, name) != getattr(before.sonar, name)
    }
    if not added:
        return ""
    return str(yaml.safe_dump({"/**": {"ros__parameters": {"sonar": added}}}))


def needs_driver(bag: Path) -> bool:
    """Whether the beams have to be decoded from the bytes of the head's port."""
    return open_recording(bag).sonar_topic == topics.SONAR_RAW


@cache
def truth_of(bag: Path) -> Trajectory | None:
    """Return the bag's ground truth, for the evaluation alone, or None where it has none."""
    return open_recording(bag).ground_truth()


def _main(bag: Path, parameters: Path) -> None:
    """Print what a launch file wants to know of a bag; nothing of one that cannot be used."""
    try:
        sonar = "raw" if needs_driver(bag) else "none"
    except UserError:
        return
    print(json.dumps({"sonar": sonar, "parameters": mounting_parameters(bag, parameters)}))


if __name__ == "__main__":
    _main(*map(Path, sys.argv[1:3]))
