# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Refinement: what does not fit the whole graph is matched again, the scans made anew from it."""

# Deviation: the paper makes the newest reference scan anew, once, and leaves its constraints as
# they are. Laid out by the graph as it is in the end, scans that were refused match, and a false
# loop closure does not any more. What fits already is left to joint smoothing.

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.compounding import between, wrap
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.graph.graph_construction import matched
from msss_graphslam.core.graph.known_places import KNOWN_BETTER, hung_again
from msss_graphslam.core.matching.matchers import ScanMatcher
from msss_graphslam.core.scans.scan_correction import corrected_scan
from msss_graphslam.core.scans.trajectory_correction import closed_form
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Scan, TwistError

__all__ = ["Refined", "refine", "whole_graph"]

DOUBT = 7.81
"""Squared Mahalanobis distance that 5 % of true displacements exceed (three numbers)."""

UNCERTAINTY = np.diag([0.15**2, 0.15**2, 0.02**2])
"""How far off a pair's displacement may still be before it is matched again (3, 3)."""

REPORTED = 20
"""Constraints from one report of progress to the next."""

KEPT = 512
"""Scans made anew that are kept while they may be matched again: bounds the memory."""


@dataclass(frozen=True, slots=True)
class Refined:
    """The poses (n, 3) after refinement, and the constraints."""

    poses: Array
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
    """Match again what is doubtful, and optimise.

    ``scans`` are as dead reckoning laid them out, ``poses`` (n, 3) what the graph says so far.
    """
    layout = _Layout(scans, poses, known, matcher)
    edges: list[Constraint] = []
    for number, edge in enumerate(constraints):
        edges.append(_again(edge, layout, poses) if _doubtful(edge, poses) else edge)
        if number % REPORTED == 0:
            progress(number / len(constraints))
    edges = _held(constraints, edges)
    refined = whole_graph(poses, edges, config, divides=True).poses()
    progress(1.0)
    return Refined(refined, edges)


def _held(before: Sequence[Constraint], after: Sequence[Constraint]) -> list[Constraint]:
    """Return the constraints; a scan that has lost a match hangs on its predecessor again."""
    lost = {
        old.second
        for old, new in zip(before, after, strict=True)
        if old.accepted and not new.accepted
    }
    return [hung_again([edge])[0] if edge.second in lost else edge for edge in after]


def whole_graph(
    poses: Array,
    constraints: Sequence[Constraint],
    config: BackEndConfig,
    *,
    divides: bool = False,
) -> BackEnd:
    """Return the graph of all accepted constraints at once, begun at the poses (n, 3)."""
    back_end = BackEnd(config, divides=divides)
    for pose in poses:
        back_end.add_keyframe(pose)
    back_end.update([edge for edge in constraints if edge.accepted])
    return back_end


class _Layout:
    """The scans made anew and prepared for the matcher, when they are asked for."""

    def __init__(
        self,
        scans: Sequence[Scan],
        poses: Array,
        known: TwistError | None,
        matcher: ScanMatcher,
    ) -> None:
        self.matcher = matcher
        self._given = scans, poses, closed_form, known
        self.prepared = lru_cache(KEPT)(self._prepare)

    def _prepare(self, number: int) -> Any:
        return self.matcher.prepare(corrected_scan(number, *self._given))


def _doubtful(constraint: Constraint, poses: Array) -> bool:
    """Whether a match was refused, or does not fit the poses."""
    if constraint.kind is ConstraintKind.ODOMETRY or constraint.refusal == KNOWN_BETTER:
        return False
    error = between(poses[constraint.first], poses[constraint.second]) - constraint.relative_pose
    error[2] = wrap(error[2])
    distance = error @ np.linalg.solve(constraint.covariance, error)
    return not constraint.accepted or bool(distance > DOUBT)


def _again(constraint: Constraint, layout: _Layout, poses: Array) -> Constraint:
    first, second = constraint.first, constraint.second
    result = layout.matcher.match(
        layout.prepared(first),
        layout.prepared(second),
        between(poses[first], poses[second]),
        UNCERTAINTY,
    )
    return matched(constraint, result)
