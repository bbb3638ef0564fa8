# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where the beams of the newest scans were: dead reckoning, and what matches showed of its error.

Section VII for the scan before the newest; the motion feedback for both.
"""

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from msss_graphslam.core.compounding import between, compose, compose_jacobians
from msss_graphslam.core.graph.keyframes import Node
from msss_graphslam.core.matching.line_features import NEIGHBOURS
from msss_graphslam.core.scans.motion_feedback import MotionFeedback, offset_motion
from msss_graphslam.core.scans.scan_correction import correct_scan
from msss_graphslam.core.scans.scan_generation import lay_out, motion_covariances
from msss_graphslam.core.scans.trajectory_correction import Solver, correct_motion
from msss_graphslam.core.types import Array, Constraint, MapCorrection, Scan, TwistError

__all__ = ["ReckonedStep", "ScanLayout"]

LEAST_VARIANCE = 1e-7
"""Dead reckoning is never surer of a turn's way than this [m^2, rad^2]: beside a closure that says
nothing of a direction, a surer edge leaves the graph's equations without a solution in doubles."""


@dataclass(frozen=True, slots=True)
class ReckonedStep:
    """A keyframe's pose (3,) in its predecessor by dead reckoning, and its covariance (3, 3).

    ``edge_covariance`` (3, 3) is that of an edge, independent of the edges before.
    """

    relative_pose: Array
    covariance: Array
    edge_covariance: Array


class ScanLayout:
    """Lays scans out with the twist error that is known so far, in ``feedback``.

    ``prepare`` makes of a scan what the matcher takes; ``solver`` is that of Section VII.
    """

    def __init__(
        self, feedback: MotionFeedback, solver: Solver, prepare: Callable[[Scan], Any]
    ) -> None:
        self.feedback = feedback
        self._solver = solver
        self._prepare = prepare

    def apart(self) -> "ScanLayout":
        """Return one that learns by itself from now on."""
        return ScanLayout(copy(self.feedback), self._solver, self._prepare)

    def twist_error(self, scan: Scan) -> TwistError:
        """Return the twist error of dead reckoning to be expected in the newest scan."""
        newest = self.feedback.newest()
        return TwistError(newest.mean, _known(scan, newest.covariance))

    def pass_by(self, previous: Scan, scan: Scan) -> None:
        """Let the time pass between the beginnings of two scans."""
        interval = (scan.stamp_ns - previous.stamp_ns) * 1e-9
        self.feedback.predict(interval, scan.twist_covariance)

    def step(self, previous: Scan, scan: Scan) -> ReckonedStep:
        """Return the way from one first scan to the next by dead reckoning and the feedback."""
        elapsed = np.append(previous.beam_times[:-1], (scan.stamp_ns - previous.stamp_ns) * 1e-9)
        motion = np.vstack([previous.motion, between(previous.odometry, scan.odometry)])
        motion = offset_motion(motion, elapsed, self.feedback.offset)
        covariance, edge = (
            motion_covariances(motion, elapsed, _known(scan, error))[-1]
            + LEAST_VARIANCE * np.eye(3)
            for error in (self.feedback.guessed(), self.feedback.coherent())
        )
        return ReckonedStep(motion[-1], covariance, edge)

    def node(self, scan: Scan, covariance: Array) -> Node:
        """Return the newest keyframe: its scan laid out; ``covariance`` (3, 3) of its pose."""
        laid_out = self._laid_out(scan, self.feedback.ahead().covariance)
        is_place = len(scan.body_points) >= NEIGHBOURS
        return Node(laid_out, self._prepare(laid_out), scan, covariance, is_place=is_place)

    def correct(self, reference: Node, following: Node, target: Array) -> None:
        """Lay the scan before the newest out again, the newest lying at ``target`` (3,) in it."""
        error = _known(reference.first_scan, self.feedback.covariance)
        self._correct(reference, following, target, error)

    def correction(self, newest: Node, pose: Array) -> MapCorrection:
        """Return where the vehicle was in the middle of the newest scan; ``pose`` (3,) is its own.

        Walls all around tell that best; the beginning and the end hang on it by the motion, whose
        error is not in this covariance but in that of the twist.
        """
        scan = newest.first_scan
        error = self.twist_error(scan)
        motion = offset_motion(scan.motion, scan.beam_times[:-1], error.mean)
        middle = len(motion) // 2
        by_first, _ = compose_jacobians(pose, motion[middle])
        return MapCorrection(
            stamp_ns=int(scan.beam_stamps_ns[middle]),
            pose=compose(pose, motion[middle]),
            covariance=by_first @ newest.covariance @ by_first.T,
            twist_error=error,
        )

    def learn(self, reference: Node, current: Node, matched: Constraint) -> None:
        """Take the motion that a match shows into the layout of both its scans."""
        # Its error is that of the match, no other.
        delta = self._correct(reference, current, matched.relative_pose, np.zeros((3, 3)))
        self._take_in(reference.first_scan, delta, matched)
        self._lay_out_newest(current, self.feedback.beside_match())

    def settle(self, current: Node) -> None:
        """State in the newest scan what its matches have left of its motion's error."""
        self._lay_out_newest(current, self.feedback.after_match())

    def learn_twist(self, previous: Scan, scan: Scan, matched: Constraint) -> None:
        """Learn from a match of two first scans, without making them anew."""
        end = between(previous.odometry, scan.odometry)
        met = correct_motion(previous.motion, end, matched.relative_pose, self._solver)
        self._take_in(previous, met.delta, matched)

    def widened(self, matched: Constraint) -> Constraint:
        """Count what the layout of both scans follows the match.

        Both are laid out by the twist that the match shows. Were the newest not, as where the
        motion is new in every turn, an error of the match would bend its reference and stay.
        """
        factor = 2.0 / (1.0 + self.feedback.followed())
        return replace(matched, covariance=np.outer(factor, factor) * matched.covariance)

    def _take_in(self, scan: Scan, delta: Array, matched: Constraint) -> None:
        duration = scan.beam_times[-1]
        beam_period = duration / len(scan.beam_stamps_ns)
        self.feedback.update(delta / beam_period, matched.covariance / duration**2)

    def _lay_out_newest(self, current: Node, covariance: Array) -> None:
        current.scan = self._laid_out(current.first_scan, covariance)
        current.prepared = self._prepare(current.scan)

    def _laid_out(self, scan: Scan, covariance: Array) -> Scan:
        offset = self.feedback.ahead().mean
        motion = offset_motion(scan.motion, scan.beam_times[:-1], offset)
        return lay_out(scan, motion, _known(scan, covariance))

    def _correct(self, reference: Node, following: Node, target: Array, error: Array) -> Array:
        """Return delta X of equation 14."""
        reference.scan, delta = correct_scan(
            reference.first_scan, following.first_scan, target, self._solver, error
        )
        reference.prepared = self._prepare(reference.scan)
        return delta


def _known(scan: Scan, learned: Array) -> Array:
    """Return the covariance (3, 3) of a scan's twist error, learned or as dead reckoning says."""
    return learned if learned.any() else scan.twist_covariance
