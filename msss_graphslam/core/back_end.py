# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The back end: iSAM on the pose graph of equation 4 (gtsam's ISAM2).

M. Kaess et al., iSAM2: Incremental smoothing and mapping using the Bayes tree, IJRR 31, 2012
(the successor of the paper's [13]).
"""

from collections.abc import Sequence

import gtsam
import numpy as np

from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.compounding import compose, rotation
from msss_graphslam.core.constraint_defects import defect
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["BackEnd"]

LAUNCH_VARIANCE = 1e-12
"""The first pose defines the map; its prior only holds the gauge [m^2, rad^2]."""


class BackEnd:
    """Keyframes and accepted constraints in, optimised poses and covariances out.

    The constraints are kept in ``constraints``; the smoother is rebuilt from them after a failure.
    """

    def __init__(self, config: BackEndConfig) -> None:
        self._config = config
        self.constraints: list[Constraint] = []
        self._initial: list[Array] = []
        self._added = 0
        self._isam = _smoother()

    def add_keyframe(self, pose: Array) -> int:
        """Add a node with its first estimate (3,); return its number."""
        if not np.isfinite(pose).all():
            raise ValueError(f"pose of keyframe {len(self._initial)} is not finite: {pose}")
        self._initial.append(np.array(pose, dtype=float))
        return len(self._initial) - 1

    def take(self, pose: Array, tried: Sequence[Constraint]) -> tuple[Array, Array]:
        """Take in a keyframe; return all poses (n, 3) and the newest one's covariance (3, 3).

        ``tried`` are the constraints that end at it, of which the accepted ones count; the first
        keyframe of all has none and is put at its own ``pose`` (3,).
        """
        if not self._initial:
            self.add_keyframe(pose)
        poses = self.update([entry for entry in tried if entry.accepted])
        return poses, self.covariance(len(poses) - 1)

    def update(self, constraints: Sequence[Constraint]) -> Array:
        """Add accepted constraints and optimise; return all poses (n, 3), equation 4.

        A constraint to a new keyframe brings the keyframe's first estimate. Raises ValueError for
        one that may not enter a graph (see ``defect``); then none of them has.
        """
        self._validate(constraints)
        for constraint in constraints:
            self._admit(constraint)
        try:
            self._push(self._added, constraints)
        except RuntimeError:
            self._rebuild()
        self._added = len(self._initial)
        return self.poses()

    def _validate(self, constraints: Sequence[Constraint]) -> None:
        known = len(self._initial)
        for constraint in constraints:
            brings_keyframe = constraint.second == known and constraint.first < known
            reason = defect(constraint, known + brings_keyframe)
            if reason:
                raise ValueError(f"{constraint.first} -> {constraint.second}: {reason}")
            known += brings_keyframe

    def _admit(self, constraint: Constraint) -> None:
        if constraint.second == len(self._initial):
            self.add_keyframe(compose(self._pose(constraint.first), constraint.relative_pose))
        self.constraints.append(constraint)

    def _pose(self, node: int) -> Array:
        if node >= self._added:
            return self._initial[node]
        return np.array(_row(self._isam.calculateEstimatePose2(node)))

    def poses(self) -> Array:
        """Return the optimised poses (n, 3) of all keyframes."""
        values = self._isam.calculateEstimate()
        return np.array([_row(values.atPose2(node)) for node in range(self._added)]).reshape(-1, 3)

    def covariance(self, node: int) -> Array:
        """Return the marginal covariance (3, 3) of a pose, in the axes of ``map``."""
        marginal = np.asarray(self._isam.marginalCovariance(node))
        return _turned(marginal, self._isam.calculateEstimatePose2(node).theta())

    def _push(self, first_new: int, constraints: Sequence[Constraint]) -> None:
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for node in range(first_new, len(self._initial)):
            values.insert(node, gtsam.Pose2(*self._initial[node]))
            if node == 0:
                prior = gtsam.noiseModel.Isotropic.Variance(3, LAUNCH_VARIANCE)
                graph.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(*self._initial[0]), prior))
        for constraint in constraints:
            graph.add(self._factor(constraint))
        self._isam.update(graph, values)
        self._isam.update()

    def _rebuild(self) -> None:
        self._isam = _smoother()
        self._push(0, self.constraints)

    def _factor(self, constraint: Constraint) -> gtsam.BetweenFactorPose2:
        covariance = _turned(constraint.covariance, -float(constraint.relative_pose[2]))
        noise: gtsam.noiseModel.Base = gtsam.noiseModel.Gaussian.Covariance(covariance)
        if constraint.kind is ConstraintKind.LOOP and self._config.robust_width > 0.0:
            kernel = gtsam.noiseModel.mEstimator.Cauchy.Create(self._config.robust_width)
            noise = gtsam.noiseModel.Robust.Create(kernel, noise)
        relative = gtsam.Pose2(*constraint.relative_pose)
        return gtsam.BetweenFactorPose2(constraint.first, constraint.second, relative, noise)


def _smoother() -> gtsam.ISAM2:
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(0.01)
    parameters.relinearizeSkip = 1
    return gtsam.ISAM2(parameters)


def _turned(covariance: Array, yaw: float) -> Array:
    """Return a pose's covariance in axes turned by -yaw; gtsam's are those of the pose itself."""
    turn = np.eye(3)
    turn[:2, :2] = rotation(yaw)
    return np.asarray(turn @ covariance @ turn.T)


def _row(pose: gtsam.Pose2) -> tuple[float, float, float]:
    return pose.x(), pose.y(), pose.theta()
