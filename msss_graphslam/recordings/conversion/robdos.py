# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bags of the RobDos Micron driver: one ``micron_driver_ros/ScanLine`` a beam."""

from collections import Counter
from collections.abc import Iterator
from math import radians
from pathlib import Path
from typing import Any

import numpy as np

from msss_graphslam.messages.topics import SONAR_PING
from msss_graphslam.recordings.conversion.foreign import (
    BeamEncoder,
    ForeignFormat,
    ForeignMessage,
    seanet_bearing,
)
from msss_graphslam.recordings.conversion.ros1 import convert_type, has_type, stamp_of

__all__ = ["RobDos"]

_TYPE = "micron_driver_ros/msg/ScanLine"


class RobDos(ForeignFormat):
    """``angle`` is the head's own in degrees; a bin's ``distance`` is its far edge."""

    name = "robdos"
    description = "ROS 1 bag with micron_driver_ros/ScanLine (RobDos)"

    def recognises(self, path: Path) -> bool:
        """Whether the bag holds a ScanLine topic."""
        return has_type(path, _TYPE)

    def messages(self, path: Path, refusals: Counter[str]) -> Iterator[ForeignMessage]:
        """Yield the beams."""
        encoder = BeamEncoder()

        def beam(line: Any) -> Any:
            codes = np.array([bin_.intensity for bin_ in line.bins], dtype=float)
            ranges = (np.arange(len(codes)) + 0.5) * line.bin_distance_step
            bearing = seanet_bearing(radians(line.angle))
            return encoder.message(stamp_of(line), bearing, ranges, codes)

        return convert_type(path, _TYPE, SONAR_PING, beam, refusals)
