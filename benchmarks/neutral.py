# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What stands in for a part of ``full`` that is taken out: the same call, to no effect."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.matchers import ScanMatcher
from msss_graphslam.core.scans.motion_feedback import MotionFeedback
from msss_graphslam.core.smoothing.joint_smoothing import Smoothed
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Scan

__all__ = ["NoFeedback", "match_once", "no_chance", "preview", "smooth", "without_odometry"]

_WEAKNESS = 1e6
_add_scan = FrontEnd.add_scan


class NoFeedback(MotionFeedback):
    """A motion feedback that learns nothing."""

    def update(self, offset: Array, covariance: Array) -> None:
        """Leave everything as it is."""
        del offset, covariance


def match_once(
    matcher: ScanMatcher, reference: Any, current: Any, initial: Array, covariance: Array
) -> MatchResult:
    """Match from the guess alone."""
    return matcher.match(reference, current, initial, covariance)


def no_chance(*echoes: Any) -> float:
    """Take no chain of echoes for one of chance."""
    del echoes
    return 1.0


def preview(part: Scan, *others: Any) -> None:
    """See nothing in a part of a turn."""
    del part, others


def smooth(scans: Sequence[Scan], poses: Array, last_twist: Array, *others: Any) -> Smoothed:
    """Return the poses as they are; of their covariances nothing is said."""
    del scans, others
    unknown = np.full((len(poses), 3, 3), np.nan)
    return Smoothed(poses, unknown, last_twist, np.full((3, 3), np.nan))


def without_odometry(front_end: FrontEnd, scan: Scan) -> list[Constraint]:
    """Return a new keyframe's constraints; beside a match its odometry counts next to nothing."""
    tried = _add_scan(front_end, scan)
    matched = any(edge.accepted and edge.kind is ConstraintKind.CONSECUTIVE for edge in tried)
    return [_weak(edge) if matched else edge for edge in tried]


def _weak(edge: Constraint) -> Constraint:
    if edge.kind is not ConstraintKind.ODOMETRY:
        return edge
    return replace(edge, covariance=_WEAKNESS * edge.covariance)
