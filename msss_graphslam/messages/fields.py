# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Fields that many messages share to numbers; what cannot be used raises Refusal."""

from math import asin, atan2, copysign, hypot, isfinite, pi, remainder
from typing import Any

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.messages.refusal import Refusal

__all__ = [
    "Vector",
    "angles_from",
    "angles_of",
    "numbers",
    "pose_from",
    "pose_of",
    "stamp_of",
    "time_of",
    "vector_from",
    "vector_of",
]

Vector = tuple[float, float, float]

_NANOSECONDS = 1_000_000_000
_SHORTEST_QUATERNION = 1e-3
# Sine of the pitch from where on roll and yaw are one rotation: all of it is given to yaw.
_VERTICAL = 1.0 - 1e-10


def stamp_of(message: Any, name: str) -> int:
    """Return the stamp [ns] of the header; ``name`` is for the refusal."""
    return time_of(message.header, name)


def time_of(header: Any, name: str) -> int:
    """Return the stamp [ns] of a std_msgs/Header; ``name`` is for the refusal."""
    stamp = header.stamp
    if stamp.sec < 0 or not 0 <= stamp.nanosec < _NANOSECONDS:
        raise Refusal(f"{name}_stamp_invalid")
    return int(stamp.sec) * _NANOSECONDS + int(stamp.nanosec)


def pose_of(position: Any, orientation: Any, name: str) -> Array:
    """Return x, y, z, roll, pitch, yaw (6,) [m, rad]; ``name`` is for the refusal."""
    place = _components(position)
    return pose_from(place, _components(orientation), float(orientation.w), name)


def angles_of(quaternion: Any, name: str) -> Array:
    """Return roll, pitch, yaw (3,) [rad] of a quaternion of any length."""
    return np.array(angles_from(*_components(quaternion), float(quaternion.w), name))


def vector_of(values: Any, reason: str) -> Array:
    """Return x, y, z (3,); ``reason`` is the refusal of what is not finite."""
    return vector_from(*_components(values), reason)


def pose_from(place: Vector, axis: Vector, w: float, name: str) -> Array:
    """Return x, y, z, roll, pitch, yaw (6,) of a place [m] and a quaternion (*axis, w)."""
    _check_finite(*place, f"{name}_not_finite")
    return np.array(place + angles_from(*axis, w, name))


def vector_from(x: float, y: float, z: float, reason: str) -> Array:
    """Return x, y, z (3,); ``reason`` is the refusal of what is not finite."""
    _check_finite(x, y, z, reason)
    return np.array((x, y, z))


def angles_from(x: float, y: float, z: float, w: float, name: str) -> Vector:
    """Return roll, pitch, yaw [rad] of a quaternion of any length."""
    length = hypot(x, y, z, w)
    if not isfinite(length):
        raise Refusal(f"{name}_not_finite")
    if length < _SHORTEST_QUATERNION:
        raise Refusal(f"{name}_quaternion_zero")
    x, y, z, w = x / length, y / length, z / length, w / length
    sine = 2.0 * (w * y - z * x)
    if abs(sine) > _VERTICAL:
        return 0.0, copysign(pi / 2.0, sine), remainder(2.0 * atan2(z, w), 2.0 * pi)
    roll = atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    yaw = atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return roll, asin(sine), yaw


def _components(values: Any) -> Vector:
    return float(values.x), float(values.y), float(values.z)


def _check_finite(x: float, y: float, z: float, reason: str) -> None:
    if not (isfinite(x) and isfinite(y) and isfinite(z)):
        raise Refusal(reason)


def numbers(values: Any) -> Array:
    """Return the numbers, whatever kind of sequence holds them; not checked."""
    return np.asarray(values, dtype=np.float64)
