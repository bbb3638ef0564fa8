# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bags of the RobDos Micron driver: one ``micron_driver_ros/ScanLine`` a beam."""

from collections.abc import Callable
from math import radians
from typing import Any

import numpy as np

from msss_graphslam.messages.fields import stamp_of
from msss_graphslam.recordings.conversion.bags import BeamBags
from msss_graphslam.recordings.conversion.foreign import BeamEncoder, seanet_bearing
from msss_graphslam.recordings.conversion.source import ForeignSource

__all__ = ["RobDos"]


class RobDos(BeamBags):
    """``angle`` is the head's own in degrees; a bin's ``distance`` is its far edge."""

    name = "robdos"
    description = "ROS 1 bag with micron_driver_ros/ScanLine (RobDos)"
    type_name = "micron_driver_ros/msg/ScanLine"

    def decoder(self, _: ForeignSource, encoder: BeamEncoder) -> Callable[[Any], Any]:
        """Return what encodes the beam of a message of this bag."""

        def beam(line: Any) -> Any:
            codes = np.array([bin_.intensity for bin_ in line.bins], dtype=float)
            ranges = (np.arange(len(codes)) + 0.5) * line.bin_distance_step
            bearing = seanet_bearing(radians(line.angle))
            return encoder.message(stamp_of(line, "beam"), bearing, ranges, codes)

        return beam
