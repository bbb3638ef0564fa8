# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A front end that is a process of its own: what it reports, and how it begins anew."""

import numpy as np
import pytest
from short_slam import CHEN, CONFIGURATION, FULL, kinds, pose_errors, slam_of
from small_mission import scans

from msss_graphslam.core.compounding import between
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import ConstraintKind, GraphPoses


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
