# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The corrected pose with every odometry, and how far corrections have moved it."""

from collections import Counter
from collections.abc import Sequence
from math import dist

import numpy as np

from msss_graphslam.core.online_pose import OnlinePose
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.types import Array, MapCorrection, Odometry
from msss_graphslam.messages.link_decoding import StampedPose
from msss_graphslam.messages.refusal import Refusal

__all__ = ["CorrectedPose"]

# A correction that is older belongs to another run.
_LONGEST_AGE_NS = 600 * 1_000_000_000
# The last turn ends at a beam, which may be a little after the last odometry.
_FURTHEST_AHEAD_NS = 1_000_000_000


class CorrectedPose:
    """OnlinePose from the first odometry on; a correction that comes earlier waits for it."""

    def __init__(self, refused: Counter[str], persistence: Persistence) -> None:
        self._refused = refused
        self._persistence = persistence
        self.corrections = 0
        self.last_jump = 0.0
        self.largest_jump = 0.0
        self._online: OnlinePose | None = None
        self._odometry: Odometry | None = None
        self._waiting: MapCorrection | None = None
        self._corrected_ns = -(2**62)

    def remember(self, poses: Sequence[StampedPose]) -> None:
        """Take over the poses in ``odom`` of an earlier process."""
        for placed in poses:
            self._follow(_remembered(placed))

    def correct(self, correction: MapCorrection) -> None:
        """Start anew from the correction; raises Refusal for one that does not fit."""
        if self._online is None or self._odometry is None:
            self._waiting = correction
            return
        if correction.stamp_ns <= self._corrected_ns:
            raise Refusal("correction_not_newer")
        age_ns = self._odometry.stamp_ns - correction.stamp_ns
        if not -_FURTHEST_AHEAD_NS <= age_ns <= _LONGEST_AGE_NS:
            raise Refusal("correction_of_another_time")
        before = self._pose(self._online, self._odometry)
        self._online.correct(correction)
        after = self._pose(self._online, self._odometry)
        self._corrected_ns = correction.stamp_ns
        self.corrections += 1
        self.last_jump = dist(before[:2], after[:2])
        self.largest_jump = max(self.largest_jump, self.last_jump)

    def at(self, odometry: Odometry) -> tuple[Array, Array]:
        """Return the pose (6,) in ``map`` at the odometry's stamp and its covariance (6, 6)."""
        online = self._follow(odometry)
        self._take_waiting()
        return self._pose(online, odometry), online.covariance(odometry)

    def _follow(self, odometry: Odometry) -> OnlinePose:
        if self._online is None:
            self._online = OnlinePose(odometry, self._persistence)
        self._odometry = odometry
        self._pose(self._online, odometry)
        return self._online

    def _take_waiting(self) -> None:
        correction, self._waiting = self._waiting, None
        if correction is None:
            return
        try:
            self.correct(correction)
        except Refusal as refusal:
            self._refused[refusal.reason] += 1

    def _pose(self, online: OnlinePose, odometry: Odometry) -> Array:
        return online.at(odometry, odometry.stamp_ns)


def _remembered(placed: StampedPose) -> Odometry:
    nothing = np.zeros((6, 6))
    return Odometry(placed.stamp_ns, placed.pose, nothing, np.zeros(6), nothing)
