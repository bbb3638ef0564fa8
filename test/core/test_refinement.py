# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from made_scans import standing_scan
from synthetic_scans import basin

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between
from msss_graphslam.core.graph.known_places import KNOWN_BETTER
from msss_graphslam.core.graph.refinement import DOUBT, KEPT, REPORTED, Refined, refine
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.matchers import LineMatcher
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Scan

CONFIGURATION = Configuration()
ODOMETRY, CONSECUTIVE, LOOP = ConstraintKind
TRUTH = np.array(
    [[0.0, 0.0, 0.0], [1.0, 0.2, 0.05], [2.0, 0.4, 0.1], [3.0, 0.4, 0.0], [4.0, 0.2, -0.1]]
)
DEVIATIONS = np.array([0.02, 0.02, 0.004])
COVARIANCE = np.diag(DEVIATIONS**2)


def scans() -> list[Scan]:
    rng = np.random.default_rng(7)
    walls = [np.add(wall, [0.0, 5.0]) for wall in basin(np.random.default_rng(5))]
    return [standing_scan(walls, pose, pose, number, rng) for number, pose in enumerate(TRUTH)]


def edge(first: int, second: int, kind: ConstraintKind = LOOP, off: float = 0.0) -> Constraint:
    """A constraint that is wrong by ``off`` standard deviations along x."""
    relative = between(TRUTH[first], TRUTH[second])
    relative[0] += off * DEVIATIONS[0]
    return Constraint(kind, first, second, relative, COVARIANCE)


def graph() -> list[Constraint]:
    steps = [edge(number, number + 1, CONSECUTIVE) for number in range(4)]
    return steps + [edge(*ends) for ends in combinations(range(5), 2) if ends[1] - ends[0] > 1]


class Counting(LineMatcher):
    """Notes what it is asked."""

    def __init__(self) -> None:
        super().__init__(CONFIGURATION.matching)
        self.prepared: list[int] = []

    def prepare(self, scan: Scan) -> object:
        self.prepared.append(scan.stamp_ns)
        return super().prepare(scan)


def refined(
    constraints: Sequence[Constraint],
    poses: Array = TRUTH,
    matcher: LineMatcher | None = None,
    reports: list[float] | None = None,
) -> Refined:
    return refine(
        scans(),
        poses,
        constraints,
        None,
        matcher or Counting(),
        CONFIGURATION.back_end,
        [].append if reports is None else reports.append,
    )


def test_what_fits_stays_as_it_is_and_costs_nothing() -> None:
    constraints, matcher = graph(), Counting()
    found = refined(constraints, matcher=matcher)
    assert all(new is old for new, old in zip(found.constraints, constraints, strict=True))
    assert matcher.prepared == []
    np.testing.assert_allclose(found.poses, TRUTH, atol=1e-6)


@pytest.mark.parametrize(("share", "again"), [(0.99, False), (1.01, True)])
def test_how_badly_a_constraint_may_fit(share: float, again: bool) -> None:
    constraints = [*graph(), edge(0, 3, off=share * np.sqrt(DOUBT))]
    assert (refined(constraints).constraints[-1] is not constraints[-1]) is again


def test_a_false_loop_closure_is_withdrawn_or_put_right() -> None:
    wrong = replace(edge(0, 4), relative_pose=np.array([-6.0, 3.0, 1.0]))
    found = refined([*graph(), wrong])
    put_right = found.constraints[-1]
    assert put_right.accepted
    np.testing.assert_allclose(put_right.relative_pose, between(TRUTH[0], TRUTH[4]), atol=0.05)
    np.testing.assert_allclose(found.poses, TRUTH, atol=0.05)


def test_what_was_refused_has_another_chance() -> None:
    refused = replace(edge(0, 4), refusal="too_little_overlap")
    found = refined([*graph(), refused]).constraints[-1]
    assert found.accepted
    np.testing.assert_allclose(found.relative_pose, between(TRUTH[0], TRUTH[4]), atol=0.05)


@pytest.mark.parametrize(
    "constraint",
    [
        replace(edge(0, 4, off=50.0), refusal=KNOWN_BETTER),
        edge(0, 1, ODOMETRY, off=50.0),
    ],
    ids=["known_better", "odometry"],
)
def test_what_no_match_is_to_change_stays(constraint: Constraint) -> None:
    assert refined([*graph(), constraint]).constraints[-1] is constraint


def test_a_turn_is_compared_the_short_way_round() -> None:
    constraint = edge(0, 4)
    whole_turn = np.array([0.0, 0.0, 2.0 * np.pi])
    turned = replace(constraint, relative_pose=constraint.relative_pose + whole_turn)
    assert refined([*graph(), turned]).constraints[-1] is turned


def test_a_scan_is_made_anew_once() -> None:
    constraints, matcher = [edge(0, number, off=20.0) for number in (2, 3, 4)], Counting()
    refined(graph()[:4] + constraints, matcher=matcher)
    assert len(matcher.prepared) == len(set(matcher.prepared)) == 4
    assert KEPT >= 4


def test_progress_is_told_now_and_then_and_at_the_end() -> None:
    told: list[float] = []
    refined(graph() * REPORTED, reports=told)
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert 2 < len(told) <= len(graph()) + 1


def located() -> list[Constraint]:
    """The last keyframe hangs on loops alone."""
    return [
        replace(entry, refusal=KNOWN_BETTER) if (entry.first, entry.second) == (3, 4) else entry
        for entry in graph()
    ]


def test_what_a_known_place_leaves_out_stays_out() -> None:
    constraints, matcher = located(), Counting()
    found = refined(constraints, matcher=matcher)
    assert all(new is old for new, old in zip(found.constraints, constraints, strict=True))
    assert matcher.prepared == []


class Refusing(Counting):
    """Finds no match at all."""

    def match(self, *arguments: Any) -> MatchResult:
        return replace(super().match(*arguments), refusal="too_little_overlap")


def test_a_scan_that_loses_a_match_hangs_on_its_predecessor_again() -> None:
    """Also if it has lost all that held it."""
    wrong = [
        replace(entry, relative_pose=entry.relative_pose + np.array([5.0, 0.0, 0.0]))
        if entry.second == 4 and entry.accepted
        else entry
        for entry in located()
    ]
    found = refined(wrong, matcher=Refusing())
    ends = {(entry.first, entry.second) for entry in found.constraints if entry.accepted}
    assert ends == {
        (first, second) for first, second in combinations(range(5), 2) if second < 4
    } | {(3, 4)}
    np.testing.assert_allclose(found.poses, TRUTH, atol=1e-6)
