# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the sonar tells of the vehicle's velocity, fed back into the next turn's layout."""

# Deviation: not in the paper. Without a DVL the assumed speed is wrong for minutes; the corrected
# trajectory of the turns so far knows better.

import math
from dataclasses import dataclass

import numpy as np

from msss_graphslam.config.groups import DeadReckoning
from msss_graphslam.core.types import Array, TwistError

__all__ = ["MotionFeedback", "Persistence", "offset_motion", "persistence_of"]

SHORT = 1e-3
"""Share of the correlation time in which an error stays what it is."""

MEMORY = 10.0
"""Turns that show how unsteady the speed is: few enough to follow it, enough to average."""

_VELOCITY = np.array([1.0, 1.0, 0.0])


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
        """Return what is left (3,) of an error of this covariance (3, 3) in the next turn.

        Errors are means over turns of ``interval`` [s] each, which are more alike than the
        process at their beginnings.
        """
        variances = np.maximum(np.diag(covariance), np.finfo(float).tiny)
        kept = _likeness(interval / self.correlation_time)
        return np.asarray(kept * np.minimum(self.slow, variances) / variances)

    def mean_over(self, interval: float, covariance: Array) -> Array:
        """Return the covariance (3, 3) of an error's mean over ``interval`` [s].

        ``covariance`` (3, 3) is the error's at the beginning; it returns to ``slow`` meanwhile.
        """
        share = interval / self.correlation_time
        if share < SHORT:
            return covariance
        first = -math.expm1(-share) / share
        grown = max(2.0 * (1.0 - first) / share - first**2, 0.0)
        return first**2 * covariance + np.diag(grown * self.slow)


def persistence_of(config: DeadReckoning) -> Persistence:
    """Return the persistence that dead reckoning's parameters state."""
    deviations = np.array([config.surge_noise, config.sway_noise, config.gyro_bias])
    return Persistence(config.velocity_correlation_time, deviations**2)


def _likeness(share: float) -> float:
    """Return the correlation of a Gauss-Markov process' means over two turns, one after another.

    A turn lasts ``share`` of the correlation time.
    """
    if share < SHORT:
        return 1.0 - 2.0 * share / 3.0
    lost = -math.expm1(-share)
    return lost**2 / (2.0 * (share - lost))


class MotionFeedback:
    """Kalman filter of the dead reckoning's twist error: surge, sway [m/s], yaw rate [rad/s].

    The error is a Gauss-Markov process with the given persistence; its stationary covariance is
    what dead reckoning says of itself, or more: where turn after turn shows a speed that changes
    by more than that, its variances grow by ``unsteadiness`` (3,), never less than 1.
    """

    # What dead reckoning says is a parameter, and how unsteady a vehicle is nobody knows before.
    # Too small, it makes good matches lie too far from their guess, and what they show is lost.

    def __init__(self, persistence: Persistence) -> None:
        self._persistence = persistence
        self.offset = np.zeros(3)
        self.covariance = np.zeros((3, 3))
        self._predicted: tuple[Array, Array] | None = None
        self._stated = np.zeros((3, 3))
        self._interval = 0.0
        self._shared = np.zeros((3, 3))
        self.unsteadiness = self._unsteady_before = np.ones(3)

    def predict(self, interval: float, stationary: Array) -> None:
        """Let ``interval`` [s] pass; ``stationary`` (3, 3) is the error's a-priori covariance."""
        kept = np.zeros(3)
        if self._predicted:
            kept = self._persistence.over(interval, stationary)
            before = self._predicted[1] + np.finfo(float).tiny * np.eye(3)
            still_open = np.linalg.solve(before, self.covariance)
            shared = self._shared @ still_open + self._interval * self.covariance
            self._shared = shared * kept
        self._stated, self._interval = stationary, interval
        self._unsteady_before = self.unsteadiness
        stationary = self._stationary()
        self.offset = kept * self.offset
        self.covariance = stationary + np.outer(kept, kept) * (self.covariance - stationary)
        self._predicted = self.offset, self.covariance

    def ahead(self) -> TwistError:
        """Return the error to be expected in the turn after the one that was predicted."""
        kept = self._kept_ahead()
        stationary = self._stationary()
        grown = stationary + np.outer(kept, kept) * (self.covariance - stationary)
        return TwistError(kept * self.offset, grown)

    def followed(self) -> Array:
        """Return the share (3,) of what the last update showed that goes into the next turn."""
        if self._predicted is None:
            return np.zeros(3)
        before = np.maximum(np.diag(self._predicted[1]), np.finfo(float).tiny)
        return self._kept_ahead() * (1.0 - np.diag(self.covariance) / before)

    def coherent(self) -> Array:
        """Return the predicted covariance (3, 3), what it shares with the turns before added.

        While the sonar shows nothing, the same error acts turn after turn. Edges of a graph are
        independent; that of a turn has to bring along what it has in common with those before.
        """
        if self._interval <= 0.0:
            return self.covariance
        together = self.covariance + (self._shared + self._shared.T) / self._interval
        values, vectors = np.linalg.eigh(together)
        return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T)

    def _kept_ahead(self) -> Array:
        if not self._stated.any():
            return np.zeros(3)
        return self._persistence.over(self._interval, self._stated)

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
        self._learn_unsteadiness(offset - predicted, np.diag(spread), np.diag(covariance))

    def _learn_unsteadiness(self, surprise: Array, expected: Array, doubt: Array) -> None:
        """Take in by how much an error (3,) surprised, as far as its match could tell.

        ``expected`` (3,) are its variances before the match, ``doubt`` (3,) those of the match.
        The yaw rate's error is that of a gyro, which has no such moods.
        """
        ratio = surprise**2 / (expected + doubt)
        told = _VELOCITY * expected / (expected + doubt)
        grown = self._unsteady_before * (1.0 + told * (ratio - 1.0) / MEMORY)
        self.unsteadiness = np.maximum(grown, 1.0)

    def _stationary(self) -> Array:
        """Return the error's covariance (3, 3) of which nothing is known."""
        growth = np.sqrt(self.unsteadiness)
        return np.asarray(np.outer(growth, growth) * self._stated)


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
