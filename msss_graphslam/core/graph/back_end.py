# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The back end: iSAM on the pose graph of equation 4 (gtsam's ISAM2).

M. Kaess et al., iSAM2: Incremental smoothing and mapping using the Bayes tree, IJRR 31, 2012
(the successor of the paper's [13]).
"""

from collections import Counter
from collections.abc import Sequence

import gtsam
import numpy as np

from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.compounding import compose, planar_rotation
from msss_graphslam.core.graph.constraint_defects import defect
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["BackEnd", "between_factor", "launch_prior"]

LAUNCH_VARIANCE = 1e-12
"""The first pose defines the map; its prior only holds the gauge [m^2, rad^2]."""

READ_ALWAYS, READ_EVERY = 2000, 16
"""With more keyframes than this, reading all takes longer than optimising: not every time."""

READ_AGAIN = 2e-3
"""Unless an update moves one of its own keyframes farther than this [m, rad]."""


class BackEnd:
    """Keyframes and accepted constraints in, optimised poses and covariances out.

    The constraints are kept in ``constraints``; the smoother is rebuilt from them after a failure.
    """

    def __init__(self, config: BackEndConfig, *, divides: bool = False) -> None:
        """Begin empty; ``divides`` the weight of a scan among the matches that end at it."""
        self._config = config
        self._divides = divides
        self.constraints: list[Constraint] = []
        self._slots: list[int] = []
        self._initial: list[Array] = []
        self._read = np.empty((0, 3))
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
        return self._poses_after(constraints)

    def exchange(self, out: Sequence[Constraint], back: Sequence[Constraint]) -> Array:
        """Take constraints out of the graph and others in; return all poses (n, 3).

        Those that go out are the very objects that were taken in.
        """
        going = {id(constraint) for constraint in out}
        staying = [id(constraint) not in going for constraint in self.constraints]
        slots = [slot for slot, stays in zip(self._slots, staying, strict=True) if not stays]
        self.constraints = [c for c, stays in zip(self.constraints, staying, strict=True) if stays]
        self._slots = [slot for slot, stays in zip(self._slots, staying, strict=True) if stays]
        self.constraints += back
        try:
            self._push(self._added, back, slots)
        except RuntimeError:
            self._rebuild()
        self._read = self.poses()
        return self._read.copy()

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
        return np.asarray(gtsam.utilities.extractPose2(values), dtype=float).reshape(-1, 3)

    def _poses_after(self, constraints: Sequence[Constraint]) -> Array:
        """Return all poses (n, 3) after an update by ``constraints``.

        In a long mission most of them stay where they are: as long as the keyframes do that the
        update is about, the others are only read out of the smoother now and then.
        """
        count, known = self._added, len(self._read)
        if count > READ_ALWAYS and count % READ_EVERY:
            ends = sorted({node for edge in constraints for node in (edge.first, edge.second)})
            poses = np.vstack([self._read, np.zeros((count - known, 3))])
            poses[ends] = [self._pose(node) for node in ends]
            moved = np.abs(poses[:known] - self._read)
            if set(range(known, count)) <= set(ends) and moved.max(initial=0.0) < READ_AGAIN:
                self._read = poses
                return poses.copy()
        self._read = self.poses()
        return self._read.copy()

    def covariance(self, node: int) -> Array:
        """Return the marginal covariance (3, 3) of a pose, in the axes of ``map``."""
        marginal = np.asarray(self._isam.marginalCovariance(node))
        return _turned(marginal, self._isam.calculateEstimatePose2(node).theta())

    def _push(
        self, first_new: int, constraints: Sequence[Constraint], out: Sequence[int] = ()
    ) -> None:
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for node in range(first_new, len(self._initial)):
            values.insert(node, gtsam.Pose2(*self._initial[node]))
            if node == 0:
                graph.add(launch_prior(self._initial[0]))
        shares = _shares(constraints) if self._divides else [1.0] * len(constraints)
        for constraint, share in zip(constraints, shares, strict=True):
            graph.add(between_factor(constraint, self._config, share))
        indices = self._isam.update(graph, values, list(out)).getNewFactorsIndices()
        self._slots += list(indices)[len(indices) - len(constraints) :]
        self._isam.update()

    def _rebuild(self) -> None:
        self._isam = _smoother()
        self._read = np.empty((0, 3))
        self._slots = []
        self._push(0, self.constraints)


def launch_prior(pose: Array) -> gtsam.PriorFactorPose2:
    """Return what holds keyframe 0 at its ``pose`` (3,)."""
    noise = gtsam.noiseModel.Isotropic.Variance(3, LAUNCH_VARIANCE)
    return gtsam.PriorFactorPose2(0, gtsam.Pose2(*pose), noise)


def between_factor(
    constraint: Constraint, config: BackEndConfig, share: float = 1.0
) -> gtsam.BetweenFactorPose2:
    """Return a constraint as a factor of equation 4; it counts as a ``share`` of itself."""
    covariance = _turned(constraint.covariance, -float(constraint.relative_pose[2])) / share
    noise: gtsam.noiseModel.Base = gtsam.noiseModel.Gaussian.Covariance(covariance)
    if constraint.kind is ConstraintKind.LOOP and config.robust_width > 0.0:
        kernel = gtsam.noiseModel.mEstimator.Cauchy.Create(config.robust_width)
        noise = gtsam.noiseModel.Robust.Create(kernel, noise)
    relative = gtsam.Pose2(*constraint.relative_pose)
    return gtsam.BetweenFactorPose2(constraint.first, constraint.second, relative, noise)


def _shares(constraints: Sequence[Constraint]) -> list[float]:
    """Return what each constraint counts: matches of one scan have its errors in common.

    Above all that of the motion within it. A match errs by both its scans alike: of the variance
    of n matches' mean, the newest scan's half stays, and the others' half becomes one n-th.
    """
    matched = [edge.kind is not ConstraintKind.ODOMETRY for edge in constraints]
    often = Counter(
        edge.second for edge, matches in zip(constraints, matched, strict=True) if matches
    )
    return [
        2.0 / (1.0 + often[edge.second]) if matches else 1.0
        for edge, matches in zip(constraints, matched, strict=True)
    ]


def _smoother() -> gtsam.ISAM2:
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(0.01)
    parameters.relinearizeSkip = 1
    return gtsam.ISAM2(parameters)


def _turned(covariance: Array, yaw: float) -> Array:
    """Return a pose's covariance in axes turned by -yaw; gtsam's are those of the pose itself."""
    turn = planar_rotation(yaw)
    return np.asarray(turn @ covariance @ turn.T)


def _row(pose: gtsam.Pose2) -> tuple[float, float, float]:
    return pose.x(), pose.y(), pose.theta()
