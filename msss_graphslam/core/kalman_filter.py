# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The extended Kalman filter's state, prediction and updates (Section IV-A)."""

import math
from copy import copy
from typing import Self

import numpy as np

from msss_graphslam.config.groups import DeadReckoning as DeadReckoningConfig
from msss_graphslam.core.attitude import (
    rate_derivatives,
    rate_matrix,
    rotation_derivatives,
    rotation_matrix,
)
from msss_graphslam.core.types import Array

__all__ = ["ATTITUDE", "SIZE", "VELOCITY_ERROR", "YAW", "KalmanFilter", "Z", "transition"]

SIZE = 10
POSITION, ATTITUDE, VELOCITY_ERROR = slice(0, 3), slice(3, 6), slice(6, 9)
Z, YAW, COMPASS_BIAS = 2, 5, 9
DIAGONAL = slice(None, None, SIZE + 1)
"""The diagonal's places in a flat (10, 10) matrix."""
IDENTITY = np.eye(SIZE)
COMPASS = np.isin(np.arange(SIZE), (YAW, COMPASS_BIAS)).astype(float)
"""What the compass shows of the state (10,): the yaw and its own bias."""


def transition(
    state: Array, assumed_velocity: Array, rates: Array, interval: float, decay: float
) -> tuple[Array, Array]:
    """Return the predicted state (10,) and its Jacobian F (10, 10): equations 6 to 8.

    The state is position [m] and attitude [rad] (the paper's X), then two slow errors: of the
    body velocity (3) [m/s] and of the compass [rad]. ``rates`` (3,) [rad/s] are the body's,
    ``interval`` [s], ``decay`` the Gauss-Markov factor of the velocity's error.
    """
    # Deviation: the paper's control noise w_k is white. A speed that is wrong for minutes is not,
    # and white noise then makes the filter overconfident, so the slow errors are states.
    angles = state[ATTITUDE]
    velocity = assumed_velocity + state[VELOCITY_ERROR]
    to_world = rotation_matrix(angles)
    travelled = interval * to_world
    predicted = state.copy()
    predicted[POSITION] += travelled @ velocity  # eq. 6
    predicted[ATTITUDE] += interval * rate_matrix(angles) @ rates  # eq. 6
    predicted[VELOCITY_ERROR] *= decay
    jacobian = IDENTITY.copy()
    jacobian[POSITION, ATTITUDE] = interval * rotation_derivatives(
        to_world, float(angles[2]), velocity
    )
    jacobian[POSITION, VELOCITY_ERROR] = travelled
    jacobian[ATTITUDE, ATTITUDE] += interval * rate_derivatives(angles, rates)
    jacobian[VELOCITY_ERROR, VELOCITY_ERROR] *= decay
    return predicted, jacobian


class KalmanFilter:
    """State (10,) and covariance (10, 10) of dead reckoning; see ``transition`` for the state."""

    def __init__(
        self, config: DeadReckoningConfig, z: float, attitude: Array, variance: float
    ) -> None:
        self._take_over(config)
        self.state = np.zeros(SIZE)
        self.state[Z] = z
        self.state[ATTITUDE] = attitude
        variances = np.zeros(SIZE)
        variances[Z] = config.depth_noise**2
        variances[ATTITUDE] = variance
        variances[VELOCITY_ERROR] = self._stationary
        self.covariance = np.diag(variances)

    def configure(self, config: DeadReckoningConfig) -> None:
        """Go on with other parameters; the estimated velocity stays as it is."""
        before = self._assumed_velocity
        self._take_over(config)
        self.state[VELOCITY_ERROR] += before - self._assumed_velocity

    def copy(self) -> Self:
        """Return a filter in the same state that goes its own way."""
        clone = copy(self)
        clone.state, clone.covariance = self.state.copy(), self.covariance.copy()
        return clone

    @property
    def velocity(self) -> Array:
        """The estimated body velocity (3,) [m/s]."""
        return self._assumed_velocity + self.state[VELOCITY_ERROR]

    def predict(
        self, interval: float, rates: Array, rate_noise: float, drift_noise: float = 0.0
    ) -> None:
        """Propagate over ``interval`` [s] with body ``rates`` (3,), equations 7 and 8.

        ``rate_noise`` is the angle random walk [rad/sqrt(s)] of the rates, ``drift_noise`` that of
        the place [m/sqrt(s)] beyond the slow error of the velocity.
        """
        if interval <= 0.0:
            return
        config = self._config
        decay = math.exp(-interval / config.velocity_correlation_time)
        self.state, jacobian = transition(
            self.state, self._assumed_velocity, rates, interval, decay
        )
        # Deviation: depth is tied to heave alone and yaw to itself. Through a degree of roll or
        # pitch that the AHRS has wrong, the full Jacobian lets the pressure sensor speak of the
        # forward speed and the inclinometers of the heading, both wrongly.
        jacobian[Z, 3:8] = 0.0
        jacobian[:2, 8] = 0.0
        jacobian[YAW, 3:5] = 0.0
        compass_decay = math.exp(-interval / config.compass_correlation_time)
        jacobian[COMPASS_BIAS, COMPASS_BIAS] = compass_decay
        noise = np.zeros(SIZE)
        noise[:2] = drift_noise**2 * interval
        noise[ATTITUDE] = rate_noise**2 * interval
        noise[VELOCITY_ERROR] = self._stationary * (1.0 - decay**2)
        noise[COMPASS_BIAS] = config.compass_drift**2 * (1.0 - compass_decay**2)
        self.covariance = jacobian @ self.covariance @ jacobian.T  # eq. 8
        self.covariance.reshape(-1)[DIAGONAL] += noise

    def update(self, index: int, difference: float, variance: float) -> None:
        """Take in measurement minus prediction of one state, equations 9 and 10."""
        projected = self.covariance[:, index]
        gain = projected / (projected[index] + variance)
        self.state += gain * difference
        self.covariance -= gain[:, None] * projected

    def heading_gain(self, variance: float) -> float:
        """Return equation 10's gain of the yaw for a compass of this ``variance`` and its bias."""
        together = float(self.covariance[YAW, YAW] + self.covariance[YAW, COMPASS_BIAS])
        return together / (self.spread(YAW) + variance)

    def update_heading(self, difference: float, variance: float, gain: float) -> None:
        """Let the yaw alone follow the compass by ``gain``; the covariance knows of its bias."""
        projected = gain * (self.covariance @ COMPASS)
        self.state[YAW] += gain * difference
        self.covariance[YAW] -= projected
        self.covariance[:, YAW] -= projected
        self.covariance[YAW, YAW] += gain * float(COMPASS @ projected) + gain**2 * variance

    def spread(self, index: int) -> float:
        """Return the variance with which a measurement of the state is predicted."""
        variance = float(self.covariance[index, index])
        if index == YAW:
            bias = float(self.covariance[COMPASS_BIAS, COMPASS_BIAS])
            variance += bias + 2.0 * float(self.covariance[YAW, COMPASS_BIAS])
        return variance

    def open(self, index: int, difference: float) -> None:
        """Admit that one state may be wrong by ``difference``."""
        self.covariance[index, index] += difference**2

    def _take_over(self, config: DeadReckoningConfig) -> None:
        self._config = config
        self._assumed_velocity = np.array([config.surge_speed, 0.0, 0.0])
        self._stationary = (
            np.array([config.surge_noise, config.sway_noise, config.heave_noise]) ** 2
        )
