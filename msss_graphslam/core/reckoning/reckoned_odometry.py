# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What dead reckoning gives out: the pose, the velocity, and how much of each is known."""

from collections.abc import Sequence

import numpy as np

from msss_graphslam.config.groups import DeadReckoning as DeadReckoningConfig
from msss_graphslam.core.compounding import wrap_angle
from msss_graphslam.core.reckoning.kalman_filter import VELOCITY_ERROR, KalmanFilter
from msss_graphslam.core.types import Odometry

__all__ = ["odometry_of", "yaw_rate_variance"]

TURN_S = 10.0
"""A turn of the head, over which the published velocity's error is called slow [s]."""


def odometry_of(
    ekf: KalmanFilter, stamp_ns: int, rates: Sequence[float], rate_variance: float, drift: float
) -> Odometry:
    """Return the odometry of a filter that stands at ``stamp_ns``.

    ``rates`` (3,) [rad/s] are the body's, ``rate_variance`` is that of the last of them, ``drift``
    the random walk of the place [m/sqrt(s)].
    """
    x, y, z, roll, pitch, yaw = ekf.state[:6]
    covariance = ekf.covariance
    twist_covariance = np.zeros((6, 6))
    twist_covariance[:3, :3] = covariance[VELOCITY_ERROR, VELOCITY_ERROR]
    if drift:
        twist_covariance[[0, 1], [0, 1]] += drift**2 / TURN_S
    twist_covariance[5, 5] = rate_variance
    return Odometry(
        stamp_ns=stamp_ns,
        pose=np.array([x, y, z, wrap_angle(roll), wrap_angle(pitch), wrap_angle(yaw)]),
        covariance=covariance[:6, :6].copy(),
        twist=np.array([*ekf.velocity, *rates]),
        twist_covariance=twist_covariance,
    )


def yaw_rate_variance(config: DeadReckoningConfig, has_gyro: bool, has_compass: bool) -> float:
    """Return the variance [rad^2/s^2] of the yaw rate's slow error, by the sensors that speak."""
    if has_gyro:
        return config.gyro_noise**2 / TURN_S + config.gyro_bias**2
    turned = config.turn_rate_noise**2 / TURN_S
    if not has_compass:
        return turned
    drift = 2.0 * config.compass_drift**2 * TURN_S / config.compass_correlation_time
    return min(turned, (2.0 * config.compass_noise**2 + drift) / TURN_S**2)
