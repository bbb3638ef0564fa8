# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What sensors publish: one beam, a port's bytes, an inertial sample, a pressure, a velocity."""

from typing import Any

import numpy as np

from msss_graphslam.core.types import Array, Beam, BodyVelocity, Inertial
from msss_graphslam.messages.encoding.primitives import (
    Make,
    covariance_36,
    header,
    orientation,
    vector,
)
from msss_graphslam.messages.raw_bytes import label_of

__all__ = ["fluid_pressure", "imu", "laser_scan", "raw_bytes", "twist"]


def laser_scan(make: Make, beam: Beam, frame_id: str, scan_time: float) -> Any:
    """Return the beam as a sensor_msgs/LaserScan; ``scan_time`` is the beam's period [s]."""
    return make(
        "sensor_msgs/msg/LaserScan",
        header=header(make, beam.stamp_ns, frame_id),
        angle_min=float(beam.bearing),
        angle_max=float(beam.bearing),
        angle_increment=0.0,
        time_increment=0.0,
        scan_time=float(scan_time),
        range_min=float(beam.ranges[0]),
        range_max=float(beam.ranges[-1]),
        ranges=np.ascontiguousarray(beam.ranges, dtype=np.float32),
        intensities=np.ascontiguousarray(beam.intensities, dtype=np.float32),
    )


def raw_bytes(make: Make, data: bytes, received_ns: int) -> Any:
    """Return bytes of the sonar's port as a std_msgs/UInt8MultiArray; ``received_ns``: when."""
    size = len(data)
    dimension = make(
        "std_msgs/msg/MultiArrayDimension", label=label_of(received_ns), size=size, stride=size
    )
    layout = make("std_msgs/msg/MultiArrayLayout", dim=[dimension], data_offset=0)
    return make(
        "std_msgs/msg/UInt8MultiArray", layout=layout, data=np.frombuffer(data, dtype=np.uint8)
    )


def imu(
    make: Make,
    sample: Inertial,
    frame_id: str,
    orientation_variance: float = 0.0,
    angular_velocity_variance: float = 0.0,
) -> Any:
    """Return a sensor_msgs/Imu; what is absent is marked so (REP-145).

    The variances [rad^2, rad^2/s^2] are those of each axis, 0 where they are not known. There is
    never an acceleration.
    """
    angles = np.zeros(3) if sample.orientation is None else sample.orientation
    rates = np.zeros(3) if sample.angular_velocity is None else sample.angular_velocity
    return make(
        "sensor_msgs/msg/Imu",
        header=header(make, sample.stamp_ns, frame_id),
        orientation=orientation(make, angles),
        orientation_covariance=_isotropic(sample.orientation, orientation_variance),
        angular_velocity=vector(make, rates),
        angular_velocity_covariance=_isotropic(sample.angular_velocity, angular_velocity_variance),
        linear_acceleration_covariance=_isotropic(None, 0.0),
    )


def fluid_pressure(
    make: Make, stamp_ns: int, pressure: float, frame_id: str, variance: float = 0.0
) -> Any:
    """Return a sensor_msgs/FluidPressure of a pressure [Pa] and its variance [Pa^2]."""
    return make(
        "sensor_msgs/msg/FluidPressure",
        header=header(make, stamp_ns, frame_id),
        fluid_pressure=float(pressure),
        variance=float(variance),
    )


def twist(make: Make, velocity: BodyVelocity, frame_id: str) -> Any:
    """Return a geometry_msgs/TwistWithCovarianceStamped; rotation is marked as unknown (-1)."""
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = velocity.covariance
    covariance[3, 3] = -1.0
    return make(
        "geometry_msgs/msg/TwistWithCovarianceStamped",
        header=header(make, velocity.stamp_ns, frame_id),
        twist=make(
            "geometry_msgs/msg/TwistWithCovariance",
            twist=make("geometry_msgs/msg/Twist", linear=vector(make, velocity.velocity)),
            covariance=covariance_36(covariance),
        ),
    )


def _isotropic(value: object | None, variance: float) -> Array:
    covariance = np.zeros(9)
    covariance[[0, 4, 8]] = variance
    if value is None:
        covariance[0] = -1.0
    return covariance
