# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The extended Kalman filter of dead reckoning as a textbook has it, in whole matrices."""

import numpy as np
from numerical_derivatives import jacobian

from msss_graphslam.config.groups import DeadReckoning
from msss_graphslam.core.reckoning.kalman_filter import transition
from msss_graphslam.core.types import Array

SIZE, YAW, BIAS = 10, 5, 9


def decays_of(config: DeadReckoning, interval: float) -> tuple[float, float]:
    times = config.velocity_correlation_time, config.compass_correlation_time
    return float(np.exp(-interval / times[0])), float(np.exp(-interval / times[1]))


def moved(config: DeadReckoning, state: Array, rates: Array, interval: float) -> Array:
    decays = decays_of(config, interval)
    return np.array(transition(state.tolist(), config.surge_speed, rates, interval, decays)[0])


class TextbookFilter:
    """F by differences of the process model, Joseph's form for every update."""

    def __init__(self, config: DeadReckoning, state: Array, covariance: Array) -> None:
        self._config = config
        self.state, self.covariance = state.copy(), covariance.copy()

    def predict(self, interval: float, rates: Array, rate_noise: float, drift: float) -> None:
        config = self._config
        velocity_decay, compass_decay = decays_of(config, interval)
        F = jacobian(lambda at: moved(config, at, rates, interval), self.state)
        F[2, 3:8] = F[:2, 8] = F[YAW, 3:5] = 0.0
        F[BIAS, BIAS] = compass_decay
        Q = np.zeros(SIZE)
        Q[:2] = drift**2 * interval
        Q[3:6] = rate_noise**2 * interval
        stationary = np.square([config.surge_noise, config.sway_noise, config.heave_noise])
        Q[6:9] = stationary * (1.0 - velocity_decay**2)
        Q[BIAS] = config.compass_drift**2 * (1.0 - compass_decay**2)
        self.state = moved(config, self.state, rates, interval)
        self.covariance = F @ self.covariance @ F.T + np.diag(Q)

    def update(self, index: int, difference: float, variance: float) -> None:
        H = np.eye(SIZE)[index : index + 1]
        spread = H @ self.covariance @ H.T + variance
        self._correct(self.covariance @ H.T / spread, H, difference, variance)

    def update_heading(self, difference: float, variance: float, gain: float) -> None:
        H, K = np.zeros((1, SIZE)), np.zeros((SIZE, 1))
        H[0, [YAW, BIAS]], K[YAW] = 1.0, gain
        self._correct(K, H, difference, variance)

    def _correct(self, K: Array, H: Array, difference: float, variance: float) -> None:
        kept = np.eye(SIZE) - K @ H
        self.state = self.state + K[:, 0] * difference
        self.covariance = kept @ self.covariance @ kept.T + variance * K @ K.T
