# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the sonar tells of the vehicle's velocity, fed back into the next turn's layout."""

# Deviation: not in the paper. Without a DVL the assumed speed is wrong for minutes; the corrected
# trajectory of the turns so far knows better.

from dataclasses import dataclass

import numpy as np

from msss_graphslam.config.groups import DeadReckoning
from msss_graphslam.core.types import Array

__all__ = ["MotionFeedback", "Persistence", "offset_motion", "persistence_of"]


@dataclass(frozen=True, slots=True)
class Persistence:
    """How much of a twist error of one turn is still there in the next.

    Only the part that changes slowly is, within ``correlation_time`` [s]: its variances ``slow``
    (3,) of surge, sway [m^2/s^2] and yaw rate [rad^2/s^2]. What dead reckoning doubts beyond that,
    as without a gyro or without any sensor of motion, is new in every turn.
    """

    correlation_time: float
    slow: Array

    def over(self, interval: float, covariance: Array) -> Array:
        """Return the share (3,) that outlasts ``interval`` [s] of an error's covariance (3, 3)."""
        variances = np.maximum(np.diag(covariance), np.finfo(float).tiny)
        decay = np.exp(-interval / self.correlation_time)
        return np.asarray(decay * np.minimum(self.slow, variances) / variances)


def persistence_of(config: DeadReckoning) -> Persistence:
    """Return the persistence that dead reckoning's parameters state."""
    deviations = np.array([config.surge_noise, config.sway_noise, config.gyro_bias])
    return Persistence(config.velocity_correlation_time, deviations**2)


class MotionFeedback:
    """Kalman filter of the dead reckoning's twist error: surge, sway [m/s], yaw rate [rad/s].

    The error is a Gauss-Markov process with the given persistence; its stationary covariance is
    what dead reckoning says of itself.
    """

    def __init__(self, persistence: Persistence) -> None:
        self._persistence = persistence
        self.offset = np.zeros(3)
        self.covariance = np.zeros((3, 3))
        self._predicted: tuple[Array, Array] | None = None

    def predict(self, interval: float, stationary: Array) -> None:
        """Let ``interval`` [s] pass; ``stationary`` (3, 3) is the error's a-priori covariance."""
        kept = np.zeros(3)
        if self._predicted:
            kept = self._persistence.over(interval, stationary)
        self.offset = kept * self.offset
        self.covariance = stationary + np.outer(kept, kept) * (self.covariance - stationary)
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
