# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the sonar tells of the vehicle's velocity, fed back into the next turn's layout."""

# Deviation: not in the paper. Without a DVL the assumed speed is wrong for minutes; the corrected
# trajectory of the turns so far knows better.

import numpy as np

from msss_graphslam.core.scans.noise_scale import NoiseScale
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.types import Array, TwistError

__all__ = ["MotionFeedback", "offset_motion"]


class MotionFeedback:
    """Kalman filter of the dead reckoning's twist error: surge, sway [m/s], yaw rate [rad/s].

    The error is a Gauss-Markov process with the given persistence; its stationary covariance is
    what dead reckoning says of itself, the slow part as large as the turns so far have shown.
    """

    def __init__(self, persistence: Persistence) -> None:
        self._persistence = persistence
        self.offset = np.zeros(3)
        self.covariance = np.zeros((3, 3))
        self._noise = NoiseScale()
        self._shown: tuple[Array, Array] | None = None
        self._between: Array | None = None
        self._predicted: tuple[Array, Array] | None = None
        self._stationary = np.zeros((3, 3))
        self._interval = 0.0
        self._shared = np.zeros((3, 3))

    def predict(self, interval: float, stationary: Array) -> None:
        """Let ``interval`` [s] pass; ``stationary`` (3, 3) is the error's a-priori covariance."""
        self._hear_noise()
        stationary = self._noise.applied(stationary, self._persistence.slow)
        kept = np.zeros(3)
        if self._predicted:
            kept = self._lasting.over(interval, stationary)
            before = self._predicted[1] + np.finfo(float).tiny * np.eye(3)
            still_open = np.linalg.solve(before, self.covariance)
            shared = self._shared @ still_open + self._interval * self.covariance
            self._shared = shared * kept
        self.offset = kept * self.offset
        self.covariance = stationary + np.outer(kept, kept) * (self.covariance - stationary)
        self._predicted = self.offset, self.covariance
        self._stationary, self._interval = stationary, interval
        self._shown = None

    def ahead(self) -> TwistError:
        """Return the error to be expected in the turn after the one that was predicted."""
        return TwistError(self._kept_ahead() * self.offset, self._grown(self.covariance))

    def newest(self) -> TwistError:
        """Return the error of the turn after the one that was predicted, by all that is known."""
        if self._shown is None:
            return self.ahead()
        return TwistError(self.ahead().mean, self.after_match())

    def beside_match(self) -> Array:
        """Return the covariance (3, 3) of the newest turn's error that a match of it suffers from.

        Both turns are laid out by the twist that the match shows. What their errors have in
        common is thereby taken out, as far as it is followed; the rest is what is new. The match
        shows the mean from the middle of one turn to the other's. From that the first turn's own
        mean is off by the changes X from its first half to its second and Y from there to the
        next, and by half of X again as far as the newest turn does not follow. Of an error that
        drifts, so that X and Y are a quarter alike, c X + Y varies as ``drift`` says, if the
        change from one turn to the next varies by one.
        """
        if self._predicted is None:
            return self.covariance
        before = self._predicted[1]
        left, change = self._kept_ahead() - self.followed(), 1.5 - 0.5 * self.followed()
        drift = np.sqrt(0.5 * (change**2 + 0.5 * change + 1.0))
        new = np.outer(drift, drift) * self._grown(np.zeros((3, 3)))
        return np.asarray(new + np.outer(left, left) * before)

    def after_match(self) -> Array:
        """Return the covariance (3, 3) of the newest turn's error once a match laid it out.

        With w' = k w + q the newest turn's error, the last one's and what is new, a scan's layout
        moving its points half as far as its end, and the share f of the error e that the match
        shows followed in the newest turn, the match shows (1 + f) e = (1 + k) w + q + 2 n, n its
        noise. That leaves w' - f e, whose variance is what stands here.
        """
        kept, followed = self._kept_ahead(), self.followed()
        share = 1.0 / (1.0 + followed)
        beside = share * np.sqrt(np.maximum(1.0 - followed**2, 0.0))
        learned = 2.0 * share * np.sqrt(np.maximum(kept * followed, 0.0))
        return np.asarray(
            np.outer(beside, beside) * self.beside_match()
            + np.outer(learned, learned) * self.covariance
        )

    def followed(self) -> Array:
        """Return the share (3,) of what the last update showed that goes into the next turn."""
        return self._kept_ahead() * self._learned()

    def guessed(self) -> Array:
        """Return the predicted covariance (3, 3) by which a guess is searched for and judged.

        That a vehicle has gone steadily does not keep it from turning away: no surer than assumed.
        """
        roots = 1.0 / np.sqrt(np.minimum(self._noise.factors, 1.0))
        return np.asarray(np.outer(roots, roots) * self.covariance)

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

    def _learned(self) -> Array:
        """Return the share (3,) of the predicted variances that the last update took away."""
        if self._predicted is None:
            return np.zeros(3)
        before = np.maximum(np.diag(self._predicted[1]), np.finfo(float).tiny)
        return np.asarray(1.0 - np.diag(self.covariance) / before)

    def _grown(self, covariance: Array) -> Array:
        """Return what an error of this covariance (3, 3) grows to in the turn after."""
        kept = self._kept_ahead()
        return self._stationary + np.outer(kept, kept) * (covariance - self._stationary)

    def _kept_ahead(self) -> Array:
        if not self._stationary.any():
            return np.zeros(3)
        return self._lasting.over(self._interval, self._stationary)

    @property
    def _lasting(self) -> Persistence:
        return self._persistence.scaled(self._noise.larger, self._noise.longer)

    def _hear_noise(self) -> None:
        """Let the change from the last match to this one tell how large errors are to be expected.

        The first scan of a match was laid out by the error that it showed, the second one by what
        of it was followed: together they show the mean from the middle of one turn to the other's.
        """
        before, self._between = self._between, None
        if self._shown is None or self._predicted is None:
            return
        offset, doubt = self._shown
        self._between = 0.5 * (offset + self.ahead().mean)
        if before is not None:
            noise = 2.0 * np.diag(doubt - 0.25 * self.beside_match())
            self._noise = self._noise.with_shown(
                (self._between - before) ** 2, *self._expected(np.maximum(noise, 0.0))
            )

    def _expected(self, noise: Array) -> tuple[Array, Array]:
        """Return the variances (3,) of that change, noise added, and the slow error's shares.

        Along a bare wall a match is nothing but noise, and tells nothing of the slow error.
        """
        variances = np.diag(self._stationary)
        slow = np.minimum(variances, self._lasting.slow)
        drifting = 2.0 * (slow - self._kept_ahead() * variances)
        stated = np.maximum(drifting + 2.0 * (variances - slow) + noise, np.finfo(float).tiny)
        return stated, np.maximum(drifting, 0.0) / stated

    def update(self, offset: Array, covariance: Array) -> None:
        """Take in a twist error (3,) that a pair of keyframes showed, with its covariance.

        Takes the place of an earlier update since the last prediction.
        """
        if self._predicted is None:
            raise ValueError("a motion feedback is updated before its first prediction")
        self._shown = offset, covariance
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
