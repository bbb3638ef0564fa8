# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Refinement: all scans made anew from the corrected trajectory, every edge matched again."""

# Deviation: the paper makes the newest reference scan anew, once. The motion inside the scans is
# the largest error left; laid out by the optimised graph they match better, until it settles.

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.back_end import BackEnd
from msss_graphslam.core.compounding import between
from msss_graphslam.core.graph_construction import Node
from msss_graphslam.core.matchers import ScanMatcher
from msss_graphslam.core.scan_generation import lay_out
from msss_graphslam.core.trajectory_correction import closed_form, correct_motion
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["Refined", "refine"]

PASSES = 4
SETTLED = 0.005
"""Passes end when no keyframe moves farther than this [m]."""

UNCERTAINTY = np.diag([0.25**2, 0.25**2, 0.035**2])
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
    edges = list(constraints)
    for number in range(PASSES):
        _lay_out_all(nodes, poses, matcher)
        edges = [_again(entry, nodes, poses, matcher) for entry in edges]
        back_end = BackEnd(config)
        for pose in poses:
            back_end.add_keyframe(pose)
        refined = back_end.update([entry for entry in edges if entry.accepted])
        moved = float(np.hypot(*(refined - poses)[:, :2].T).max())
        poses = refined
        progress((number + 1) / PASSES)
        if moved < SETTLED:
            break
    _lay_out_all(nodes, poses, matcher)
    return Refined(poses, back_end, edges)


def _lay_out_all(nodes: Sequence[Node], poses: Array, matcher: ScanMatcher) -> None:
    for number, (node, following) in enumerate(pairwise(nodes)):
        scan = node.first_scan
        end = between(scan.odometry, following.first_scan.odometry)
        target = between(poses[number], poses[number + 1])
        motion = correct_motion(scan.motion, end, target, closed_form).poses
        node.scan = lay_out(scan, motion, node.scan.twist_covariance)
        node.prepared = matcher.prepare(node.scan)


def _again(
    constraint: Constraint, nodes: Sequence[Node], poses: Array, matcher: ScanMatcher
) -> Constraint:
    if constraint.kind is ConstraintKind.ODOMETRY or constraint.refusal == "shape_differs":
        return constraint
    first, second = constraint.first, constraint.second
    initial = between(poses[first], poses[second])
    result = matcher.match(nodes[first].prepared, nodes[second].prepared, initial, UNCERTAINTY)
    return replace(
        constraint,
        relative_pose=result.relative_pose,
        covariance=result.covariance,
        refusal=result.refusal,
        figures={**constraint.figures, **result.figures},
    )
