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
from msss_graphslam.core.compounding import compose
from msss_graphslam.core.graph.constraint_defects import defect
from msss_graphslam.core.graph.factors import between_factor, launch_prior, shares, turned
from msss_graphslam.core.graph.released import Released
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["BackEnd"]

RELINEARISED = 0.01
"""What moves farther than this [m, rad] is linearised again."""

STEPS = 10
"""Most steps of Gauss and Newton for an update. All but those in which a loop closes take one."""

READ_ALWAYS, READ_EVERY = 2000, 16
"""With more keyframes than this, reading all takes longer than optimising: not every time."""

READ_AGAIN = 2e-3
"""Unless an update moves one of its own keyframes farther than this [m, rad]."""


class BackEnd:
    """Keyframes and accepted constraints in, optimised poses and covariances out.

    The smoother is rebuilt from its ``constraints`` after a failure.
    """

    def __init__(self, config: BackEndConfig, *, divides: bool = False) -> None:
        """Begin empty; ``divides`` the weight of a scan among the matches that end at it."""
        self._config = config
        self._divides = divides
        self._inside: dict[int, Constraint] = {}
        self._slots: dict[int, int] = {}
        self._released = Released()
        self._initial: list[Array] = []
        self._read = np.empty((0, 3))
        self._added = 0
        self._isam = _smoother()

    @property
    def constraints(self) -> list[Constraint]:
        """The constraints in the smoother, in the order in which they were taken in."""
        return list(self._inside.values())

    def add_keyframe(self, pose: Array) -> int:
        """Add a node with its first estimate (3,); return its number."""
        if not np.isfinite(pose).all():
            raise ValueError(f"pose of keyframe {len(self._initial)} is not finite: {pose}")
        self._initial.append(np.array(pose, dtype=float))
        return len(self._initial) - 1

    def take(
        self, pose: Array, tried: Sequence[Constraint], released: Sequence[Constraint] = ()
    ) -> tuple[Array, Array]:
        """Take in a keyframe; return all poses (n, 3) and the newest one's covariance (3, 3).

        ``tried`` are the constraints that end at it, of which the accepted ones count; the first
        keyframe of all has none and is put at its own ``pose`` (3,). For ``released`` see
        ``update``.
        """
        if not self._initial:
            self.add_keyframe(pose)
        poses = self.update([entry for entry in tried if entry.accepted], released)
        return poses, self.covariance(len(poses) - 1)

    def update(
        self, constraints: Sequence[Constraint], released: Sequence[Constraint] = ()
    ) -> Array:
        """Add accepted constraints and optimise; return all poses (n, 3), equation 4.

        A constraint to a new keyframe brings the keyframe's first estimate. Raises ValueError for
        one that may not enter a graph (see ``defect``); then none of them has. ``released`` are
        all those of a keyframe that is to leave the smoother: it keeps its place by one of them.
        """
        self._validate(constraints)
        for constraint in constraints:
            if constraint.second == len(self._initial):
                self._begin([edge for edge in constraints if edge.second == constraint.second])
        if released:
            self._released.add(released, self._pose)
        self._optimise(constraints, released)
        return self._poses_after(constraints)

    def exchange(self, out: Sequence[Constraint], back: Sequence[Constraint]) -> Array:
        """Take constraints out of the graph and others in; return all poses (n, 3).

        Those that go out are the very objects that were taken in. Where a keyframe has left the
        smoother nothing changes for it.
        """
        known = [edge for edge in out if id(edge) in self._slots]
        self._optimise([edge for edge in back if edge.second not in self._released], known)
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

    def _begin(self, edges: Sequence[Constraint]) -> None:
        """Add the keyframe at which the edges end, where the last that closes no loop has it.

        That is a match, if there is one: it is nearer to the optimum than dead reckoning.
        """
        way = [edge for edge in edges if edge.kind is not ConstraintKind.LOOP] or edges[:1]
        first = self._pose(way[-1].first)
        self.add_keyframe(compose(first, way[-1].relative_pose))

    def _pose(self, node: int) -> Array:
        if node >= self._added:
            return self._initial[node]
        if node in self._released:
            hold = self._released.hold(node)
            return compose(self._pose(hold.first), hold.relative_pose)
        return np.array(_row(self._isam.calculateEstimatePose2(node)))

    def poses(self) -> Array:
        """Return the optimised poses (n, 3) of all keyframes."""
        values = self._isam.calculateEstimate()
        inside = np.asarray(gtsam.utilities.extractPose2(values), dtype=float).reshape(-1, 3)
        return self._released.completed(inside)

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
        return turned(marginal, self._isam.calculateEstimatePose2(node).theta())

    def _optimise(self, new: Sequence[Constraint], out: Sequence[Constraint]) -> None:
        """Take in what is new and out what goes out, until their keyframes stay."""
        ends = {edge.second for edge in [*new, *out]}
        touched = sorted(node for node in ends if node not in self._released)
        before = self._poses_of(touched)
        slots = [self._slots.pop(id(edge)) for edge in out]
        for edge in out:
            del self._inside[id(edge)]
        self._inside.update((id(edge), edge) for edge in new)
        try:
            self._push(new, slots)
        except RuntimeError:
            self._rebuild()
        for _ in range(STEPS - 1):
            poses = self._poses_of(touched)
            if np.abs(poses - before).max(initial=0.0) < RELINEARISED:
                break
            before = poses
            self._isam.update()

    def _poses_of(self, nodes: Sequence[int]) -> Array:
        return np.array([self._pose(node) for node in nodes]).reshape(-1, 3)

    def _push(self, constraints: Sequence[Constraint], out: Sequence[int] = ()) -> None:
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for node in range(self._added, len(self._initial)):
            if node not in self._released:
                values.insert(node, gtsam.Pose2(*self._initial[node]))
            if node == 0:
                graph.add(launch_prior(self._initial[0]))
        weights = shares(constraints) if self._divides else [1.0] * len(constraints)
        for constraint, share in zip(constraints, weights, strict=True):
            edge = self._released.from_inside(constraint)
            graph.add(between_factor(edge, self._config, share))
        indices = list(self._isam.update(graph, values, list(out)).getNewFactorsIndices())
        slots = indices[len(indices) - len(constraints) :]
        self._slots.update(zip(map(id, constraints), slots, strict=True))
        self._added = len(self._initial)

    def _rebuild(self) -> None:
        self._isam, self._added = _smoother(), 0
        self._slots, self._read = {}, np.empty((0, 3))
        self._push(self.constraints)


def _smoother() -> gtsam.ISAM2:
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(RELINEARISED)
    parameters.relinearizeSkip = 1
    return gtsam.ISAM2(parameters)


def _row(pose: gtsam.Pose2) -> tuple[float, float, float]:
    return pose.x(), pose.y(), pose.theta()
