# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the back end does with keyframes and scans that are not as they should be."""

from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from nodes.linked_nodes import LinkedNodes, scans_of
from small_mission import recorded

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import KeyframeReport, Scan
from msss_graphslam.messages import link_decoding
from msss_graphslam.nodes.mission import Mission


@cache
def scans() -> tuple[Scan, ...]:
    return tuple(scan for scan in scans_of(recorded().measurements) if scan.usable)[:5]


@cache
def reports() -> tuple[KeyframeReport, ...]:
    linked = LinkedNodes()
    for scan in scans():
        linked.add_scan(scan)
    return tuple(map(link_decoding.tried, linked.reports))


def mission(count: int) -> tuple[Mission, Counter[str]]:
    refused: Counter[str] = Counter()
    made = Mission(Configuration(), ESTIMATORS["full"], refused)
    for scan, report in list(zip(scans(), reports(), strict=True))[:count]:
        made.add_scan(scan)
        assert made.take(report)
    return made, refused


def test_a_known_keyframe_is_not_taken_again() -> None:
    known, refused = mission(3)
    before = known.answer()
    assert not known.take(reports()[1])
    assert not refused
    np.testing.assert_array_equal(known.answer().poses, before.poses)
    assert len(known.constraints) == sum(len(report.constraints) for report in reports()[:3])


@pytest.mark.parametrize("number", [1, 3])
def test_a_keyframe_of_another_mission_is_refused(number: int) -> None:
    known, refused = mission(3)
    strange = replace(reports()[number], stamp_ns=reports()[1].stamp_ns + 1, number=number)
    assert not known.take(strange)
    assert refused == {"keyframe_of_another_mission": 1}
    assert len(known.poses) == 3


def test_a_keyframe_after_a_missing_one_is_refused() -> None:
    known, refused = mission(2)
    assert not known.take(reports()[3])
    assert refused == {"keyframe_out_of_order": 1}
    assert known.take(reports()[2])


def test_a_keyframe_that_hangs_on_nothing_is_refused() -> None:
    known, refused = mission(2)
    assert not known.take(replace(reports()[2], constraints=()))
    assert refused == {"keyframe_without_constraint": 1}
    assert known.take(reports()[2])


def test_a_constraint_that_may_not_enter_a_graph_leaves_it_as_it_was() -> None:
    known, refused = mission(2)
    bad = replace(reports()[2].constraints[0], covariance=-np.eye(3))
    assert not known.take(replace(reports()[2], constraints=(bad,)))
    assert refused == {"covariance_not_positive_definite": 1}
    assert len(known.answer().stamps_ns) == len(known.poses) == 2
    assert known.take(reports()[2])


def test_the_answer_has_what_the_front_end_needs() -> None:
    known, _ = mission(4)
    answer = known.answer()
    assert answer.stamps_ns.tolist() == [scan.stamp_ns for scan in scans()[:4]]
    np.testing.assert_array_equal(answer.odometry, [scan.odometry for scan in scans()[:4]])
    assert answer.covariances.shape == (4, 3, 3)
    empty, _ = mission(0)
    assert empty.answer().poses.shape == empty.answer().odometry.shape == (0, 3)
    assert empty.answer().covariances.shape == (0, 3, 3)


def test_the_jump_is_by_how_much_the_newest_keyframe_was_moved() -> None:
    known, _ = mission(3)
    largest = known.largest_jump
    moved = replace(reports()[3], pose=reports()[3].pose + np.array([3.0, 4.0, 0.0]))
    assert known.take(moved)
    assert known.last_jump == known.largest_jump
    assert known.last_jump == pytest.approx(5.0, abs=1.0)
    assert known.last_jump > largest
    assert known.take(reports()[4])
    assert known.last_jump < known.largest_jump


def test_a_scan_that_made_no_keyframe_gets_poses_alone() -> None:
    refused: Counter[str] = Counter()
    gap = Mission(Configuration(), ESTIMATORS["full"], refused)
    linked = LinkedNodes()
    for number, scan in enumerate(scans()):
        gap.add_scan(scan)
        if number != 2:
            linked.add_scan(scan)
    for report in map(link_decoding.tried, linked.reports):
        assert gap.take(report)
    estimate = gap.logbook().finish()
    assert [frame.scan.stamp_ns for frame in estimate.keyframes] == [
        scan.stamp_ns for number, scan in enumerate(scans()) if number != 2
    ]
    assert len(estimate.trajectory.stamps_ns) == sum(len(scan.beam_stamps_ns) for scan in scans())


def test_a_keyframe_without_its_scan_keeps_its_place() -> None:
    known, _ = mission(0)
    for number, (scan, report) in enumerate(zip(scans(), reports(), strict=True)):
        if number != 1:
            known.add_scan(scan)
        assert known.take(report)
    estimate = known.logbook().finish()
    stamps = [frame.scan.stamp_ns for frame in estimate.keyframes]
    assert stamps == [scan.stamp_ns for scan in scans()]
    assert len(estimate.keyframes[1].scan.points) == 0
    assert np.isfinite(estimate.trajectory.poses).all()


def test_pictures_of_a_running_mission_are_those_of_its_logbook() -> None:
    known, _ = mission(5)
    known_scans = known.logbook().keyframe_scans()
    for frame, scan in zip(known.keyframes(), known_scans, strict=True):
        np.testing.assert_array_equal(frame.scan.points, scan.points)
    path = known.keyframe_path()
    np.testing.assert_array_equal(path.planar, known.poses)
    trajectory = known.trajectory()
    at = np.searchsorted(trajectory.stamps_ns, path.stamps_ns)
    np.testing.assert_allclose(trajectory.planar[at], path.planar, atol=1e-9)


def test_it_is_whole_where_scans_and_keyframes_fit_together() -> None:
    made, _ = mission(0)
    assert not made.is_whole
    for scan, report in zip(scans(), reports(), strict=True):
        made.add_scan(scan)
        assert not made.is_whole
        made.take(report)
        assert made.is_whole
    made.add_scan(
        replace(scans()[-1], beam_stamps_ns=scans()[-1].beam_stamps_ns + 1, usable=False)
    )
    assert made.is_whole


def test_keyframes_alone_are_not_whole() -> None:
    made, _ = mission(0)
    made.take(reports()[0])
    assert not made.is_whole
