# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The front end of Figure 4: a new scan and the optimised poses in, constraints out."""

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between, compose, compose_jacobians
from msss_graphslam.core.graph.data_association import Candidate, associate
from msss_graphslam.core.graph.graph_construction import (
    Node,
    consecutive_constraint,
    loop_constraints,
    odometry_constraint,
)
from msss_graphslam.core.graph.known_places import is_known, located_alone
from msss_graphslam.core.matching.matchers import ScanMatcher
from msss_graphslam.core.matching.shape_matching import shape_descriptor
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.scans.motion_feedback import (
    MotionFeedback,
    offset_motion,
    persistence_of,
)
from msss_graphslam.core.scans.scan_correction import correct_scan
from msss_graphslam.core.scans.scan_generation import (
    lay_out,
    motion_covariances,
    reckoned_scan,
)
from msss_graphslam.core.types import (
    Array,
    Constraint,
    GraphPoses,
    KeyframeReport,
    MapCorrection,
    Scan,
    Stage,
    TwistError,
)

__all__ = ["FrontEnd"]

ROUNDS = 6
"""Most matches of consecutive scans: each corrects their layout for the next."""

LEAST_VARIANCE = 1e-7
"""Dead reckoning is never surer of a turn's way than this [m^2, rad^2]: beside a closure that says
nothing of a direction, a surer edge leaves the graph's equations without a solution in doubles."""

SETTLED, SETTLED_ANGLE = 0.01, 0.001
"""Rounds end when the displacement changes by less than this [m], [rad]."""


