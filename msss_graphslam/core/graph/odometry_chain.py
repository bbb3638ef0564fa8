# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the consecutive edges alone say of where two keyframes lie to each other."""

# Deviation: the paper takes every closure that has passed Section VI. A few that are wrong in the
# same way, as two corners that look alike make them, can outvote any robust kernel; the way from
# keyframe to keyframe knows of no closure and cannot be outvoted.

import numpy as np

from msss_graphslam.core.compounding import between, compose, planar_rotation, wrap
from msss_graphslam.core.types import Array, Constraint

__all__ = ["OdometryChain"]


class OdometryChain:
    """The keyframes' poses by consecutive edges, with the covariance between any two of them.

    To first order an edge's error moves all that follows as a rigid body. Told as a motion about
    the origin, such errors add up along the chain, so that the covariance between two keyframes is
    the difference of two sums, at the same cost for near and far ones.
    """

    def __init__(self) -> None:
        self._poses = [np.zeros(3)]
        self._sums = [np.zeros((3, 3))]
        self._pieces = [0]

    def append(self, edge: Constraint | None) -> None:
        """Add a keyframe by its edge from the one before; None where there is no such edge."""
        if edge is None:
            self._poses.append(np.zeros(3))
            self._sums.append(np.zeros((3, 3)))
            self._pieces.append(self._pieces[-1] + 1)
            return
        pose = compose(self._poses[-1], edge.relative_pose)
        turned = _about_origin(pose[:2]) @ planar_rotation(float(self._poses[-1][2]))
        self._poses.append(pose)
        self._sums.append(self._sums[-1] + turned @ edge.covariance @ turned.T)
        self._pieces.append(self._pieces[-1])

    def cut(self, count: int) -> None:
        """Keep the first ``count`` keyframes."""
        del self._poses[count:], self._sums[count:], self._pieces[count:]

    def __len__(self) -> int:
        return len(self._poses)

    def displacement(self, first: int, second: int) -> tuple[Array, Array] | None:
        """Return the pose (3,) of ``second`` in ``first`` and its covariance (3, 3).

        None where the chain is broken between them. The covariance is in the axes of ``first``.
        """
        if self._pieces[first] != self._pieces[second]:
            return None
        pose, other = self._poses[first], self._poses[second]
        turned = planar_rotation(float(pose[2])).T @ _about_origin(-other[:2])
        spread = turned @ (self._sums[second] - self._sums[first]) @ turned.T
        return between(pose, other), spread

    def squared_distance(self, edge: Constraint, slack: Array) -> float:
        """Return the squared Mahalanobis distance of a closure from the chain, 0 if none is known.

        ``slack`` (3, 3) is allowed beside the covariances of edge and chain.
        """
        known = self.displacement(edge.first, edge.second)
        if known is None:
            return 0.0
        off = edge.relative_pose - known[0]
        off[2] = wrap(off[2])
        return float(off @ np.linalg.solve(known[1] + edge.covariance + slack, off))


def _about_origin(point: Array) -> Array:
    """Return what tells a small motion at a point (2,) as one about the origin (3, 3)."""
    moved = np.eye(3)
    moved[:2, 2] = point[1], -point[0]
    return moved
