# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Poses at every beam: dead reckoned, as published at the time, and corrected in the end."""

from itertools import pairwise

import numpy as np

from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.history import DeadReckoningHistory
from msss_graphslam.core.motion_feedback import offset_motion
from msss_graphslam.core.trajectory_correction import Solver, correct_motion
from msss_graphslam.core.types import Array, Stamps, Trajectory

__all__ = ["BeamLog"]


class BeamLog:
    """One row a beam, in the order of their stamps."""

    def __init__(self) -> None:
        self._stamps: list[int] = []
        self._reckoned: list[Array] = []
        self._online: list[tuple[int, Array]] = []

    def add(self, stamp_ns: int, online: Array | None) -> None:
        """Note a beam and the pose (6,) that a subscriber had at the time, None for no pose."""
        self._stamps.append(stamp_ns)
        if online is not None:
            self._online.append((stamp_ns, online))

    def resolve(self, history: DeadReckoningHistory) -> None:
        """Look up the dead reckoning of the beams that have come since the last call."""
        new = np.array(self._stamps[sum(map(len, self._reckoned)) :], dtype=np.int64)
        if new.size:
            self._reckoned.append(history.poses_at(new))

    @property
    def stamps(self) -> Stamps:
        """The beams' stamps (n,)."""
        return np.array(self._stamps, dtype=np.int64)

    @property
    def online(self) -> Trajectory:
        """What a subscriber got at the time."""
        stamps = np.array([stamp_ns for stamp_ns, _ in self._online], dtype=np.int64)
        return Trajectory(stamps, np.array([pose for _, pose in self._online]).reshape(-1, 6))

    @property
    def dead_reckoning(self) -> Trajectory:
        """The EKF's poses."""
        return Trajectory(self.stamps, np.concatenate([np.empty((0, 6)), *self._reckoned]))

    def corrected(
        self, keyframe_stamps: Stamps, keyframe_poses: Array, solver: Solver, offset: Array
    ) -> Trajectory:
        """Return the corrected history CDRH of all turns: Section VII, keyframe to keyframe.

        ``keyframe_stamps`` (k,) are stamps of beams, ``keyframe_poses`` (k, 3) their optimised
        poses in ``map``. Before the first keyframe dead reckoning stands as it is; after the last
        it goes on with the twist error ``offset`` (3,) taken out.
        """
        reckoned = self.dead_reckoning
        planar = reckoned.planar.copy()
        starts = np.searchsorted(self.stamps, keyframe_stamps)
        for number, (start, stop) in enumerate(pairwise(starts)):
            origin = planar[start]
            planar[start:stop] = compose(
                keyframe_poses[number],
                correct_motion(
                    between(origin, reckoned.planar[start:stop]),
                    between(origin, reckoned.planar[stop]),
                    between(keyframe_poses[number], keyframe_poses[number + 1]),
                    solver,
                ).poses,
            )
        if len(starts):
            rest = slice(starts[-1], None)
            motion = between(reckoned.planar[starts[-1]], reckoned.planar[rest])
            elapsed = (self.stamps[rest] - self.stamps[starts[-1]]) * 1e-9
            planar[rest] = compose(keyframe_poses[-1], offset_motion(motion, elapsed, offset))
        poses = reckoned.poses.copy()
        poses[:, [0, 1, 5]] = planar
        return Trajectory(self.stamps, poses)
