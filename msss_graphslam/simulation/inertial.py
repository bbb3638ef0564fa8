# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The sensors that are not a sonar: attitude and heading reference, gyro, pressure, DVL."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.processes import GaussMarkov
from msss_graphslam.simulation.streams import stream
from msss_graphslam.simulation.vehicle import Motion

__all__ = [
    "DVL_DEVIATION",
    "InertialSamples",
    "NoiseLevel",
    "PressureSamples",
    "VelocitySamples",
    "measure_inertial",
    "measure_pressure",
    "measure_velocity",
]

DVL_DEVIATION = 0.01

_IMU_PERIOD = 0.04
_YAW_DEVIATION = np.radians(0.5)
_YAW_DRIFT = GaussMarkov(np.radians(6.0), 500.0)
_TILT_DEVIATION = np.radians(0.3)
_GYRO_DEVIATION = np.radians(0.15)
_GYRO_BIAS = np.radians(0.02)
_PRESSURE_PERIOD = 0.1
_PRESSURE_DEVIATION = 100.0
_SURFACE_PRESSURE = 101_325.0
_WEIGHT_OF_WATER = 1000.0 * 9.80665
_DVL_PERIOD = 0.2


class NoiseLevel(StrEnum):
    """How unsteady the motion is, and how noisy the attitude; ``paper`` drifts as there."""

    LOW = "low"
    PAPER = "paper"
    HIGH = "high"

    @property
    def scale(self) -> float:
        """The factor on the standard deviations of ``paper``."""
        return {NoiseLevel.LOW: 0.3, NoiseLevel.PAPER: 1.0, NoiseLevel.HIGH: 2.0}[self]


@dataclass(frozen=True, slots=True)
class InertialSamples:
    """IMU samples at ``times`` (n,) [s].

    ``orientations`` (n, 3) roll, pitch, yaw [rad]; ``angular_velocities`` (n, 3) [rad/s].
    """

    times: Array
    orientations: Array
    angular_velocities: Array


@dataclass(frozen=True, slots=True)
class PressureSamples:
    """Absolute ``pressures`` (n,) [Pa] at ``times`` (n,) [s]."""

    times: Array
    pressures: Array


@dataclass(frozen=True, slots=True)
class VelocitySamples:
    """``velocities`` (n, 3) of the body [m/s] at ``times`` (n,) [s]."""

    times: Array
    velocities: Array


def measure_inertial(motion: Motion, seed: int, scale: float) -> InertialSamples:
    """Return what the AHRS and its gyros say; the compass's drift is zero at launch.

    The noises are ``scale`` times those that give the paper's dead reckoning.
    """
    times = np.arange(0.0, motion.duration, _IMU_PERIOD)
    white = stream(seed, "attitude").standard_normal((len(times), 3))
    white *= scale * np.array([_TILT_DEVIATION, _TILT_DEVIATION, _YAW_DEVIATION])
    orientations = motion.at(times)[:, 3:] + white
    drift = stream(seed, "compass drift")
    orientations[:, 2] += scale * _YAW_DRIFT.sample(drift, len(times), _IMU_PERIOD, from_zero=True)
    bias = _GYRO_BIAS * stream(seed, "gyro bias").standard_normal(3)
    noise = bias + _GYRO_DEVIATION * stream(seed, "gyro").standard_normal((len(times), 3))
    return InertialSamples(
        times, orientations, motion.angular_velocities_at(times) + scale * noise
    )


def measure_pressure(motion: Motion, seed: int) -> PressureSamples:
    """Return the absolute pressure at the vehicle in fresh water, 101,325 Pa at the surface."""
    times = np.arange(0.0, motion.duration, _PRESSURE_PERIOD)
    noise = _PRESSURE_DEVIATION * stream(seed, "pressure").standard_normal(len(times))
    return PressureSamples(
        times, _SURFACE_PRESSURE - _WEIGHT_OF_WATER * motion.at(times)[:, 2] + noise
    )


def measure_velocity(motion: Motion, seed: int) -> VelocitySamples:
    """Return the body velocities of a DVL."""
    times = np.arange(0.0, motion.duration, _DVL_PERIOD)
    noise = DVL_DEVIATION * stream(seed, "dvl").standard_normal((len(times), 3))
    return VelocitySamples(times, motion.velocities_at(times) + noise)
