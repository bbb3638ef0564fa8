# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Front end, back end and refinement on the scans of a short simulated mission."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from small_mission import estimated, recorded

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.graph.graph_slam import GraphSlam
from msss_graphslam.core.graph.refinement import Refined, refine, whole_graph
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.matchers import LineMatcher
from msss_graphslam.core.recipes import ESTIMATORS, Recipe
from msss_graphslam.core.scans.trajectory_correction import closed_form
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, GraphPoses, Scan

CONFIGURATION = Configuration()
FULL, CHEN = ESTIMATORS["full"], ESTIMATORS["chen2015"]


@cache
def scans() -> tuple[Scan, ...]:
    """The mission's scans as dead reckoning lays them out."""
    return tuple(estimated("dead_reckoning").first_scans)


def true_poses() -> Array:
    """The truth (n, 3) at every keyframe."""
    truth = recorded().truth
    at = np.searchsorted(truth.stamps_ns, [scan.stamp_ns for scan in scans()])
    return truth.planar[at]


@dataclass(frozen=True)
class Slam:
    """A front end that has seen scans, and the constraints tried."""

    front_end: FrontEnd
    constraints: list[Constraint]


def slam_of(recipe: Recipe, count: int = 99) -> Slam:
    slam = GraphSlam(CONFIGURATION, recipe)
    tried = [entry for scan in scans()[:count] for entry in slam.add_scan(scan)]
    return Slam(slam.front_end, tried)


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

    def match(
        self,
        reference: Any,  # noqa: ARG002
        current: Any,  # noqa: ARG002
        initial: Array,
        spread: Array,
        start: Array | None = None,  # noqa: ARG002
    ) -> MatchResult:
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


def test_the_correction_is_in_the_middle_of_the_scan() -> None:
    slam = slam_of(CHEN, 5)
    correction, last = slam.front_end.correction(), scans()[4]
    middle = len(last.motion) // 2
    expected = compose(slam.front_end.poses[-1], last.motion[middle])
    np.testing.assert_allclose(correction.pose, expected, atol=1e-12)
    assert correction.stamp_ns == last.beam_stamps_ns[middle]
    np.testing.assert_array_equal(correction.twist_error.mean, np.zeros(3))
    np.testing.assert_array_equal(correction.twist_error.covariance, last.twist_covariance)


def test_the_correction_is_near_the_truth() -> None:
    slam = slam_of(FULL, 8)
    correction, truth = slam.front_end.correction(), recorded().truth
    now = truth.planar[np.searchsorted(truth.stamps_ns, correction.stamp_ns)]
    away = between(true_poses()[0], now)
    found = between(slam.front_end.poses[0], correction.pose)
    np.testing.assert_allclose(found[:2], away[:2], atol=0.1)
    np.testing.assert_array_equal(correction.twist_error.mean, slam.front_end.offset)
    learned = correction.twist_error.covariance
    assert np.trace(learned) < np.trace(scans()[7].twist_covariance)


@pytest.mark.parametrize("recipe", [FULL, CHEN])
def test_the_correction_s_covariance_is_that_of_the_keyframe_and_more(recipe: Recipe) -> None:
    front_end = slam_of(recipe, 5).front_end
    covariance = front_end.correction().covariance
    np.testing.assert_allclose(covariance, covariance.T, atol=1e-15)
    assert np.linalg.eigvalsh(covariance)[0] > 0.0
    assert np.trace(covariance) > np.trace(front_end.nodes[-1].covariance)


@pytest.mark.parametrize("count", [1, 3])
def test_the_report_says_what_the_back_end_needs(count: int) -> None:
    front_end = slam_of(FULL, count).front_end
    tried = front_end.add_scan(scans()[count])
    report = front_end.report(tried)
    assert report.number == count
    assert report.stamp_ns == scans()[count].stamp_ns
    assert report.constraints == tuple(tried)
    assert {entry.second for entry in report.constraints} == {count}
    np.testing.assert_array_equal(report.pose, front_end.poses[-1])
    np.testing.assert_array_equal(report.odometry, scans()[count].odometry)
    np.testing.assert_array_equal(report.twist_error.mean, front_end.offset)


def test_the_report_of_the_first_scan_has_its_pose_alone() -> None:
    front_end = FrontEnd(CONFIGURATION, FULL)
    report = front_end.report(front_end.add_scan(scans()[0]))
    assert (report.number, report.constraints) == (0, ())
    np.testing.assert_array_equal(report.pose, scans()[0].odometry)


def test_reports_alone_make_the_same_graph() -> None:
    """Front end and back end may be two processes."""
    front_end = FrontEnd(CONFIGURATION, FULL)
    back_end = BackEnd(CONFIGURATION.back_end, divides=True)
    for scan in scans():
        report = front_end.report(front_end.add_scan(scan))
        front_end.correct(*back_end.take(report.pose, report.constraints))
    np.testing.assert_array_equal(front_end.poses, slam_of(FULL).front_end.poses)


def known(front_end: FrontEnd) -> GraphPoses:
    """What a back end has of a front end's keyframes."""
    kept = [node.first_scan for node in front_end.nodes]
    return GraphPoses(
        np.array([scan.stamp_ns for scan in kept], dtype=np.int64),
        front_end.poses,
        np.array([scan.odometry for scan in kept]),
        np.array([node.covariance for node in front_end.nodes]),
    )


