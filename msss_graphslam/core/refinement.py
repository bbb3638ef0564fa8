# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Refinement: all scans made anew from the corrected trajectory, every edge matched again."""

# Deviation: the paper makes the newest reference scan anew, once. The motion inside the scans is
# the largest error left; laid out by the optimised graph they match better, until it settles.

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.back_end import BackEnd
from msss_graphslam.core.compounding import between
from msss_graphslam.core.graph_construction import matched
from msss_graphslam.core.matchers import ScanMatcher
from msss_graphslam.core.scan_correction import corrected_scans
from msss_graphslam.core.trajectory_correction import closed_form
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Scan, TwistError

__all__ = ["Refined", "refine", "whole_graph"]

PASSES = 2
SETTLED = 0.01
"""A scan in which no beam's pose moves farther than this [m] stays as it is."""

UNCERTAINTY = np.diag([0.15**2, 0.15**2, 0.02**2])
"""How far off a pair's displacement may still be before a pass (3, 3)."""


@dataclass(frozen=True, slots=True)
class Refined:
    """The poses (n, 3) after refinement, their graph, and the constraints of the last pass."""

    poses: Array
    back_end: BackEnd
    constraints: list[Constraint]


def refine(
    scans: Sequence[Scan],
    poses: Array,
    constraints: Sequence[Constraint],
    known: TwistError | None,
    matcher: ScanMatcher,
    config: BackEndConfig,
    progress: Callable[[float], None],
) -> Refined:
    """Lay out, match and optimise until the poses settle.

    ``scans`` are as dead reckoning laid them out, ``poses`` (n, 3) what the graph says so far.
    """
    edges = list(constraints)
    layout = _Layout(matcher)
    moved_scans = layout.take(corrected_scans(scans, poses, closed_form, known))
    for number in range(PASSES):
        edges = [
            _again(edge, layout, poses) if moved_scans & {edge.first, edge.second} else edge
            for edge in edges
        ]
        back_end = whole_graph(poses, edges, config)
        poses = back_end.poses()
        moved_scans = layout.take(corrected_scans(scans, poses, closed_form, known))
        progress((number + 1) / PASSES)
        if not moved_scans:
            break
    return Refined(poses, back_end, edges)


def whole_graph(poses: Array, constraints: Sequence[Constraint], config: BackEndConfig) -> BackEnd:
    """Return the graph of all accepted constraints at once, begun at the poses (n, 3)."""
    back_end = BackEnd(config)
    for pose in poses:
        back_end.add_keyframe(pose)
    back_end.update([edge for edge in constraints if edge.accepted])
    return back_end


class _Layout:
    """The scans as they were last matched, prepared for the matcher."""

    def __init__(self, matcher: ScanMatcher) -> None:
        self.matcher = matcher
        self.prepared: list[Any] = []
        self._motions: list[Array] = []

    def take(self, scans: Sequence[Scan]) -> set[int]:
        """Take over the scans in which a beam has moved; return their numbers."""
        if not self.prepared:
            self.prepared = [self.matcher.prepare(scan) for scan in scans]
            self._motions = [scan.motion for scan in scans]
            return set(range(len(scans)))
        moved = {
            number
            for number, (scan, before) in enumerate(zip(scans, self._motions, strict=True))
            if float(np.abs(scan.motion - before)[:, :2].max()) > SETTLED
        }
        for number in moved:
            self.prepared[number] = self.matcher.prepare(scans[number])
            self._motions[number] = scans[number].motion
        return moved


def _again(constraint: Constraint, layout: _Layout, poses: Array) -> Constraint:
    if constraint.kind is ConstraintKind.ODOMETRY or constraint.refusal == "shape_differs":
        return constraint
    first, second = constraint.first, constraint.second
    initial = between(poses[first], poses[second])
    result = layout.matcher.match(
        layout.prepared[first], layout.prepared[second], initial, UNCERTAINTY
    )
    return matched(constraint, result)
