# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which closures the way between their keyframes excludes, and the way that goes on with them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.graph.constraint_defects import defect
from msss_graphslam.core.graph.known_places import KNOWN_BETTER
from msss_graphslam.core.graph.layout_slack import LayoutSlack
from msss_graphslam.core.graph.odometry_chain import LAG, OdometryChain
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["CONTRADICTS", "STRETCH", "ClosureGate"]

CONTRADICTS = "contradicts_odometry"
"""Refusal of a closure that the way between its keyframes excludes."""

STRETCH = 2 * LAG
"""Closures whose keyframes are so near to each other in number are of the same two stretches."""

COMPANY = 0.5
"""Share of the bound for closures as far off as one of the same stretches that was just excluded.

The error of the way is common to them all, and so is what made them false: where one is beyond
what a thousandth of the true ones exceed, the others have to be within what one in twenty does.
"""


@dataclass(frozen=True, slots=True)
class _Judged:
    """A closure and how far it is ``off`` (3,) the way, in the axes that the way begins with."""

    closure: Constraint
    off: Array

    def is_of_the_stretches(self, other: "_Judged") -> bool:
        """Whether both its keyframes lie near those of an earlier one."""
        one, earlier = self.closure, other.closure
        return one.second - earlier.second <= STRETCH and abs(one.first - earlier.first) <= STRETCH

    def distance(self, other: "_Judged", slack: Array) -> float:
        """Return by how much the two are off differently, as a squared Mahalanobis distance."""
        apart = self.off - other.off
        apart[2] = wrap(apart[2])
        spread = self.closure.covariance + other.closure.covariance + slack
        return float(apart @ np.linalg.solve(spread, apart))


class ClosureGate:
    """The way so far; ``bound`` is the largest squared Mahalanobis distance of a closure from it.

    Its length is the number of keyframes.
    """

    def __init__(self, bound: float) -> None:
        """Begin with the first keyframe of all."""
        self._bound = bound
        self._chain = OdometryChain()
        self._slack = self._slack_before = LayoutSlack()
        self._excluded: list[_Judged] = []

    @property
    def slack(self) -> Array:
        """How far off matches are for how their scans are bent, as far as it is known (3, 3)."""
        return self._slack.covariance

    def pass_through(self, tried: Sequence[Constraint]) -> list[Constraint]:
        """Go on to a further keyframe; return the constraints that end at it, judged.

        The nearest closures come first: those that hold belong to the way that judges the others.
        """
        steps = _steps(tried, len(self))
        self._slack_before = self._slack
        self._chain.append(steps[0] if steps else None)
        share = 1.0 / max(sum(self._is_near_match(edge) for edge in tried), 1)
        for step in steps[1:]:
            self._chain.take_in(step, share if _is_match(step) else 1.0)
        judged = list(tried)
        for place in sorted(range(len(tried)), key=lambda number: -tried[number].first):
            if _is_loop(tried[place]) and self._is_usable(tried[place]):
                judged[place] = self._judged(tried[place], share)
        return judged

    def drop_newest(self) -> None:
        """Take the newest keyframe back, as if it had not been there; once in a row."""
        self._chain.drop_newest()
        self._slack = self._slack_before
        self._excluded = [other for other in self._excluded if other.closure.second < len(self)]

    def __len__(self) -> int:
        return len(self._chain)

    def _judged(self, closure: Constraint, share: float) -> Constraint:
        off, spread = self._chain.deviation(closure)
        distance = float(off @ np.linalg.solve(spread + self.slack, off))
        figures = {**closure.figures, "contradiction": distance}
        one = _Judged(closure, self._chain.turned(closure.first, off))
        in_company = self._is_in_company(one)
        if distance > self._bound:
            self._exclude(one)
        if distance > self._bound * (COMPANY if in_company else 1.0):
            return replace(closure, refusal=CONTRADICTS, figures=figures)
        if self._is_near_match(closure):
            self._slack = self._slack.with_match(off)
            self._chain.take_in(closure, share)
        return replace(closure, figures=figures)

    def _is_in_company(self, one: _Judged) -> bool:
        """Whether one of the same stretches that is off by the same was excluded not long ago."""
        return any(
            one.is_of_the_stretches(other) and one.distance(other, self.slack) < self._bound
            for other in self._excluded
        )

    def _exclude(self, one: _Judged) -> None:
        newest = one.closure.second
        recent = [other for other in self._excluded if newest - other.closure.second <= STRETCH]
        self._excluded = [*recent, one]

    def _is_near_match(self, edge: Constraint) -> bool:
        return _is_match(edge) and self._is_usable(edge) and self._chain.reaches(edge)

    def _is_usable(self, edge: Constraint) -> bool:
        return _is_known(edge) and edge.first < edge.second and not defect(edge, len(self))


def _steps(tried: Sequence[Constraint], number: int) -> list[Constraint]:
    """Return the edges from the keyframe before: odometry, then the match."""
    return [
        edge
        for edge in tried
        if _is_known(edge)
        and not _is_loop(edge)
        and (edge.first, edge.second) == (number - 1, number)
        and not defect(edge, number + 1)
    ]


def _is_known(edge: Constraint) -> bool:
    return edge.accepted or edge.refusal == KNOWN_BETTER


def _is_match(edge: Constraint) -> bool:
    return edge.kind is not ConstraintKind.ODOMETRY


def _is_loop(edge: Constraint) -> bool:
    return edge.kind is ConstraintKind.LOOP
