# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A match of which the first guess may be far off: sought from several starts."""

# Deviation: Algorithm 4 matches a loop candidate from its guess alone. Where the way along a
# corridor was not observed the guess is metres off: a match then ends at whatever wall is near and
# looks alike, and the one that is right is not found.

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.matchers import ScanMatcher
from msss_graphslam.core.types import Array

__all__ = ["AMBIGUOUS", "match_widely"]

AMBIGUOUS = "ambiguous"
"""Refusal of a match beside which another one fits as well."""

BASIN = 2.0
"""From so far off a match is found [m]: the distance of starts."""

DEVIATIONS = 3.0
"""So many standard deviations of the guess are searched, to both sides."""

MOST = 6
"""Starts to a side; of a guess that is worse than this nothing better is to be had in time."""

APART = 16.3
"""Squared Mahalanobis distance that one in a thousand matches of the same place exceeds."""

SLACK = np.diag([0.15, 0.15, 0.02]) ** 2
"""How far apart two matches of the same place may be for how motion has bent the scans (3, 3)."""


def match_widely(
    matcher: ScanMatcher, reference: Any, current: Any, initial: Array, covariance: Array
) -> MatchResult:
    """Match as ``matcher`` does, but where the guess is wide from all starts along its long axis.

    What the most points support is taken; if by another displacement as many do, within what
    chance makes of so many points, it is refused. Along a corridor, where scans say nothing, every
    start is as good, and one is enough.
    """
    first = matcher.match(reference, current, initial, covariance)
    variances, axes = np.linalg.eigh(covariance[:2, :2])
    steps = min(int(DEVIATIONS * np.sqrt(max(variances[1], 0.0)) / BASIN), MOST)
    if not steps or not _may_be_another(first, axes[:, 1]):
        return first
    narrow = _narrowed(covariance, axes)
    found = [first]
    for step in (step for step in range(-steps, steps + 1) if step):
        start = initial + np.append(step * BASIN * axes[:, 1], 0.0)
        found.append(matcher.match(reference, current, start, narrow))
    best = max(found, key=_support)
    if not best.accepted:
        return first
    if _has_rival(best, found, min(len(reference.points), len(current.points))):
        return replace(best, refusal=AMBIGUOUS)
    if first.accepted and _alike(best, first):
        return first
    return matcher.match(reference, current, initial, covariance, best.relative_pose)


def _may_be_another(match: MatchResult, axis: Array) -> bool:
    """Whether another start can lead elsewhere: the match is refused, or says where it is."""
    if not match.accepted:
        return "overlap" in match.figures
    return bool(axis @ match.covariance[:2, :2] @ axis < BASIN**2)


def _narrowed(covariance: Array, axes: Array) -> Array:
    """Return the guess's covariance (3, 3) about one of the starts."""
    variances, _ = np.linalg.eigh(covariance[:2, :2])
    narrow = np.zeros((3, 3))
    narrow[:2, :2] = axes @ np.diag(np.minimum(variances, (0.5 * BASIN) ** 2)) @ axes.T
    narrow[2, 2] = covariance[2, 2]
    return narrow


def _support(match: MatchResult) -> float:
    return match.figures["overlap"] if match.accepted else -1.0


def _has_rival(best: MatchResult, found: Sequence[MatchResult], points: int) -> bool:
    share = best.figures["overlap"]
    chance = 2.0 * np.sqrt(2.0 * share * (1.0 - share) / max(points, 1))
    return any(_support(other) > share - chance and not _alike(best, other) for other in found)


def _alike(first: MatchResult, second: MatchResult) -> bool:
    """Whether two matches are one, as far as they themselves can say."""
    off = first.relative_pose - second.relative_pose
    off[2] = wrap(off[2])
    spread = first.covariance + second.covariance + SLACK
    return bool(off @ np.linalg.solve(spread, off) < APART)
