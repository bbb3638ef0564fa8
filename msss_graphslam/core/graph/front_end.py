# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The front end of Figure 4: a new scan and the optimised poses in, constraints out."""

from collections.abc import Sequence
from contextlib import nullcontext

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between, compose, compose_covariance
from msss_graphslam.core.graph.graph_construction import (
    consecutive_constraint,
    loop_constraints,
    odometry_constraint,
)
from msss_graphslam.core.graph.keyframes import Node, bare_scan, newest_place, places, put_by
from msss_graphslam.core.graph.known_places import is_known, located_alone
from msss_graphslam.core.graph.loop_search import as_in_the_paper, by_overlap, reach
from msss_graphslam.core.graph.match_rounds import match_in_rounds
from msss_graphslam.core.graph.scan_layout import ReckonedStep, ScanLayout
from msss_graphslam.core.graph.turn_in_progress import lenient, previewed
from msss_graphslam.core.matching.matchers import ScanMatcher
from msss_graphslam.core.matching.shape_matching import shape_descriptor
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.scans.motion_feedback import MotionFeedback
from msss_graphslam.core.scans.persistence import persistence_of
from msss_graphslam.core.types import (
    Array,
    Constraint,
    GraphPoses,
    KeyframeReport,
    MapCorrection,
    Scan,
    Stage,
)

__all__ = ["FrontEnd"]


class FrontEnd:
    """Keeps the keyframes' scans and makes the constraints of each new one.

    ``nodes`` and ``poses`` (n, 3) are the keyframes so far; ``layout`` lays the newest scans out,
    ``matcher`` matches them, None where none are matched.
    """

    def __init__(
        self, configuration: Configuration, recipe: Recipe, stage: Stage = lambda _: nullcontext()
    ) -> None:
        self._configuration = configuration
        self._recipe = recipe
        self._compares_shapes = recipe.closes_loops and not recipe.goes_beyond
        self._stage = stage
        self.matcher = recipe.matcher(configuration.matching) if recipe.matcher else None
        self._part_matcher = None
        if recipe.matcher and recipe.goes_beyond:
            self._part_matcher = recipe.matcher(lenient(configuration.matching))
        feedback = MotionFeedback(persistence_of(configuration.dead_reckoning))
        prepare = self.matcher.prepare if self.matcher else lambda _: None
        self.layout = ScanLayout(feedback, recipe.solver, prepare)
        self.nodes: list[Node] = []
        self.poses = np.empty((0, 3))

    @property
    def offset(self) -> Array:
        """The twist error (3,) of dead reckoning to be expected in the newest scan."""
        return self.layout.feedback.ahead().mean

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
        step = self._reckon(scan)
        odometry = odometry_constraint(self.nodes, step.relative_pose, step.edge_covariance)
        if self.matcher is None:
            return [odometry]
        return self._match(self.matcher, step, odometry)

    def correct(self, poses: Array, covariance: Array) -> None:
        """Algorithm 1, lines 12 to 14: take over the optimised poses, make the last scan anew.

        ``poses`` (n, 3) of all keyframes, ``covariance`` (3, 3) of the newest.
        """
        self.poses = poses
        self.nodes[-1].covariance = covariance
        if len(self.nodes) > 1:
            with self._stage("trajectory_correction"):
                reference, newest = self.nodes[-2:]
                self.layout.correct(reference, newest, between(poses[-2], poses[-1]))

    def correction(self) -> MapCorrection:
        """Return where the vehicle was in the middle of the newest scan, by all that is known."""
        return self.layout.correction(self.nodes[-1], self.poses[-1])

    def preview(self, part: Scan) -> MapCorrection | None:
        """Return where the vehicle was in the middle of a part of the turn in progress.

        None where the part does not tell; nothing changes here.
        """
        if not self.nodes or self._part_matcher is None:
            return None
        return previewed(part, self.nodes[-1], self.poses[-1], self.layout, self._part_matcher)

    def report(self, tried: Sequence[Constraint]) -> KeyframeReport:
        """Return what the back end needs of the newest keyframe, whose constraints were tried."""
        scan = self.nodes[-1].first_scan
        return KeyframeReport(
            number=len(self.nodes) - 1,
            stamp_ns=scan.stamp_ns,
            pose=self.poses[-1],
            odometry=scan.odometry,
            twist_error=self.layout.twist_error(scan),
            constraints=tuple(tried),
        )

    def adopt(self, known: GraphPoses) -> None:
        """Begin with the keyframes of an earlier front end, of which only the poses are left."""
        self.nodes, self.poses = [], np.empty((0, 3))
        rows = zip(known.stamps_ns, known.odometry, known.covariances, strict=True)
        for stamp_ns, odometry, covariance in rows:
            self._append(bare_scan(int(stamp_ns), odometry), odometry, covariance)
            self.nodes[-1].is_place = False
        self.poses = known.poses

    def _reckon(self, scan: Scan) -> ReckonedStep:
        """Append the new node where dead reckoning has it; return the way there."""
        reference = self.nodes[-1]
        previous = reference.first_scan
        if self._recipe.goes_beyond:
            self.layout.pass_by(previous, scan)
        step = self.layout.step(previous, scan)
        covariance = compose_covariance(
            self.poses[-1], reference.covariance, step.relative_pose, step.covariance
        )
        self._append(scan, compose(self.poses[-1], step.relative_pose), covariance)
        return step

    def _append(self, scan: Scan, pose: Array, covariance: Array) -> None:
        if len(self.nodes) > 1:
            put_by(self.nodes[-2])
        node = self.layout.node(scan, covariance)
        node.place_before = newest_place(self.nodes)
        if self._compares_shapes:
            node.descriptor = shape_descriptor(node.scan.points, float(pose[2]))
        self.nodes.append(node)
        self.poses = np.vstack([self.poses, pose])

    def _match(
        self, matcher: ScanMatcher, step: ReckonedStep, odometry: Constraint
    ) -> list[Constraint]:
        with self._stage("scan_matching"):
            consecutive = self._match_consecutive(matcher, step)
        constraints = [consecutive]
        if self._recipe.goes_beyond or not consecutive.accepted:
            # Deviation: Algorithm 4 leaves a keyframe without any edge where spIC fails; the
            # odometry constraint of equation 1 keeps it in the graph.
            constraints.insert(0, odometry)
        if self._recipe.goes_beyond and consecutive.accepted:
            self.poses[-1] = compose(self.poses[-2], consecutive.relative_pose)
        if self._recipe.closes_loops:
            constraints += self._close_loops(matcher)
        if self._recipe.goes_beyond and self._is_known(constraints):
            self.nodes[-1].is_place = False
            constraints = located_alone(constraints)
        return constraints

    def _match_consecutive(self, matcher: ScanMatcher, step: ReckonedStep) -> Constraint:
        if self._recipe.goes_beyond:
            return match_in_rounds(self.nodes, step, matcher, self.layout)
        return consecutive_constraint(self.nodes, step.relative_pose, step.covariance, matcher)

    def _close_loops(self, matcher: ScanMatcher) -> list[Constraint]:
        search = as_in_the_paper if self._compares_shapes else by_overlap
        with self._stage("data_association"):
            near = search(self.nodes, self.poses, self._configuration.association)
        with self._stage("scan_matching"):
            return loop_constraints(
                self.nodes, self.poses, near, matcher, widely=self._recipe.goes_beyond
            )

    def _is_known(self, tried: Sequence[Constraint]) -> bool:
        around = self.poses[[*places(self.nodes), len(self.nodes) - 2]]
        distance = reach(self.nodes[-1], self._configuration.association)
        return is_known(self.poses[-1], around, distance, tried)
