# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bags of the RobDos Micron driver: one ``micron_driver_ros/ScanLine`` a beam."""

from collections import Counter
from collections.abc import Iterator
from math import radians
from typing import Any

import numpy as np

from msss_graphslam.messages.fields import stamp_of
from msss_graphslam.recordings.conversion.bags import convert_beams, has_type
from msss_graphslam.recordings.conversion.foreign import (
    BeamEncoder,
    ForeignFormat,
    ForeignMessage,
    seanet_bearing,
)
from msss_graphslam.recordings.conversion.source import ForeignSource

__all__ = ["RobDos"]

_TYPE = "micron_driver_ros/msg/ScanLine"


class RobDos(ForeignFormat):
    """``angle`` is the head's own in degrees; a bin's ``distance`` is its far edge."""

    name = "robdos"
    description = "ROS 1 bag with micron_driver_ros/ScanLine (RobDos)"

    def recognises(self, source: ForeignSource) -> bool:
        """Whether the bag holds a ScanLine topic."""
        return has_type(source, _TYPE)

    def messages(
        self, source: ForeignSource, refusals: Counter[str], inverted: bool
    ) -> Iterator[ForeignMessage]:
        """Yield the beams."""
        encoder = BeamEncoder(inverted)

        def beam(line: Any) -> Any:
            codes = np.array([bin_.intensity for bin_ in line.bins], dtype=float)
            ranges = (np.arange(len(codes)) + 0.5) * line.bin_distance_step
            bearing = seanet_bearing(radians(line.angle))
            return encoder.message(stamp_of(line, "beam"), bearing, ranges, codes)

        return convert_beams(source, _TYPE, beam, refusals)
