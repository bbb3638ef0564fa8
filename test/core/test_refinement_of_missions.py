# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Refinement on the scans of a short simulated mission."""

import numpy as np
from short_slam import CHEN, CONFIGURATION, FULL, Slam, pose_errors, slam_of
from small_mission import scans

from msss_graphslam.core.graph.refinement import Refined, refine, whole_graph
from msss_graphslam.core.matching.matchers import LineMatcher
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.scans.trajectory_correction import closed_form
from msss_graphslam.core.types import Array, ConstraintKind


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
