# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scan matching and pose graph construction, Algorithm 4."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from msss_graphslam.core.compounding import between, between_covariance
from msss_graphslam.core.graph.constraint_defects import defect
from msss_graphslam.core.graph.data_association import Candidate
from msss_graphslam.core.graph.keyframes import Node
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.matchers import ScanMatcher
from msss_graphslam.core.matching.wide_search import match_widely
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["consecutive_constraint", "loop_constraints", "odometry_constraint"]


def odometry_constraint(
    nodes: Sequence[Node], relative_pose: Array, covariance: Array
) -> Constraint:
    """Return the edge U_i of equation 1 from the last keyframe but one to the last."""
    last = len(nodes) - 1
    # A copy: the pose may be the last of a whole motion, which a day of edges would keep.
    return Constraint(ConstraintKind.ODOMETRY, last - 1, last, relative_pose.copy(), covariance)


def consecutive_constraint(
    nodes: Sequence[Node],
    initial: Array,
    initial_covariance: Array,
    matcher: ScanMatcher,
    start: Array | None = None,
) -> Constraint:
    """Algorithm 4, lines 3 to 7: match the last keyframe with the one before.

    ``start`` (3,) is what an earlier match of the two has found, None where there was none.
    """
    last = len(nodes) - 1
    reference, current = nodes[last - 1].prepared, nodes[last].prepared
    result = matcher.match(reference, current, initial, initial_covariance, start)
    guess = Constraint(ConstraintKind.CONSECUTIVE, last - 1, last, initial, initial_covariance)
    return _matched(guess, result)


def loop_constraints(
    nodes: Sequence[Node],
    poses: Array,
    candidates: Sequence[Candidate],
    matcher: ScanMatcher,
    *,
    widely: bool = False,
) -> list[Constraint]:
    """Algorithm 4, lines 8 to 13: match the last keyframe with every associated one.

    ``poses`` (n, 3) are those of all nodes. Candidates that were refused stay refused. ``widely``
    searches all that the covariance of a guess leaves open.
    """
    match = partial(match_widely, matcher) if widely else matcher.match
    constraints = []
    current = len(nodes) - 1
    for candidate in candidates:
        node = nodes[candidate.index]
        pose = poses[candidate.index]
        figures = {"mahalanobis": candidate.mahalanobis}
        if candidate.shape_distance is not None:
            figures["shape_distance"] = candidate.shape_distance
        initial = between(pose, poses[current])  # line 9
        covariance = between_covariance(  # line 10
            pose, node.covariance, poses[current], nodes[current].covariance
        )
        guess = Constraint(
            ConstraintKind.LOOP,
            candidate.index,
            current,
            initial,
            covariance,
            candidate.refusal,
            figures,
        )
        if candidate.accepted:
            result = match(node.prepared, nodes[current].prepared, initial, covariance)
            guess = _matched(guess, result)
        constraints.append(guess)
    return constraints


def _matched(constraint: Constraint, result: MatchResult) -> Constraint:
    """Return the constraint with what a match says of it, refused if no graph could take it."""
    found = replace(
        constraint,
        relative_pose=np.asarray(result.relative_pose),
        covariance=np.asarray(result.covariance),
        refusal=result.refusal,
        figures={**constraint.figures, **result.figures},
    )
    return found if result.refusal else replace(found, refusal=defect(found, found.second + 1))
