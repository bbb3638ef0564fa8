# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the sonar tells of the vehicle's velocity, fed back into the next turn's layout."""

# Deviation: not in the paper. Without a DVL the assumed speed is wrong for minutes; the corrected
# trajectory of the turns so far knows better.

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["MotionFeedback", "offset_motion"]


class MotionFeedback:
    """Kalman filter of the dead reckoning's twist error: surge, sway [m/s], yaw rate [rad/s].

    The error is a Gauss-Markov process with the given correlation time [s]; its stationary
    covariance is what dead reckoning says of itself.
    """

    def __init__(self, correlation_time: float) -> None:
        self._correlation_time = correlation_time
        self.offset = np.zeros(3)
        self.covariance = np.zeros((3, 3))
        self._predicted: tuple[Array, Array] | None = None

    def predict(self, interval: float, stationary: Array) -> None:
        """Let ``interval`` [s] pass; ``stationary`` (3, 3) is the error's a-priori covariance."""
        decay = float(np.exp(-interval / self._correlation_time)) if self._predicted else 0.0
        self.offset = decay * self.offset
        self.covariance = decay**2 * self.covariance + (1.0 - decay**2) * stationary
        self._predicted = self.offset, self.covariance

    def update(self, offset: Array, covariance: Array) -> None:
        """Take in a twist error (3,) that a pair of keyframes showed, with its covariance.

        Takes the place of an earlier update since the last prediction.
        """
        if self._predicted is None:
            raise ValueError("a motion feedback is updated before its first prediction")
        predicted, spread = self._predicted
        gain = spread @ np.linalg.inv(spread + covariance)
        self.offset = predicted + gain @ (offset - predicted)
        updated = (np.eye(3) - gain) @ spread
        self.covariance = 0.5 * (updated + updated.T)


def offset_motion(motion: Array, elapsed: Array, offset: Array) -> Array:
    """Return the motion (b, 3) with a constant twist error (3,) taken out; ``elapsed`` (b,) [s].

    Every step between beams is composed with ``offset`` times its duration, as in equation 14.
    """
    durations = np.diff(elapsed, prepend=elapsed[0])
    turned = offset[2] * np.concatenate([elapsed[:1], elapsed[:-1]])
    reckoned = motion[:, 0] + 1j * motion[:, 1]
    steps = np.diff(reckoned, prepend=reckoned[0])
    drift = (offset[0] + 1j * offset[1]) * durations * np.exp(1j * motion[:, 2])
    position = reckoned[0] + np.cumsum(np.exp(1j * turned) * (steps + drift))
    return np.column_stack([position.real, position.imag, motion[:, 2] + offset[2] * elapsed])
