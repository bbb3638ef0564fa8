# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Front end, back end and refinement on the scans of a short simulated mission."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from small_mission import estimated, recorded

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import between, compose, wrap
from msss_graphslam.core.front_end import FrontEnd
from msss_graphslam.core.graph_slam import GraphSlam
from msss_graphslam.core.match_result import MatchResult
from msss_graphslam.core.matchers import LineMatcher
from msss_graphslam.core.recipes import ESTIMATORS, Recipe
from msss_graphslam.core.refinement import refine
from msss_graphslam.core.trajectory_correction import closed_form
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Scan

CONFIGURATION = Configuration()
FULL, CHEN = ESTIMATORS["full"], ESTIMATORS["chen2015"]


def scans() -> tuple[Scan, ...]:
    """The mission's scans as dead reckoning lays them out."""
    return estimated("dead_reckoning").first_scans


def true_poses() -> Array:
    """The truth (n, 3) at every keyframe."""
    truth = recorded().truth
    at = np.searchsorted(truth.stamps_ns, [scan.stamp_ns for scan in scans()])
    return truth.planar[at]


def slam_of(recipe: Recipe, count: int = 99) -> GraphSlam:
    slam = GraphSlam(CONFIGURATION, recipe)
    for scan in scans()[:count]:
        slam.add_scan(scan)
    return slam


def pose_errors(poses: Array) -> Array:
    """The position errors (n,) of poses that begin at the first true one."""
    found, true = between(poses[0], poses), between(true_poses()[0], true_poses())
    return np.asarray(np.linalg.norm(found[:, :2] - true[: len(found), :2], axis=1))


def kinds(constraints: list[Constraint]) -> list[str]:
    return [str(constraint.kind) for constraint in constraints]


class Refusing:
    """A matcher that never finds anything."""

    def __init__(self, _: Matching) -> None:
        self.asked = 0

    def prepare(self, scan: Scan) -> Scan:
        return scan

    def match(self, reference: Any, current: Any, initial: Array, spread: Array) -> MatchResult:  # noqa: ARG002
        self.asked += 1
        return MatchResult(initial, spread, "too_little_overlap")


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
    slam = slam_of(ESTIMATORS[name], 1)
    slam.add_scan(scans()[1])
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


@pytest.mark.parametrize("recipe", [FULL, CHEN])
def test_a_correction_lays_the_last_scan_but_one_out_anew(recipe: Recipe) -> None:
    front_end = FrontEnd(CONFIGURATION, recipe)
    first, second = scans()[:2]
    front_end.add_scan(first)
    front_end.correct(front_end.poses, 1e-12 * np.eye(3))
    front_end.add_scan(second)
    poses = front_end.poses.copy()
    step = between(first.odometry, second.odometry) + np.array([0.2, 0.1, 0.05])
    poses[1] = compose(poses[0], step)
    covariance = np.diag([0.1, 0.2, 0.01])
    front_end.correct(poses, covariance)
    node = front_end.nodes[0]
    target = between(poses[0], poses[1])
    share = len(first.motion) / (len(first.motion) + 1)
    np.testing.assert_allclose(node.scan.motion[-1][:2], share * target[:2], atol=0.05)
    assert node.first_scan is first
    np.testing.assert_array_equal(front_end.nodes[1].covariance, covariance)
    np.testing.assert_array_equal(front_end.poses, poses)


def test_the_pose_ahead_is_where_the_scan_ends() -> None:
    slam = slam_of(CHEN, 5)
    pose, odometry = slam.front_end.pose_ahead()
    last = scans()[4]
    np.testing.assert_allclose(odometry, compose(last.odometry, last.end_motion))
    expected = compose(slam.front_end.poses[-1], last.end_motion)
    np.testing.assert_allclose(pose, expected, atol=1e-12)


def test_the_pose_ahead_is_near_the_next_keyframe() -> None:
    slam = slam_of(FULL, 8)
    pose, _ = slam.front_end.pose_ahead()
    away = between(true_poses()[0], true_poses()[8])
    found = between(slam.front_end.poses[0], pose)
    np.testing.assert_allclose(found[:2], away[:2], atol=0.2)


def test_keyframes_come_with_positive_covariances_that_grow_from_nothing() -> None:
    keyframes = slam_of(FULL).keyframes()
    spreads = [float(np.trace(keyframe.covariance[:2, :2])) for keyframe in keyframes]
    assert spreads[0] < 1e-9
    assert all(spread > spreads[0] for spread in spreads[1:])
    assert all(np.linalg.eigvalsh(keyframe.covariance)[0] > 0.0 for keyframe in keyframes)


def refined(slam: GraphSlam, reports: list[float]) -> tuple[Array, list[Constraint]]:
    result = refine(
        slam.front_end.nodes,
        slam.front_end.poses,
        slam.constraints,
        LineMatcher(CONFIGURATION.matching),
        CONFIGURATION.back_end,
        reports.append,
    )
    np.testing.assert_array_equal(result.back_end.poses(), result.poses)
    return result.poses, result.constraints


def test_refinement_makes_the_keyframes_better() -> None:
    slam = slam_of(FULL)
    before = pose_errors(slam.front_end.poses).mean()
    reports: list[float] = []
    poses, constraints = refined(slam, reports)
    assert pose_errors(poses).mean() < 0.9 * before
    assert reports == sorted(reports)
    assert reports[-1] <= 1.0
    for old, new in zip(slam.constraints, constraints, strict=True):
        assert (old.kind, old.first, old.second) == (new.kind, new.first, new.second)
        if old.kind is ConstraintKind.ODOMETRY or old.refusal == "shape_differs":
            assert new is old


def test_refinement_lays_the_scans_out_by_the_poses() -> None:
    slam = slam_of(FULL)
    poses, _ = refined(slam, [])
    nodes = slam.front_end.nodes
    for number, node in enumerate(nodes[:-1]):
        target = between(poses[number], poses[number + 1])
        step = between(node.scan.motion[-1], target)
        assert np.hypot(*step[:2]) < 0.03
        assert abs(wrap(step[2])) < 0.02
    assert all(node.first_scan is scan for node, scan in zip(nodes, scans(), strict=True))


def test_what_is_refined_stays() -> None:
    slam = slam_of(FULL)
    slam.refine(lambda _: None)
    once = slam.front_end.poses
    slam.refine(lambda _: None)
    moved = np.linalg.norm((slam.front_end.poses - once)[:, :2], axis=1)
    assert moved.mean() < 0.02


@pytest.mark.parametrize(("recipe", "count"), [(CHEN, 5), (FULL, 1), (FULL, 0)])
def test_there_may_be_nothing_to_refine(recipe: Recipe, count: int) -> None:
    slam = slam_of(recipe, count)
    poses, constraints = slam.front_end.poses, slam.constraints
    slam.refine(lambda _: pytest.fail("nothing was to be done"))
    assert slam.front_end.poses is poses
    assert slam.constraints is constraints


def test_closed_form_is_the_solver_of_full_alone() -> None:
    assert FULL.solver is closed_form
    assert CHEN.solver is not closed_form
