# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Consecutive scans are matched again and again, each time laid out by the match before."""

# Deviation: in the paper they are matched once, as dead reckoning has laid them out. A scan bent
# by a wrong speed matches at a wrong place; laid out by what it shows, both come out right.

from collections.abc import Sequence

import numpy as np

from msss_graphslam.core.compounding import between
from msss_graphslam.core.graph.graph_construction import consecutive_constraint
from msss_graphslam.core.graph.keyframes import Node
from msss_graphslam.core.graph.scan_layout import ReckonedStep, ScanLayout
from msss_graphslam.core.matching.matchers import ScanMatcher
from msss_graphslam.core.types import Array, Constraint

__all__ = ["match_in_rounds"]

ROUNDS = 6
"""Most matches of consecutive scans: each corrects their layout for the next."""

SETTLED, SETTLED_ANGLE = 0.01, 0.001
"""Rounds end when the displacement changes by less than this [m], [rad]."""


def match_in_rounds(
    nodes: Sequence[Node], step: ReckonedStep, matcher: ScanMatcher, layout: ScanLayout
) -> Constraint:
    """Match the newest node with the one before, and lay both out as the best match says."""
    relative, covariance = step.relative_pose, step.covariance
    constraint = consecutive_constraint(nodes, relative, covariance, matcher)
    accepted: list[Constraint] = []
    for _ in range(ROUNDS - 1):
        if not constraint.accepted:
            break
        accepted.append(constraint)
        layout.learn(nodes[-2], nodes[-1], constraint)
        before = constraint.relative_pose
        # Both scans are laid out by it: the first guess may be out of the basin by now.
        constraint = consecutive_constraint(nodes, relative, covariance, matcher, before)
        if _settled(before, constraint.relative_pose):
            break
    if accepted and not constraint.accepted:
        # The rounds led astray, as where the vehicle began to turn and no gyro said so.
        constraint = max(accepted, key=lambda entry: entry.figures.get("overlap", 0.0))
        layout.learn(nodes[-2], nodes[-1], constraint)
    if accepted:
        layout.settle(nodes[-1])
    return layout.widened(constraint)


def _settled(before: Array, after: Array) -> bool:
    change = np.abs(between(before, after))
    return bool(max(change[0], change[1]) < SETTLED and change[2] < SETTLED_ANGLE)
