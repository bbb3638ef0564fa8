# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The corrected pose as it can be published at any time, from what is known until then."""

import cmath

import numpy as np

from msss_graphslam.core.compounding import wrap_angle
from msss_graphslam.core.types import Array, Odometry

__all__ = ["OnlinePose"]


class OnlinePose:
    """Carries the last corrected pose on by dead reckoning, its known twist error taken out.

    Runs at the rate of the beams, so that planar vectors are complex numbers here: x + i y.
    """

    def __init__(self, first: Odometry) -> None:
        """Start where dead reckoning starts: ``map`` and ``odom`` are the same until anchored."""
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

    def at(self, odometry: Odometry, stamp_ns: int) -> Array:
        """Return the pose (6,) in ``map`` at ``stamp_ns``, not before the odometry's stamp."""
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
