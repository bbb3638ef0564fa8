# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Poses at every beam: dead reckoned, as published at the time, and corrected in the end."""

from array import array
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.scans.motion_feedback import offset_motion
from msss_graphslam.core.scans.trajectory_correction import Solver, correct_motion
from msss_graphslam.core.types import Array, Scan, Stamps, Trajectory

__all__ = ["BeamLog"]

PLANAR = [0, 1, 5]


class BeamLog:
    """One row a beam, in the order of their stamps."""

    def __init__(self) -> None:
        self._stamps: list[Stamps] = []
        self._reckoned: list[Array] = []
        self._online_stamps = array("q")
        self._online_poses = array("d")

    def add_scan(self, scan: Scan) -> None:
        """Note the beams of a turn and their dead reckoning."""
        self._stamps.append(scan.beam_stamps_ns)
        self._reckoned.append(scan.reckoned[:-1])

    def add_online(self, stamp_ns: int, pose: Array) -> None:
        """Note the pose (6,) that a subscriber had at ``stamp_ns``."""
        self._online_stamps.append(stamp_ns)
        self._online_poses.extend(pose.tolist())

    @property
    def online(self) -> Trajectory:
        """What a subscriber got at the time; no copy, nothing can be added while it is held."""
        stamps = np.asarray(self._online_stamps, dtype=np.int64)
        return Trajectory(stamps, np.asarray(self._online_poses).reshape(-1, 6))

    @property
    def dead_reckoning(self) -> Trajectory:
        """The EKF's poses."""
        stamps = np.concatenate([np.empty(0, dtype=np.int64), *self._stamps])
        return self.dead_reckoning_at(stamps)

    def dead_reckoning_at(self, stamps_ns: Stamps) -> Trajectory:
        """Return the EKF's poses with the stamps (n,) of all beams, which are not copied."""
        return Trajectory(stamps_ns, np.concatenate([np.empty((0, 6)), *self._reckoned]))

    def corrected(
        self, scans: Sequence[Scan], keyframe_poses: Array, solver: Solver, twist_error: Array
    ) -> Trajectory:
        """Return the corrected history CDRH of all turns: Section VII, keyframe to keyframe.

        ``scans`` are the keyframes', ``keyframe_poses`` (k, 3) their optimised poses in ``map``,
        of the first k at least. Before the first keyframe dead reckoning stands as it is; after
        the last it goes on with ``twist_error`` (3,) taken out.
        """
        reckoned = self.dead_reckoning
        # In place, interval by interval: none looks at what those before have corrected.
        stamps, poses = reckoned.stamps_ns, reckoned.poses
        first_stamps = [scan.stamp_ns for scan in scans[: len(keyframe_poses)]]
        starts = np.searchsorted(stamps, np.array(first_stamps, dtype=np.int64))
        for number, (start, stop) in enumerate(pairwise(starts)):
            before = poses[start : stop + 1, PLANAR]
            motion = between(before[0], before)
            target = between(keyframe_poses[number], keyframe_poses[number + 1])
            corrected = correct_motion(motion[:-1], motion[-1], target, solver).poses
            poses[start:stop, PLANAR] = compose(keyframe_poses[number], corrected)
        if len(starts):
            rest = slice(starts[-1], None)
            before = poses[rest, PLANAR]
            elapsed = (stamps[rest] - stamps[starts[-1]]) * 1e-9
            motion = offset_motion(between(before[0], before), elapsed, twist_error)
            poses[rest, PLANAR] = compose(keyframe_poses[-1], motion)
        return Trajectory(stamps, poses)
