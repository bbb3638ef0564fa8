# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers read where they lie in a message, without an object being made of it.

Nine messages in ten are as long as those before them, and have the same texts. What differs is
left alone here: whoever reads decodes it whole, and says what is wrong with it.
"""

from collections.abc import Callable
from math import isfinite
from struct import Struct
from typing import Generic, TypeVar

import numpy as np

from msss_graphslam.config.groups import Sensors
from msss_graphslam.core.types import Array, Beam, Depth, Inertial
from msss_graphslam.messages import decoding
from msss_graphslam.messages.fields import angles_from, pose_from, vector_from

__all__ = ["DirectBeams", "DirectReading", "depth_at", "inertial_at", "true_pose_at"]

Record = TypeVar("Record")
Taking = Callable[[int, bytes, int], Record | None]
"""Takes a stamp [ns], a message and where its numbers begin; None leaves the message alone."""

_LITTLE_ENDIAN = b"\x00\x01"
_ENCAPSULATION = 4
_TEXT_AT = 12
_STAMP = Struct("<iI")
_LENGTH = Struct("<I")
_NANOSECONDS = 1_000_000_000

_IMU = Struct("<5d64x4d")  # orientation and its first covariance, rates and theirs
_PRESSURE = Struct("<d")
_POSE = Struct("<7d")
_SCAN = Struct("<2f20xI")  # the two bearings, and how many ranges follow
_LARGEST_BITS = int(np.float32(255.0).view(np.uint32))


class DirectReading(Generic[Record]):
    """Reads messages of one type that are laid out as the last that was decoded whole.

    The message begins with a std_msgs/Header; ``texts`` strings follow each other in all, then
    numbers aligned to ``alignment`` bytes.
    """

    def __init__(self, take: Taking[Record], alignment: int = 8, texts: int = 1) -> None:
        self._take = take
        self._alignment = alignment
        self._texts = texts
        self._size = -1
        self._text = b""
        self._start = 0

    def read(self, data: bytes) -> Record | None:
        """Return the record, or None for a message to be decoded whole; may raise Refusal."""
        known = len(data) == self._size and data.startswith(_LITTLE_ENDIAN)
        if not known or not data.startswith(self._text, _TEXT_AT):
            return None
        seconds, nanoseconds = _STAMP.unpack_from(data, _ENCAPSULATION)
        if seconds < 0 or nanoseconds >= _NANOSECONDS:
            return None
        return self._take(seconds * _NANOSECONDS + nanoseconds, data, self._start)

    def learn(self, data: bytes) -> None:
        """Take over the layout of a message that was decoded whole."""
        if not data.startswith(_LITTLE_ENDIAN):
            return
        end = _TEXT_AT
        for _ in range(self._texts):
            at = _aligned(end, 4)
            end = at + 4 + _LENGTH.unpack_from(data, at)[0]
        self._size, self._text = len(data), data[_TEXT_AT:end]
        self._start = _aligned(end, self._alignment)


def inertial_at(stamp_ns: int, data: bytes, start: int) -> Inertial:
    """Return the sample of a sensor_msgs/Imu."""
    x, y, z, w, is_oriented, p, q, r, is_turning = _IMU.unpack_from(data, start)
    orientation = np.array(angles_from(x, y, z, w, "imu")) if is_oriented != -1.0 else None
    rates = vector_from(p, q, r, "imu_not_finite") if is_turning != -1.0 else None
    return decoding.sample(stamp_ns, orientation, rates)


def depth_at(sensors: Sensors) -> Taking[Depth]:
    """Return what reads the depth of a sensor_msgs/FluidPressure."""

    def take(stamp_ns: int, data: bytes, start: int) -> Depth:
        (pressure,) = _PRESSURE.unpack_from(data, start)
        return decoding.depth_from(stamp_ns, pressure, sensors)

    return take


def true_pose_at(stamp_ns: int, data: bytes, start: int) -> decoding.TruePose:
    """Return the pose of a nav_msgs/Odometry."""
    x, y, z, *axis, w = _POSE.unpack_from(data, start)
    pose = pose_from((x, y, z), (axis[0], axis[1], axis[2]), w, "ground_truth")
    return decoding.TruePose(stamp_ns, pose)


class DirectBeams:
    """Takes the beams of sensor_msgs/LaserScan; the bins of one are those of the next."""

    def __init__(self) -> None:
        self._ranges: Array = np.empty(0)
        self._encoded = b""

    def take(self, stamp_ns: int, data: bytes, start: int) -> Beam | None:
        """Return the beam, or None for one to be decoded whole; may raise Refusal."""
        bearing, until, count = _SCAN.unpack_from(data, start)
        ranges_at = start + _SCAN.size
        codes_at = ranges_at + 4 * count + 4
        if until != bearing or not isfinite(bearing):
            return None
        if not 0 <= len(data) - codes_at - 4 * count < _ENCAPSULATION:
            return None
        if _LENGTH.unpack_from(data, codes_at - 4)[0] != count:
            return None
        # As a whole number, a float's bits grow with it from 0 on; all others have higher ones.
        bits = np.frombuffer(data, "<u4", count, codes_at)
        if np.maximum.reduce(bits) > _LARGEST_BITS:
            return None
        ranges = self._bins(data[ranges_at : codes_at - 4])
        return Beam(stamp_ns, bearing, ranges, bits.view("<f4").astype(np.float64))

    def _bins(self, encoded: bytes) -> Array:
        if encoded != self._encoded:
            ranges = np.frombuffer(encoded, "<f4").astype(np.float64)
            self._ranges, self._encoded = decoding.bins(ranges.tobytes()), encoded
        return self._ranges


def _aligned(position: int, alignment: int) -> int:
    return position + (_ENCAPSULATION - position) % alignment