@pytest.mark.parametrize("name", list(ESTIMATORS))
def test_a_front_end_begun_anew_goes_on_from_the_earlier_keyframes(name: str) -> None:
    earlier, front_end = slam_of(ESTIMATORS[name], 4), FrontEnd(CONFIGURATION, ESTIMATORS[name])
    front_end.adopt(known(earlier.front_end))
    np.testing.assert_array_equal(front_end.poses, earlier.front_end.poses)
    tried = front_end.add_scan(scans()[4])
    report = front_end.report(tried)
    assert (report.number, report.stamp_ns) == (4, scans()[4].stamp_ns)
    accepted = [entry for entry in tried if entry.accepted]
    assert kinds(accepted) == ["odometry"]
    reckoned = between(scans()[3].odometry, scans()[4].odometry)
    np.testing.assert_allclose(accepted[0].relative_pose, reckoned, atol=1e-12)
    assert (accepted[0].first, accepted[0].second) == (3, 4)


@pytest.mark.parametrize("name", list(ESTIMATORS))
def test_a_front_end_begun_anew_matches_its_own_scans_again(name: str) -> None:
    recipe = ESTIMATORS[name]
    earlier, front_end = slam_of(recipe, 4), FrontEnd(CONFIGURATION, recipe)
    back_end = BackEnd(CONFIGURATION.back_end)
    back_end.take(earlier.front_end.poses[0], [])
    accepted = [entry for entry in earlier.constraints if entry.accepted]
    front_end.adopt(known(earlier.front_end))
    back_end.update(accepted)
    for scan in scans()[4:7]:
        tried = front_end.add_scan(scan)
        front_end.correct(*back_end.take(front_end.poses[-1], tried))
    assert len(front_end.poses) == len(front_end.nodes) == 7
    assert np.isfinite(front_end.poses).all()
    errors = pose_errors(front_end.poses)
    reckoned = pose_errors(np.array([scan.odometry for scan in scans()[:7]]))
    assert errors[-1] < max(reckoned[-1], 0.1) + 1e-6
    last = [entry for entry in tried if entry.kind is ConstraintKind.CONSECUTIVE]
    assert [entry.accepted for entry in last] == ([True] if recipe.matcher else [])


def test_nothing_to_adopt_is_a_fresh_start() -> None:
    front_end = FrontEnd(CONFIGURATION, FULL)
    front_end.adopt(known(front_end))
    assert front_end.add_scan(scans()[0]) == []
    np.testing.assert_array_equal(front_end.poses, scans()[0].odometry[None])


def test_adopting_takes_the_place_of_what_was_there() -> None:
    front_end = slam_of(CHEN, 3).front_end
    front_end.adopt(known(slam_of(CHEN, 2).front_end))
    assert len(front_end.nodes) == len(front_end.poses) == 2


def test_keyframes_come_with_positive_covariances_that_grow_from_nothing() -> None:
    covariances = [node.covariance for node in slam_of(FULL).front_end.nodes]
    spreads = [float(np.trace(covariance[:2, :2])) for covariance in covariances]
    assert spreads[0] < 1e-9
    assert all(spread > spreads[0] for spread in spreads[1:])
    assert all(np.linalg.eigvalsh(covariance)[0] > 0.0 for covariance in covariances)


def refined(slam: Slam, reports: list[float], poses: Array | None = None) -> Refined:
    return refine(
        scans()[: len(slam.front_end.poses)],
        slam.front_end.poses if poses is None else poses,
        slam.constraints,
        slam.front_end.correction().twist_error,
        LineMatcher(CONFIGURATION.matching),
        CONFIGURATION.back_end,
        reports.append,
    )


def test_refinement_makes_the_keyframes_no_worse() -> None:
    slam = slam_of(FULL)
    before = pose_errors(slam.front_end.poses).mean()
    reports: list[float] = []
    result = refined(slam, reports)
    assert pose_errors(result.poses).mean() < 1.05 * before
    assert reports == sorted(reports)
    assert reports[-1] <= 1.0
    for old, new in zip(slam.constraints, result.constraints, strict=True):
        assert (old.kind, old.first, old.second) == (new.kind, new.first, new.second)
        if old.kind is ConstraintKind.ODOMETRY:
            assert new is old


def test_refinement_leaves_what_it_was_given() -> None:
    slam = slam_of(FULL)
    poses, constraints = slam.front_end.poses.copy(), slam.constraints.copy()
    layouts = [scan.points.copy() for scan in scans()]
    refined(slam, [])
    np.testing.assert_array_equal(slam.front_end.poses, poses)
    assert all(new is old for new, old in zip(slam.constraints, constraints, strict=True))
    for scan, points in zip(scans(), layouts, strict=True):
        np.testing.assert_array_equal(scan.points, points)


def test_what_is_refined_stays() -> None:
    slam = slam_of(FULL)
    once = refined(slam, [])
    twice = refined(Slam(slam.front_end, once.constraints), [], once.poses)
    moved = np.linalg.norm((twice.poses - once.poses)[:, :2], axis=1)
    assert moved.mean() < 0.02


def test_the_whole_graph_at_once_is_the_graph_step_by_step() -> None:
    """Where it has settled; loops' robust kernels make several minima."""
    slam = slam_of(ESTIMATORS["uspic"], 8)
    back_end = whole_graph(slam.front_end.poses, slam.constraints, CONFIGURATION.back_end)
    np.testing.assert_allclose(back_end.poses(), slam.front_end.poses, atol=1e-9)
    for number, node in enumerate(slam.front_end.nodes):
        np.testing.assert_allclose(
            back_end.covariance(number), node.covariance, rtol=1e-3, atol=1e-8
        )


def test_the_whole_graph_of_nothing_is_empty() -> None:
    back_end = whole_graph(np.empty((0, 3)), [], CONFIGURATION.back_end)
    assert back_end.poses().shape == (0, 3)


def test_closed_form_is_the_solver_of_full_alone() -> None:
    assert FULL.solver is closed_form
    assert CHEN.solver is not closed_form
