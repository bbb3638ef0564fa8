# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Messages to records, by field names alone; what cannot be used raises Refusal.

No bytes of a message can make a record with a number that is not finite.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from typing import Any

import numpy as np

from msss_graphslam.config.groups import Sensors
from msss_graphslam.core.types import Array, Beam, BodyVelocity, Depth, Inertial
from msss_graphslam.messages.fields import angles_of, numbers, pose_of, stamp_of, vector_of
from msss_graphslam.messages.hydrostatics import height_of
from msss_graphslam.messages.raw_bytes import RawBytes, raw_bytes
from msss_graphslam.messages.refusal import Refusal

__all__ = [
    "RawBytes",
    "TruePose",
    "beam",
    "bins",
    "body_velocity",
    "depth",
    "depth_from",
    "inertial",
    "placement",
    "raw_bytes",
    "sample",
    "true_pose",
]


@dataclass(frozen=True, slots=True)
class TruePose:
    """Ground truth at one stamp: ``pose`` (6,) is x, y, z, roll, pitch, yaw."""

    stamp_ns: int
    pose: Array


_LARGEST_CODE = 255.0
# Full ocean depth has 1.1e8 Pa. A reading less than half an atmosphere below the surface's is no
# sensor in water: it is a gauge taken for an absolute sensor, or a dead one.
_LOWEST_ABSOLUTE, _LOWEST_GAUGE, _HIGHEST = 5e4, -5e4, 1.2e8


def beam(message: Any) -> Beam:
    """Return the beam of a sensor_msgs/LaserScan."""
    stamp_ns = stamp_of(message, "beam")
    bearing = float(message.angle_min)
    if not isfinite(bearing):
        raise Refusal("beam_bearing_not_finite")
    if bearing != float(message.angle_max):
        raise Refusal("beam_with_several_bearings")
    ranges = bins(numbers(message.ranges).tobytes())
    intensities = numbers(message.intensities)
    _check_profile(ranges, intensities)
    return Beam(stamp_ns, bearing, ranges, intensities)


def inertial(message: Any) -> Inertial:
    """Return the sample of a sensor_msgs/Imu, read as REP-145 says."""
    stamp_ns = stamp_of(message, "imu")
    orientation = rates = None
    if _given(message.orientation_covariance):
        orientation = angles_of(message.orientation, "imu")
    if _given(message.angular_velocity_covariance):
        rates = vector_of(message.angular_velocity, "imu_not_finite")
    return sample(stamp_ns, orientation, rates)


def sample(stamp_ns: int, orientation: Array | None, rates: Array | None) -> Inertial:
    """Return the sample of an IMU, unless it says nothing."""
    if orientation is None and rates is None:
        raise Refusal("imu_without_data")
    return Inertial(stamp_ns, orientation, rates)


def depth(message: Any, sensors: Sensors) -> Depth:
    """Return the depth of a sensor_msgs/FluidPressure."""
    return depth_from(stamp_of(message, "pressure"), float(message.fluid_pressure), sensors)


def depth_from(stamp_ns: int, pressure: float, sensors: Sensors) -> Depth:
    """Return the depth at which the sensor reads ``pressure`` [Pa]."""
    if not isfinite(pressure):
        raise Refusal("pressure_not_finite")
    lowest = _LOWEST_GAUGE if sensors.gauge_pressure else _LOWEST_ABSOLUTE
    if not lowest <= pressure <= _HIGHEST:
        raise Refusal("pressure_out_of_range")
    return Depth(stamp_ns, height_of(pressure, sensors))


def body_velocity(message: Any) -> BodyVelocity:
    """Return the velocity of a geometry_msgs/TwistWithCovarianceStamped."""
    stamp_ns = stamp_of(message, "dvl")
    velocity = vector_of(message.twist.twist.linear, "dvl_not_finite")
    covariance = numbers(message.twist.covariance)
    if covariance.shape != (36,):
        raise Refusal("dvl_covariance_size")
    covariance = covariance.reshape(6, 6)[:3, :3]
    if not np.isfinite(covariance).all():
        raise Refusal("dvl_not_finite")
    if not _is_positive_definite(covariance):
        raise Refusal("dvl_covariance_not_positive")
    return BodyVelocity(stamp_ns, velocity, covariance)


def true_pose(message: Any) -> TruePose:
    """Return the pose of a nav_msgs/Odometry."""
    stamp_ns = stamp_of(message, "ground_truth")
    placed = message.pose.pose
    return TruePose(stamp_ns, pose_of(placed.position, placed.orientation, "ground_truth"))


def placement(message: Any) -> Array:
    """Return the child's pose (6,) in its parent of a geometry_msgs/TransformStamped."""
    return pose_of(message.transform.translation, message.transform.rotation, "transform")


@lru_cache(maxsize=64)
def bins(data: bytes) -> Array:
    """Return the bins' centres (64-bit); beams share one array, which is checked once."""
    ranges = np.frombuffer(data)
    if ranges.size == 0:
        raise Refusal("beam_without_bins")
    if not np.isfinite(ranges).all():
        raise Refusal("beam_not_finite")
    if ranges[0] < 0.0 or (np.diff(ranges) <= 0.0).any():
        raise Refusal("beam_ranges_not_increasing")
    return ranges


def _check_profile(ranges: Array, intensities: Array) -> None:
    if ranges.shape != intensities.shape:
        raise Refusal("beam_lengths_differ")
    lowest, highest = intensities.min(), intensities.max()  # of a NaN among them: NaN
    if not (isfinite(lowest) and isfinite(highest)):
        raise Refusal("beam_not_finite")
    if lowest < 0.0 or highest > _LARGEST_CODE:
        raise Refusal("beam_intensity_out_of_range")


def _given(covariance: Any) -> bool:
    if len(covariance) != 9:
        raise Refusal("imu_covariance_size")
    return float(covariance[0]) != -1.0


def _is_positive_definite(covariance: Array) -> bool:
    scale = float(np.abs(covariance).max())
    if scale == 0.0:
        return False
    scaled = covariance / scale
    return bool(np.allclose(scaled, scaled.T) and np.linalg.eigvalsh(scaled)[0] > 0.0)
