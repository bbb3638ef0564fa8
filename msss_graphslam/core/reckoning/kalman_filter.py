# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The extended Kalman filter's state, prediction and updates (Section IV-A)."""

import math
from collections.abc import Sequence
from copy import copy
from typing import Self

from msss_graphslam.config.groups import DeadReckoning as DeadReckoningConfig
from msss_graphslam.core.reckoning.attitude import (
    Vector,
    rate_derivatives,
    rate_matrix,
    rotation_derivatives,
    rotation_matrix,
    times,
)
from msss_graphslam.core.reckoning.paired_covariance import Derivatives, PairedCovariance
from msss_graphslam.core.types import Array

__all__ = ["ATTITUDE", "VELOCITY_ERROR", "YAW", "KalmanFilter", "Z", "transition"]

ATTITUDE, VELOCITY_ERROR = slice(3, 6), slice(6, 9)
X, Y, Z, YAW, COMPASS_BIAS = 0, 1, 2, 5, 9


def transition(
    state: Sequence[float],
    assumed_speed: float,
    rates: Sequence[float],
    interval: float,
    decays: tuple[float, float],
) -> tuple[list[float], Derivatives]:
    """Return the predicted state (10,) and the blocks of F: equations 6 to 8.

    The state is position [m] and attitude [rad] (the paper's X), then two slow errors: of the
    body velocity (3) [m/s] and of the compass [rad]. ``assumed_speed`` [m/s] is ahead, ``rates``
    (3,) [rad/s] are the body's, ``interval`` [s], ``decays`` the Gauss-Markov factors of the two
    errors.
    """
    # Deviation: the paper's control noise w_k is white. A speed that is wrong for minutes is not,
    # and white noise then makes the filter overconfident, so the slow errors are states.
    x, y, z, roll, pitch, yaw, surge, sway, heave, bias = state
    velocity, angles = (assumed_speed + surge, sway, heave), (roll, pitch, yaw)
    to_world = rotation_matrix(angles)
    east, north, up = times(to_world, velocity)
    rolling, pitching, yawing = times(rate_matrix(angles), rates)
    decay, compass_decay = decays
    predicted = [
        x + interval * east,  # eq. 6
        y + interval * north,
        z + interval * up,
        roll + interval * rolling,
        pitch + interval * pitching,
        yaw + interval * yawing,
        decay * surge,
        decay * sway,
        decay * heave,
        bias,
    ]
    return predicted, Derivatives(
        interval,
        rotation_derivatives(to_world, yaw, velocity),
        to_world,
        rate_derivatives(angles, rates),
        decay,
        compass_decay,
    )


class KalmanFilter:
    """State (10,) and covariance (10, 10) of dead reckoning; see ``transition`` for the state."""

    def __init__(
        self, config: DeadReckoningConfig, z: float, attitude: Sequence[float], variance: float
    ) -> None:
        self._take_over(config)
        self.state = [0.0, 0.0, z, *map(float, attitude), 0.0, 0.0, 0.0, 0.0]
        self._covariance = PairedCovariance()
        variances = [config.depth_noise**2, variance, variance, variance, *self._stationary]
        for index, known in enumerate(variances, start=Z):
            self._covariance.widen(index, known)

    def configure(self, config: DeadReckoningConfig) -> None:
        """Go on with other parameters; the estimated velocity stays as it is."""
        before = self._config.surge_speed
        self._take_over(config)
        self.state[VELOCITY_ERROR.start] += before - config.surge_speed

    def copy(self) -> Self:
        """Return a filter in the same state that goes its own way."""
        clone = copy(self)
        clone.state, clone._covariance = self.state.copy(), self._covariance.copy()
        return clone

    @property
    def covariance(self) -> Array:
        """The covariance (10, 10) of the state."""
        return self._covariance.matrix

    @property
    def velocity(self) -> Vector:
        """The estimated body velocity (3,) [m/s]."""
        surge, sway, heave = self.state[VELOCITY_ERROR]
        return self._config.surge_speed + surge, sway, heave

    def predict(
        self, interval: float, rates: Sequence[float], rate_noise: float, drift_noise: float = 0.0
    ) -> None:
        """Propagate over ``interval`` [s] with body ``rates`` (3,), equations 7 and 8.

        ``rate_noise`` is the angle random walk [rad/sqrt(s)] of the rates, ``drift_noise`` that of
        the place [m/sqrt(s)] beyond the slow error of the velocity.
        """
        if interval <= 0.0:
            return
        config = self._config
        decay = math.exp(-interval / config.velocity_correlation_time)
        compass_decay = math.exp(-interval / config.compass_correlation_time)
        self.state, derivatives = transition(
            self.state, config.surge_speed, rates, interval, (decay, compass_decay)
        )
        drift, turn = drift_noise**2 * interval, rate_noise**2 * interval
        renewed = 1.0 - decay**2
        surge, sway, heave = self._stationary
        compass = config.compass_drift**2 * (1.0 - compass_decay**2)
        speeds = (surge * renewed, sway * renewed, heave * renewed)
        noise = (drift, drift, 0.0, turn, turn, turn, *speeds, compass)
        self._covariance.predict(derivatives, noise)  # eq. 8

    def update(self, index: int, difference: float, variance: float) -> None:
        """Take in measurement minus prediction of one state, equations 9 and 10."""
        moved, gains = self._covariance.condition(index, variance)
        state = self.state
        for at, gain in zip(moved, gains, strict=True):
            state[at] += gain * difference

    def heading_gain(self, variance: float) -> float:
        """Return equation 10's gain of the yaw for a compass of this ``variance`` and its bias."""
        yaw, shared, _ = self._covariance.of_heading
        return (yaw + shared) / (self.spread(YAW) + variance)

    def update_heading(self, difference: float, variance: float, gain: float) -> None:
        """Let the yaw alone follow the compass by ``gain``; the covariance knows of its bias."""
        self.state[YAW] += gain * difference
        self._covariance.follow_heading(gain, variance)

    def spread(self, index: int) -> float:
        """Return the variance with which a measurement of the state is predicted."""
        if index != YAW:
            return self._covariance.variance(index)
        yaw, shared, bias = self._covariance.of_heading
        return yaw + bias + 2.0 * shared

    def open(self, index: int, difference: float) -> None:
        """Admit that one state may be wrong by ``difference``."""
        self._covariance.widen(index, difference**2)

    def _take_over(self, config: DeadReckoningConfig) -> None:
        self._config = config
        self._stationary = (config.surge_noise**2, config.sway_noise**2, config.heave_noise**2)
