# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The bag of the Girona underwater caves data set.

A. Mallios, E. Vidal, R. Campos and M. Carreras, Underwater caves sonar data set, International
Journal of Robotics Research 36(12), 2017. The vehicle has x forward, y to starboard, z down, and
its origin in the DVL. ``/odometry`` is the authors' own dead reckoning, no truth, and stays out,
as do the second IMU and the profiler, which looks up and down.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from rosbags.interfaces import Connection

from msss_graphslam.config.groups import Sensors
from msss_graphslam.core.types import Array, BodyVelocity
from msss_graphslam.messages import Refusal, decoding, encoding
from msss_graphslam.messages.fields import stamp_of
from msss_graphslam.messages.frames import BASE_LINK
from msss_graphslam.messages.hydrostatics import pressure_at
from msss_graphslam.messages.topics import DVL, IMU, PRESSURE, SONAR_PING, Topic
from msss_graphslam.recordings.conversion.bags import Conversion, convert_messages
from msss_graphslam.recordings.conversion.foreign import (
    BeamEncoder,
    ForeignFormat,
    ForeignMessage,
    seanet_bearing,
)
from msss_graphslam.recordings.conversion.girona_imu import ADIS, XSENS, GironaImu
from msss_graphslam.recordings.conversion.source import ForeignSource
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.typestore import make

__all__ = ["Girona"]

_MICRON = "/sonar_micron_ros"
_IMUS = {"/imu_adis": ADIS, "/imu_xsens_mti": XSENS}  # the better one first
_VALID = 1
_DVL_DEVIATION = 0.02  # m/s of a component, assumed: the recording states none
# Of a bin: how far a range may lie off the one of equal bins.
_IRREGULARITY = 0.1


class Girona(ForeignFormat):
    """A ``LaserScan`` a beam, the angle the head's own: clockwise from above, 180 deg ahead."""

    name = "girona"
    description = "ROS 1 bag of the Girona underwater caves data set"
    mounting = Mounting(mount_x=0.1)

    def recognises(self, source: ForeignSource) -> bool:
        """Whether the bag holds the Micron's topic under its name there."""
        return any(connection.topic == _MICRON for connection in source.connections)

    def messages(
        self, source: ForeignSource, refusals: Counter[str], inverted: bool
    ) -> Iterator[ForeignMessage]:
        """Yield beams, the better IMU's samples, depths and velocities."""
        recorded = {connection.topic: connection for connection in source.connections}
        encoder = BeamEncoder(inverted)
        sources: dict[str, tuple[Topic, Callable[[Any], Any]]] = {
            _MICRON: (SONAR_PING, lambda message: _beam(message, encoder)),
            "/depth_sensor": (PRESSURE, _pressure),
            "/dvl_linkquest": (DVL, _velocity),
        }
        imu = next((topic for topic in _IMUS if topic in recorded), None)
        if imu is not None:
            sources[imu] = IMU, GironaImu(_IMUS[imu]).message
        return convert_messages(source, _conversions(recorded, sources), refusals)


def _conversions(
    recorded: dict[str, Connection], sources: dict[str, tuple[Topic, Callable[[Any], Any]]]
) -> list[Conversion]:
    return [
        Conversion(recorded[topic], *source)
        for topic, source in sources.items()
        if topic in recorded
    ]


def _beam(scan: Any, encoder: BeamEncoder) -> Any:
    codes = np.asarray(scan.intensities, dtype=float)
    ranges = np.asarray(scan.ranges, dtype=float)
    if len(ranges) != len(codes):
        ranges = np.arange(1, len(codes) + 1) * (float(scan.range_max) / max(len(codes), 1))
    bearing = seanet_bearing(float(scan.angle_min))
    return encoder.message(stamp_of(scan, "beam"), bearing, _bin_centres(ranges), codes)


def _bin_centres(ranges: Array) -> Array:
    """Return the centres of bins for which near edges, centres or far edges are given.

    The first bin begins at the head in any case, so the distance between bins says it all.
    """
    count = np.arange(len(ranges))
    if len(ranges) == 0:
        raise Refusal("beam_without_bins")
    length = float(np.ptp(ranges)) / (len(ranges) - 1) if len(ranges) > 1 else float(ranges[0])
    offset = float(ranges[0]) / length if length > 0.0 else np.nan
    if not abs(2.0 * offset - np.clip(np.rint(2.0 * offset), 0.0, 2.0)) < 2.0 * _IRREGULARITY:
        raise Refusal("beam_bins_not_regular")
    if not np.allclose(ranges, (count + offset) * length, rtol=0.0, atol=_IRREGULARITY * length):
        raise Refusal("beam_bins_not_regular")
    return np.asarray((count + 0.5) * length, dtype=float)


def _pressure(message: Any) -> Any:
    """Return the pressure that a run reads as this depth again, with the default density."""
    stamp_ns = stamp_of(message, "pressure")
    pressure = pressure_at(-float(message.depth), Sensors())
    converted = encoding.fluid_pressure(make, stamp_ns, pressure, BASE_LINK)
    decoding.depth(converted, Sensors())
    return converted


def _velocity(message: Any) -> Any:
    """Return the velocity over ground; without all of it the instrument's flag is not 1."""
    if message.velocityInstFlag != _VALID:
        raise Refusal("dvl_without_bottom")
    forward, starboard, down = (float(value) for value in message.velocityInst)
    velocity = np.array([forward, -starboard, -down])
    sample = BodyVelocity(stamp_of(message, "dvl"), velocity, _DVL_DEVIATION**2 * np.eye(3))
    converted = encoding.twist(make, sample, BASE_LINK)
    decoding.body_velocity(converted)
    return converted