class FrontEnd:
    """Keeps the keyframes' scans and makes the constraints of each new one."""

    def __init__(
        self, configuration: Configuration, recipe: Recipe, stage: Stage = lambda _: nullcontext()
    ) -> None:
        self._configuration = configuration
        self._recipe = recipe
        self._stage = stage
        self._matcher = recipe.matcher(configuration.matching) if recipe.matcher else None
        self._feedback = MotionFeedback(persistence_of(configuration.dead_reckoning))
        self.nodes: list[Node] = []
        self.poses = np.empty((0, 3))
        self._places: dict[int, None] = {}

    @property
    def offset(self) -> Array:
        """The twist error (3,) of dead reckoning to be expected in the newest scan."""
        return self._feedback.ahead().mean

    def configure(self, configuration: Configuration) -> None:
        """Search loop closures by other parameters from the next scan on.

        Only the group ``association`` is taken over: what was matched stays as it was matched.
        """
        self._configuration = configuration

    def add_scan(self, scan: Scan) -> list[Constraint]:
        """Algorithm 1, lines 8 to 11: return the constraints tried for a new keyframe.

        Their first is the one by which the keyframe hangs on its predecessor; the first scan of
        all has none.
        """
        if not self.nodes:
            self._append(scan, scan.odometry, np.zeros((3, 3)))
            return []
        relative, covariance, edge = self._reckon(scan)
        odometry = odometry_constraint(self.nodes, relative, edge)
        if self._matcher is None:
            return [odometry]
        return self._match(self._matcher, relative, covariance, odometry)

    def correct(self, poses: Array, covariance: Array) -> None:
        """Algorithm 1, lines 12 to 14: take over the optimised poses, make the last scan anew.

        ``poses`` (n, 3) of all keyframes, ``covariance`` (3, 3) of the newest.
        """
        self.poses = poses
        self.nodes[-1].covariance = covariance
        if len(self.nodes) > 1:
            with self._stage("trajectory_correction"):
                error = self._known_error(self.nodes[-2].first_scan, self._feedback.covariance)
                self._lay_out_reference(between(poses[-2], poses[-1]), error)

    def correction(self) -> MapCorrection:
        """Return where the vehicle was in the middle of the newest scan, by all that is known.

        Walls all around tell that best; the beginning and the end hang on it by the motion, whose
        error is not in this covariance but in that of the twist.
        """
        scan = self.nodes[-1].first_scan
        error = self._motion_error(scan)
        motion = offset_motion(scan.motion, scan.beam_times[:-1], self.offset)
        middle = len(motion) // 2
        by_first, _ = compose_jacobians(self.poses[-1], motion[middle])
        spread = self.nodes[-1].covariance
        return MapCorrection(
            stamp_ns=int(scan.beam_stamps_ns[middle]),
            pose=compose(self.poses[-1], motion[middle]),
            covariance=by_first @ spread @ by_first.T,
            twist_error=TwistError(self.offset, error),
        )

    def report(self, tried: Sequence[Constraint]) -> KeyframeReport:
        """Return what the back end needs of the newest keyframe, whose constraints were tried."""
        scan = self.nodes[-1].first_scan
        return KeyframeReport(
            number=len(self.nodes) - 1,
            stamp_ns=scan.stamp_ns,
            pose=self.poses[-1],
            odometry=scan.odometry,
            twist_error=TwistError(self.offset, self._motion_error(scan)),
            constraints=tuple(tried),
        )

    def adopt(self, known: GraphPoses) -> None:
        """Begin with the keyframes of an earlier front end, of which only the poses are left."""
        self.nodes, self.poses, self._places = [], np.empty((0, 3)), {}
        rows = zip(known.stamps_ns, known.odometry, known.covariances, strict=True)
        for stamp_ns, odometry, covariance in rows:
            self._append(_without_echoes(int(stamp_ns), odometry), odometry, covariance)
            self.nodes[-1].is_place = False
        self.poses = known.poses

    def _reckon(self, scan: Scan) -> tuple[Array, Array, Array]:
        """Append the new node; return its pose in its predecessor and that pose's covariance.

        The last is the covariance of an edge, independent of the edges before.
        """
        reference = self.nodes[-1]
        previous = reference.first_scan
        elapsed = np.append(previous.beam_times[:-1], (scan.stamp_ns - previous.stamp_ns) * 1e-9)
        motion = np.vstack([previous.motion, between(previous.odometry, scan.odometry)])
        if self._recipe.goes_beyond:
            self._feedback.predict(float(elapsed[-1]), scan.twist_covariance)
        feedback = self._feedback
        motion = offset_motion(motion, elapsed, feedback.offset)
        relative = motion[-1]
        covariance, edge = (
            motion_covariances(motion, elapsed, self._known_error(scan, error))[-1]
            + LEAST_VARIANCE * np.eye(3)
            for error in (feedback.covariance, feedback.coherent())
        )
        by_first, by_second = compose_jacobians(self.poses[-1], relative)
        pose_covariance = (
            by_first @ reference.covariance @ by_first.T + by_second @ covariance @ by_second.T
        )
        self._append(scan, compose(self.poses[-1], relative), pose_covariance)
        return relative, covariance, edge

    def _append(self, scan: Scan, pose: Array, covariance: Array) -> None:
        if len(self.nodes) > 1:
            self._put_by(len(self.nodes) - 2)
        laid_out = self._with_offset(scan)
        self.poses = np.vstack([self.poses, pose])
        descriptor = shape_descriptor(laid_out.points, float(pose[2]))
        prepared = self._matcher.prepare(laid_out) if self._matcher else None
        self.nodes.append(Node(laid_out, prepared, scan, descriptor, covariance))

    def _match(
        self, matcher: ScanMatcher, relative: Array, covariance: Array, odometry: Constraint
    ) -> list[Constraint]:
        with self._stage("scan_matching"):
            consecutive = self._match_consecutive(matcher, relative, covariance)
        constraints = [consecutive]
        if self._recipe.goes_beyond or not consecutive.accepted:
            # Deviation: Algorithm 4 leaves a keyframe without any edge where spIC fails; the
            # odometry constraint of equation 1 keeps it in the graph.
            constraints.insert(0, odometry)
        if self._recipe.goes_beyond and consecutive.accepted:
            self.poses[-1] = compose(self.poses[-2], consecutive.relative_pose)
        if self._recipe.closes_loops:
            with self._stage("data_association"):
                candidates = self._associate()
            with self._stage("scan_matching"):
                constraints += loop_constraints(self.nodes, self.poses, candidates, matcher)
        if self._recipe.goes_beyond and self._is_known(constraints):
            self.nodes[-1].is_place = False
            constraints = located_alone(constraints)
        return constraints

    def _is_known(self, tried: Sequence[Constraint]) -> bool:
        places = self.poses[[*self._places, len(self.nodes) - 2]]
        return is_known(self.poses[-1], places, self._reach(), tried)

    def _match_consecutive(
        self, matcher: ScanMatcher, relative: Array, covariance: Array
    ) -> Constraint:
        constraint = consecutive_constraint(self.nodes, relative, covariance, matcher)
        if not self._recipe.goes_beyond:
            return constraint
        accepted: list[Constraint] = []
        for _ in range(ROUNDS - 1):
            if not constraint.accepted:
                break
            accepted.append(constraint)
            self._learn(constraint)
            before = constraint.relative_pose
            # Both scans are laid out by it: the first guess may be out of the basin by now.
            constraint = consecutive_constraint(self.nodes, relative, covariance, matcher, before)
            change = np.abs(between(before, constraint.relative_pose))
            if max(change[0], change[1]) < SETTLED and change[2] < SETTLED_ANGLE:
                break
        if accepted and not constraint.accepted:
            # The rounds led astray, as where the vehicle began to turn and no gyro said so.
            constraint = max(accepted, key=lambda entry: entry.figures.get("overlap", 0.0))
            self._learn(constraint)
        return self._widened(constraint)

    def _widened(self, constraint: Constraint) -> Constraint:
        """Count what the layout of both scans follows the match.

        Both are laid out by the twist that the match shows. Were the newest not, as where the
        motion is new in every turn, an error of the match would bend its reference and stay.
        """
        factor = 2.0 / (1.0 + self._feedback.followed())
        return replace(constraint, covariance=np.outer(factor, factor) * constraint.covariance)

    def _learn(self, constraint: Constraint) -> None:
        """Take the motion that a match shows into the layout of both its scans."""
        reference = self.nodes[-2]
        scan = reference.first_scan
        # Its error is that of the match, no other.
        delta = self._lay_out_reference(constraint.relative_pose, np.zeros((3, 3)))
        beam_period = scan.beam_times[-1] / len(scan.beam_stamps_ns)
        duration = scan.beam_times[-1]
        self._feedback.update(delta / beam_period, constraint.covariance / duration**2)
        current = self.nodes[-1]
        current.scan = self._with_offset(current.first_scan)
        if self._matcher is not None:
            current.prepared = self._matcher.prepare(current.scan)

    def _with_offset(self, scan: Scan) -> Scan:
        motion = offset_motion(scan.motion, scan.beam_times[:-1], self.offset)
        return lay_out(scan, motion, self._motion_error(scan))

    def _motion_error(self, scan: Scan) -> Array:
        return self._known_error(scan, self._feedback.ahead().covariance)

    def _known_error(self, scan: Scan, learned: Array) -> Array:
        return learned if learned.any() else scan.twist_covariance

    def _lay_out_reference(self, target: Array, error: Array) -> Array:
        """Section VII for the scan before the newest; return delta X of equation 14."""
        reference, scan = self.nodes[-2], self.nodes[-2].first_scan
        following = self.nodes[-1].first_scan
        reference.scan, delta = correct_scan(scan, following, target, self._recipe.solver, error)
        if self._matcher is not None:
            reference.prepared = self._matcher.prepare(reference.scan)
        return delta

    def _associate(self) -> list[Candidate]:
        config = self._configuration.association
        # The preceding keyframe, which has its own constraint, comes last.
        numbers = [*self._places, len(self.nodes) - 2]
        current = self.nodes[-1]
        covariances = np.array([self.nodes[number].covariance for number in numbers])
        covariance = current.covariance
        if self._recipe.goes_beyond:
            # Deviation: scans overlap although their poses differ. Where the poses are well known
            # equation 11 would refuse every revisit that is a metre off.
            overlap = np.diag([self._reach() ** 2, self._reach() ** 2, np.pi**2])
            covariances, covariance = covariances + overlap, covariance + overlap
        return associate(
            self.poses[numbers],
            covariances,
            [self.nodes[number].descriptor for number in numbers],
            self.poses[-1],
            covariance,
            current.descriptor,
            config,
            config.most if self._recipe.goes_beyond else None,
            numbers,
        )

    def _put_by(self, number: int) -> None:
        """Drop what no later scan is matched with or corrected by."""
        node = self.nodes[number]
        scan = node.first_scan
        node.scan = node.first_scan = _without_echoes(scan.stamp_ns, scan.odometry)
        if node.is_place:
            self._places[number] = None
        else:
            node.prepared, node.descriptor = None, node.descriptor[:0].copy()

    def _reach(self) -> float:
        """Return how far from the newest scan others still overlap with it [m]."""
        points = self.nodes[-1].scan.body_points
        reach = self._configuration.association.reach
        return reach * float(np.median(np.hypot(*points.T))) if len(points) else 0.0


def _without_echoes(stamp_ns: int, odometry: Array) -> Scan:
    reckoned = np.zeros((2, 6))
    reckoned[:, [0, 1, 5]] = odometry
    return reckoned_scan(
        beam_stamps_ns=np.array([stamp_ns]),
        end_stamp_ns=stamp_ns,
        reckoned=reckoned,
        twist_covariance=np.zeros((3, 3)),
        beam_index=np.zeros(0, dtype=np.intp),
        body_points=np.zeros((0, 2)),
        body_covariances=np.zeros((0, 2, 2)),
    )
