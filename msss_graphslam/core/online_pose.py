# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The corrected pose as it can be published at any time, from what is known until then."""

import cmath

import numpy as np

from msss_graphslam.core.compounding import between, compose_covariance, wrap_angle
from msss_graphslam.core.scans.history import DeadReckoningHistory
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.types import Array, MapCorrection, Odometry

__all__ = ["OnlinePose"]

_PLANAR = [0, 1, 5]
_MEMORY = 6000
"""Odometry kept for a correction that comes late: two minutes of a fast IMU."""

_SHARES = np.linspace(0.0, 1.0, 9)[1:]
"""Where the way since the correction is looked at for its covariance."""

_BLOCK = np.ix_(_PLANAR, _PLANAR)


class OnlinePose:
    """Carries the last corrected pose on by dead reckoning, its known twist error taken out.

    Runs at the rate of the beams, so that planar vectors are complex numbers here: x + i y.
    """

    def __init__(self, first: Odometry, persistence: Persistence) -> None:
        """Start where dead reckoning starts: ``map`` and ``odom`` are the same until anchored.

        ``persistence`` is that of dead reckoning's twist error.
        """
        self._persistence = persistence
        self._recent = DeadReckoningHistory()
        self._recent.append(first)
        self._correction: MapCorrection | None = None
        self.anchor(first.planar, first.planar, first.stamp_ns, np.zeros(3))

    def anchor(self, pose: Array, odometry: Array, stamp_ns: int, offset: Array) -> None:
        """Start anew from a corrected ``pose`` (3,) in ``map``.

        ``odometry`` (3,) is dead reckoning's pose then, in ``odom``; ``offset`` (3,) the error of
        its twist: surge, sway [m/s] and yaw rate [rad/s].
        """
        self._position, self._yaw = complex(pose[0], pose[1]), float(pose[2])
        self._reckoned, self._reckoned_yaw = complex(odometry[0], odometry[1]), float(odometry[2])
        self._stamp_ns = stamp_ns
        self._drift, self._turn = complex(offset[0], offset[1]), float(offset[2])

    def remember(self, odometry: Odometry) -> None:
        """Note odometry that a correction may have to catch up with, as ``at`` does itself."""
        self._recent.append(odometry)
        if len(self._recent) > 2 * _MEMORY:
            self._recent.keep_last(_MEMORY)

    def correct(self, correction: MapCorrection) -> None:
        """Start anew from what a scan has shown, which ended a moment ago, and catch up."""
        self._correction = correction
        reckoned = self._recent.poses_at(np.array([correction.stamp_ns]))[0]
        self.anchor(
            correction.pose, reckoned[[0, 1, 5]], correction.stamp_ns, correction.twist_error.mean
        )
        self._recent.forget_before(correction.stamp_ns)
        for entry in self._recent.since(correction.stamp_ns):
            self._advance(entry)

    def covariance(self, odometry: Odometry) -> Array:
        """Return the covariance (6, 6) of the pose at the odometry's stamp.

        That of dead reckoning until a scan has said more; then the correction's, with the twist
        error that has acted since.
        """
        spread = odometry.covariance.copy()
        correction = self._correction
        if correction is None:
            return spread
        elapsed = max((odometry.stamp_ns - correction.stamp_ns) * 1e-9, 0.0)
        now = np.array([self._position.real, self._position.imag, self._yaw])
        motion = between(correction.pose, now)
        twist = self._persistence.mean_over(elapsed, correction.twist_error.covariance)
        drift = _drift_covariance(motion, elapsed, twist)
        spread[_PLANAR] = 0.0
        spread[:, _PLANAR] = 0.0
        spread[_BLOCK] = compose_covariance(correction.pose, correction.covariance, motion, drift)
        return spread

    def at(self, odometry: Odometry, stamp_ns: int) -> Array:
        """Return the pose (6,) in ``map`` at ``stamp_ns``, not before the odometry's stamp."""
        self.remember(odometry)
        self._advance(odometry)
        ahead = (stamp_ns - odometry.stamp_ns) * 1e-9
        velocity = complex(odometry.twist[0], odometry.twist[1]) + self._drift
        position = self._position + cmath.rect(ahead, self._yaw) * velocity
        pose = odometry.pose.copy()
        pose[0], pose[1] = position.real, position.imag
        pose[5] = wrap_angle(self._yaw + ahead * (float(odometry.twist[5]) + self._turn))
        return pose

    def _advance(self, odometry: Odometry) -> None:
        interval = (odometry.stamp_ns - self._stamp_ns) * 1e-9
        if interval <= 0.0:
            return
        x, y, _, _, _, yaw = odometry.pose.tolist()
        reckoned = complex(x, y)
        step = (reckoned - self._reckoned) * cmath.rect(1.0, self._yaw - self._reckoned_yaw)
        self._yaw += yaw - self._reckoned_yaw
        self._position += step + cmath.rect(interval, self._yaw) * self._drift
        self._yaw += interval * self._turn
        self._reckoned, self._reckoned_yaw = reckoned, yaw
        self._stamp_ns = odometry.stamp_ns


def _drift_covariance(motion: Array, elapsed: float, twist_covariance: Array) -> Array:
    """Return the covariance (3, 3) of a steady ``motion`` (3,) that took ``elapsed`` [s].

    That is ``motion_covariances`` of equal steps for the last of them alone: it is wanted for
    every pose that is published.
    """
    x, y, yaw = motion.tolist()
    turn = np.exp(1j * yaw * _SHARES).mean()
    reach = float(_SHARES.mean())
    derivative = elapsed * np.array(
        [[turn.real, -turn.imag, -reach * y], [turn.imag, turn.real, reach * x], [0.0, 0.0, 1.0]]
    )
    return np.asarray(derivative @ twist_covariance @ derivative.T)
