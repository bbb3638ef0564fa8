# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The corrected pose as it can be published at any time, from what is known until then."""

import numpy as np

from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.types import Array, Odometry

__all__ = ["OnlinePose"]


class OnlinePose:
    """Carries the last corrected pose on by dead reckoning, its known twist error taken out."""

    def __init__(self) -> None:
        self._pose: Array | None = None
        self._odometry = np.zeros(3)
        self._stamp_ns = 0
        self._offset = np.zeros(3)

    def anchor(self, pose: Array, odometry: Array, stamp_ns: int, offset: Array) -> None:
        """Start anew from a corrected ``pose`` (3,) in ``map``.

        ``odometry`` (3,) is dead reckoning's pose then, in ``odom``; ``offset`` (3,) the error of
        its twist.
        """
        self._pose, self._odometry = pose, odometry
        self._stamp_ns, self._offset = stamp_ns, offset

    def at(self, odometry: Odometry, stamp_ns: int) -> Array:
        """Return the pose (6,) in ``map`` at ``stamp_ns``, not before the odometry's stamp.

        Stamps may not go back between calls but by an ``anchor``.
        """
        planar = self._advance(odometry)
        ahead = (stamp_ns - odometry.stamp_ns) * 1e-9
        planar = compose(planar, (odometry.twist[[0, 1, 5]] + self._offset) * ahead)
        pose = odometry.pose.copy()
        pose[[0, 1, 5]] = planar
        return pose

    def _advance(self, odometry: Odometry) -> Array:
        if self._pose is None:
            self.anchor(odometry.planar, odometry.planar, odometry.stamp_ns, self._offset)
        interval = (odometry.stamp_ns - self._stamp_ns) * 1e-9
        if interval > 0.0:
            step = between(self._odometry, odometry.planar)
            pose = compose(self._pose, compose(step, self._offset * interval))
            self.anchor(pose, odometry.planar, odometry.stamp_ns, self._offset)
        return np.asarray(self._pose)
