# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Front end and back end on the scans of a short simulated mission."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from short_slam import CHEN, CONFIGURATION, FULL, kinds, slam_of, true_poses
from small_mission import estimated, scans
from stub_matcher import StubMatcher

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Array, Constraint, ConstraintKind


class Refusing(StubMatcher):
    """A matcher that never finds anything."""

    def __init__(self, _: Matching) -> None:
        pass

    def answer(self, initial: Array, covariance: Array, _: Array | None) -> MatchResult:
        return MatchResult(initial, covariance, "too_little_overlap")


def test_the_first_scan_hangs_on_nothing() -> None:
    front_end = FrontEnd(CONFIGURATION, FULL)
    assert front_end.add_scan(scans()[0]) == []
    np.testing.assert_array_equal(front_end.poses, scans()[0].odometry[None])
    np.testing.assert_array_equal(front_end.offset, np.zeros(3))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("dead_reckoning", ["odometry"]),
        ("uspic", ["consecutive"]),
        ("chen2015", ["consecutive"]),
        ("full", ["odometry", "consecutive"]),
    ],
)
def test_the_second_scan_hangs_on_the_first(name: str, expected: list[str]) -> None:
    slam = slam_of(ESTIMATORS[name], 2)
    assert kinds(slam.constraints)[: len(expected)] == expected
    assert "loop" not in kinds(slam.constraints)[: len(expected)]
    assert (slam.constraints[0].first, slam.constraints[0].second) == (0, 1)


@pytest.mark.parametrize("name", ["uspic", "chen2015", "full"])
def test_where_matching_fails_the_odometry_holds_the_keyframe(name: str) -> None:
    slam = slam_of(replace(ESTIMATORS[name], matcher=Refusing), 4)
    reckoned = np.array([scan.odometry for scan in scans()[:4]])
    np.testing.assert_allclose(slam.front_end.poses[:, :2], reckoned[:, :2], atol=1e-6)
    accepted = [entry for entry in slam.constraints if entry.accepted]
    assert kinds(accepted) == ["odometry"] * 3
    refused = [entry for entry in slam.constraints if entry.kind is ConstraintKind.CONSECUTIVE]
    assert [entry.refusal for entry in refused] == ["too_little_overlap"] * 3


def edge_errors(constraints: Iterable[Constraint], kind: ConstraintKind) -> Array:
    true = true_poses()
    return np.array(
        [
            np.hypot(*(entry.relative_pose - between(true[entry.first], true[entry.second]))[:2])
            for entry in constraints
            if entry.kind is kind
        ]
    )


def test_matches_and_the_odometry_that_learns_from_them_beat_dead_reckoning() -> None:
    reckoned = estimated("dead_reckoning").constraints
    before = edge_errors(reckoned, ConstraintKind.ODOMETRY).mean()
    constraints = slam_of(FULL).constraints
    for kind in (ConstraintKind.CONSECUTIVE, ConstraintKind.ODOMETRY):
        assert edge_errors(constraints, kind).mean() < 0.5 * before
    assert edge_errors(constraints, ConstraintKind.LOOP).max() < 0.2


def test_loops_are_looked_for_from_the_matched_pose() -> None:
    front_end = slam_of(FULL, 5).front_end
    consecutive = front_end.add_scan(scans()[5])[1]
    assert consecutive.accepted
    expected = compose(front_end.poses[-2], consecutive.relative_pose)
    np.testing.assert_allclose(front_end.poses[-1], expected)


def test_loops_join_the_newest_with_earlier_ones() -> None:
    slam = slam_of(FULL)
    loops = [entry for entry in slam.constraints if entry.kind is ConstraintKind.LOOP]
    assert loops
    assert all(entry.second - entry.first > 1 for entry in loops)
    tried = [sum(entry.second == second for entry in loops) for second in range(len(scans()))]
    assert max(tried) <= CONFIGURATION.association.most


def test_the_learned_offset_is_what_dead_reckoning_has_wrong() -> None:
    slam = slam_of(FULL)
    true, reckoned = true_poses(), np.array([scan.odometry for scan in scans()])
    seconds = (scans()[-1].stamp_ns - scans()[-4].stamp_ns) * 1e-9
    paths = [
        np.linalg.norm(np.diff(poses[-4:, :2], axis=0), axis=1).sum() for poses in (true, reckoned)
    ]
    assert slam.front_end.offset[0] == pytest.approx((paths[0] - paths[1]) / seconds, abs=0.01)
    np.testing.assert_array_equal(slam_of(CHEN).front_end.offset, np.zeros(3))
