# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The parts that messages share: header, quaternion, pose, covariance."""

from math import cos, sin
from typing import Any, Protocol

import numpy as np

from msss_graphslam.core.types import Array

__all__ = [
    "Make",
    "covariance_36",
    "header",
    "orientation",
    "point",
    "pose_of",
    "quaternion",
    "vector",
]

_NANOSECONDS = 1_000_000_000
_PLANAR = np.ix_([0, 1, 5], [0, 1, 5])


class Make(Protocol):
    """Makes a message of the type, with the fields given and the others at their defaults."""

    def __call__(self, type_name: str, **fields: Any) -> Any:
        """Return the message."""


def header(make: Make, stamp_ns: int, frame_id: str) -> Any:
    """Return a std_msgs/Header."""
    seconds, nanoseconds = divmod(int(stamp_ns), _NANOSECONDS)
    stamp = make("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)
    return make("std_msgs/msg/Header", stamp=stamp, frame_id=frame_id)


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Return x, y, z, w of the rotation by yaw, then pitch, then roll about moving axes [rad]."""
    cr, sr = cos(roll / 2.0), sin(roll / 2.0)
    cp, sp = cos(pitch / 2.0), sin(pitch / 2.0)
    cy, sy = cos(yaw / 2.0), sin(yaw / 2.0)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def orientation(make: Make, angles: Array) -> Any:
    """Return a Quaternion of roll, pitch, yaw (3,) [rad]."""
    x, y, z, w = quaternion(*angles.tolist())
    return make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)


def vector(make: Make, values: Array) -> Any:
    """Return a Vector3 of (3,)."""
    x, y, z = values.tolist()
    return make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)


def point(make: Make, values: Array) -> Any:
    """Return a Point of (3,) [m]."""
    x, y, z = values.tolist()
    return make("geometry_msgs/msg/Point", x=x, y=y, z=z)


def pose_of(make: Make, pose: Array) -> Any:
    """Return a Pose of x, y, z, roll, pitch, yaw (6,), or of a planar x, y, yaw (3,)."""
    if len(pose) == 3:
        pose = np.array([pose[0], pose[1], 0.0, 0.0, 0.0, pose[2]])
    return make(
        "geometry_msgs/msg/Pose",
        position=point(make, pose[:3]),
        orientation=orientation(make, pose[3:]),
    )


def covariance_36(covariance: Array) -> Array:
    """Return the 36 values of a (6, 6) covariance, or of a planar (3, 3) one of x, y, yaw."""
    if covariance.shape == (6, 6):
        return np.ascontiguousarray(covariance, dtype=np.float64).reshape(36)
    spatial = np.zeros((6, 6))
    spatial[_PLANAR] = covariance
    return spatial.reshape(36)
