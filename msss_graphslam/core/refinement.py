# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Refinement: all scans made anew from the corrected trajectory, every edge matched again."""

# Deviation: the paper makes the newest reference scan anew, once. The motion inside the scans is
# the largest error left; laid out by the optimised graph they match better, until it settles.

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.back_end import BackEnd
from msss_graphslam.core.compounding import between
from msss_graphslam.core.graph_construction import Node, matched
from msss_graphslam.core.matchers import ScanMatcher
from msss_graphslam.core.scan_generation import lay_out
from msss_graphslam.core.trajectory_correction import closed_form, correct_motion
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["Refined", "refine"]

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
    nodes: Sequence[Node],
    poses: Array,
    constraints: Sequence[Constraint],
    matcher: ScanMatcher,
    config: BackEndConfig,
    progress: Callable[[float], None],
) -> Refined:
    """Lay out, match and optimise until the poses settle; the nodes' scans are replaced."""
    edges, moved_scans = list(constraints), set(range(len(nodes)))
    _lay_out_moved(nodes, poses, matcher)
    for number in range(PASSES):
        edges = [
            _again(edge, nodes, poses, matcher)
            if moved_scans & {edge.first, edge.second}
            else edge
            for edge in edges
        ]
        back_end = BackEnd(config)
        for pose in poses:
            back_end.add_keyframe(pose)
        poses = back_end.update([edge for edge in edges if edge.accepted])
        moved_scans = _lay_out_moved(nodes, poses, matcher)
        progress((number + 1) / PASSES)
        if not moved_scans:
            break
    return Refined(poses, back_end, edges)


def _lay_out_moved(nodes: Sequence[Node], poses: Array, matcher: ScanMatcher) -> set[int]:
    """Make anew the scans in which the poses have changed the motion; return their numbers."""
    moved = set()
    for number, (node, following) in enumerate(pairwise(nodes)):
        scan = node.first_scan
        end = between(scan.odometry, following.first_scan.odometry)
        target = between(poses[number], poses[number + 1])
        motion = correct_motion(scan.motion, end, target, closed_form).poses
        if float(np.abs(motion - node.scan.motion)[:, :2].max()) > SETTLED:
            node.scan = lay_out(scan, motion, node.scan.twist_covariance)
            node.prepared = matcher.prepare(node.scan)
            moved.add(number)
    return moved


def _again(
    constraint: Constraint, nodes: Sequence[Node], poses: Array, matcher: ScanMatcher
) -> Constraint:
    if constraint.kind is ConstraintKind.ODOMETRY or constraint.refusal == "shape_differs":
        return constraint
    first, second = constraint.first, constraint.second
    initial = between(poses[first], poses[second])
    result = matcher.match(nodes[first].prepared, nodes[second].prepared, initial, UNCERTAINTY)
    return matched(constraint, result)
