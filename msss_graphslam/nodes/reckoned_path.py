# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The way that dead reckoning has come, in few poses however long it is."""

from collections import deque

import numpy as np

from msss_graphslam.core.types import Odometry, Trajectory

__all__ = ["ReckonedPath"]

_FINE = 100
_COARSE = 199
_FINE_PERIOD_NS = 1_000_000_000


class ReckonedPath:
    """Close poses of late, ever sparser ones of old, and always the newest: at most 300.

    The close ones let a node that was restarted place a correction in its history.
    """

    def __init__(self) -> None:
        self._coarse: list[Odometry] = []
        self._coarse_period_ns = _FINE_PERIOD_NS
        self._fine: deque[Odometry] = deque()
        self._newest: Odometry | None = None

    def add(self, odometry: Odometry) -> None:
        """Take in the next odometry; one that is not newer is left out."""
        if self._newest is not None and odometry.stamp_ns <= self._newest.stamp_ns:
            return
        self._newest = odometry
        if self._fine and odometry.stamp_ns - self._fine[-1].stamp_ns < _FINE_PERIOD_NS:
            return
        self._fine.append(odometry)
        if len(self._fine) > _FINE:
            self._keep_coarsely(self._fine.popleft())

    @property
    def trajectory(self) -> Trajectory:
        """The poses in the order of their stamps, the newest last."""
        entries = [*self._coarse, *self._fine]
        if self._newest is not None and self._newest is not entries[-1]:
            entries.append(self._newest)
        stamps = np.array([entry.stamp_ns for entry in entries], dtype=np.int64)
        return Trajectory(stamps, np.array([entry.pose for entry in entries]).reshape(-1, 6))

    def _keep_coarsely(self, odometry: Odometry) -> None:
        if self._coarse:
            since = odometry.stamp_ns - self._coarse[-1].stamp_ns
            if since < self._coarse_period_ns:
                return
        self._coarse.append(odometry)
        if len(self._coarse) > _COARSE:
            self._coarse = self._coarse[::2]
            self._coarse_period_ns *= 2
