# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bags of McGill's tritech_micron driver: one ``sensor_msgs/PointCloud`` a beam."""

from collections.abc import Callable
from math import atan2
from typing import Any

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.messages import Refusal
from msss_graphslam.messages.fields import stamp_of
from msss_graphslam.recordings.conversion.bags import BeamBags
from msss_graphslam.recordings.conversion.foreign import BeamEncoder, seanet_bearing
from msss_graphslam.recordings.conversion.source import ForeignSource

__all__ = ["McGill"]

_CHANNEL = "intensity"
# Micrometres: below that, 32-bit coordinates only add noise that differs from beam to beam.
_LENGTH_DIGITS = 6


class McGill(BeamBags):
    """The points lie on the ray of the head's own angle, each at its bin's far edge.

    The angle is taken from the last point, which equals the driver's heading topic but belongs to
    the beam for certain. The driver takes a bin for range / bins, which is up to 1 % off the
    head's sampling interval; the bag does not hold that one, so the driver's figure stays.
    """

    name = "mcgill"
    description = "ROS 1 bag with sensor_msgs/PointCloud beams (McGill's tritech_micron)"
    type_name = "sensor_msgs/msg/PointCloud"

    def decoder(self, _: ForeignSource, encoder: BeamEncoder) -> Callable[[Any], Any]:
        """Return what encodes the beam of a message of this bag."""

        def beam(cloud: Any) -> Any:
            last = cloud.points[-1] if cloud.points else None
            if last is None:
                raise Refusal("beam_without_bins")
            bearing = seanet_bearing(atan2(last.y, last.x))
            return encoder.message(
                stamp_of(cloud, "beam"), bearing, _bin_centres(cloud), _codes(cloud)
            )

        return beam


def _bin_centres(cloud: Any) -> Array:
    edges = np.hypot([point.x for point in cloud.points], [point.y for point in cloud.points])
    count = np.arange(len(edges))
    length = round(float(edges[-1]) / len(edges), _LENGTH_DIGITS)
    regular = np.isfinite(length) and np.allclose(edges, (count + 1.0) * length, atol=0.1 * length)
    if not regular:
        raise Refusal("beam_bins_not_regular")
    return np.asarray((count + 0.5) * length, dtype=float)


def _codes(cloud: Any) -> Array:
    for channel in cloud.channels:
        if channel.name == _CHANNEL:
            return np.asarray(channel.values, dtype=float)
    raise Refusal("beam_without_intensities")
