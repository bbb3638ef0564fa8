# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from estimate_checks import assert_sound
from small_mission import estimated, scans

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.graph.graph_slam import GraphSlam
from msss_graphslam.core.logbook import Logbook
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Array, Estimate, Scan

CONFIGURATION = Configuration()
EVERY_ESTIMATOR = pytest.mark.parametrize("estimator", list(ESTIMATORS))


def dropped(scan: Scan) -> Scan:
    """The same turn as one that was dropped."""
    none = np.zeros(0, dtype=np.intp)
    points, covariances = np.zeros((0, 2)), np.zeros((0, 2, 2))
    return replace(
        scan,
        beam_index=none,
        body_points=points,
        body_covariances=covariances,
        points=points,
        covariances=covariances,
        usable=False,
    )


def filled(estimator: str, turns: list[Scan]) -> Logbook:
    recipe = ESTIMATORS[estimator]
    slam, logbook = GraphSlam(CONFIGURATION, recipe), Logbook(CONFIGURATION, recipe)
    for scan in turns:
        logbook.add_scan(scan)
        if scan.usable:
            logbook.constraints += slam.add_scan(scan)
            logbook.poses = slam.front_end.poses
            logbook.twist_error = slam.front_end.correction().twist_error
    return logbook


def beams_of(turns: list[Scan]) -> list[int]:
    return [int(stamp) for scan in turns for stamp in scan.beam_stamps_ns]


@EVERY_ESTIMATOR
def test_nothing_at_all(estimator: str) -> None:
    logbook = Logbook(CONFIGURATION, ESTIMATORS[estimator])
    assert logbook.keyframe_scans() == []
    estimate = logbook.finish()
    assert_sound(estimate, 0)
    assert estimate.keyframes == tuple(estimate.first_scans) == estimate.constraints == ()
    assert estimate.estimator == estimator


@EVERY_ESTIMATOR
def test_one_scan(estimator: str) -> None:
    (scan,) = turns = list(scans()[:1])
    estimate = filled(estimator, turns).finish()
    assert_sound(estimate, len(scan.beam_stamps_ns))
    assert len(estimate.keyframes) == 1
    (kept,) = estimate.first_scans
    np.testing.assert_array_equal(kept.points, scan.points)
    np.testing.assert_allclose(estimate.keyframes[0].pose, scan.odometry, atol=1e-9)
    np.testing.assert_allclose(estimate.trajectory.poses, estimate.dead_reckoning.poses, atol=1e-6)


@EVERY_ESTIMATOR
def test_dropped_turns_alone_are_dead_reckoning(estimator: str) -> None:
    turns = [dropped(scan) for scan in scans()[:3]]
    estimate = filled(estimator, turns).finish()
    assert_sound(estimate, len(beams_of(turns)))
    assert estimate.keyframes == ()
    np.testing.assert_array_equal(estimate.trajectory.poses, estimate.dead_reckoning.poses)


@EVERY_ESTIMATOR
@pytest.mark.parametrize("at", [0, 2, 4])
def test_the_trajectory_has_all_beams_those_of_dropped_turns_too(estimator: str, at: int) -> None:
    turns = list(scans()[:5])
    turns[at] = dropped(turns[at])
    estimate = filled(estimator, turns).finish()
    assert_sound(estimate, len(beams_of(turns)))
    assert estimate.trajectory.stamps_ns.tolist() == beams_of(turns)
    assert len(estimate.keyframes) == 4
    assert all(scan.usable for scan in estimate.first_scans)


def test_a_dropped_turn_changes_no_keyframe_of_before() -> None:
    turns = list(scans()[:4])
    with_dropped = filled("chen2015", [*turns, dropped(scans()[4])]).finish()
    assert (
        poses_of(with_dropped).tobytes() == poses_of(filled("chen2015", turns).finish()).tobytes()
    )


def poses_of(estimate: Estimate) -> Array:
    return np.array([keyframe.pose for keyframe in estimate.keyframes])


@EVERY_ESTIMATOR
def test_scans_that_have_no_pose_yet_are_left_out(estimator: str) -> None:
    """The live back end may be asked between a scan and its keyframe."""
    logbook = filled(estimator, list(scans()[:4]))
    logbook.add_scan(scans()[4])
    assert len(logbook.keyframe_scans()) == 4
    estimate = logbook.finish()
    assert_sound(estimate, len(beams_of(list(scans()[:5]))))
    assert len(estimate.keyframes) == len(estimate.first_scans) == 4


@EVERY_ESTIMATOR
def test_it_is_the_pipeline_s_estimate(estimator: str) -> None:
    found, expected = filled(estimator, list(scans())).finish(), estimated(estimator)
    beams = len(found.trajectory.poses)
    assert beams == len(beams_of(list(scans()))) > 0.9 * len(expected.trajectory.poses)
    assert found.trajectory.poses.tobytes() == expected.trajectory.poses[:beams].tobytes()
    assert poses_of(found).tobytes() == poses_of(expected).tobytes()
    assert len(found.constraints) == len(expected.constraints)


def test_the_trajectory_goes_through_the_keyframes() -> None:
    estimate = filled("full", list(scans()[:6])).finish()
    stamps = [keyframe.scan.stamp_ns for keyframe in estimate.keyframes]
    at = np.searchsorted(estimate.trajectory.stamps_ns, stamps)
    np.testing.assert_allclose(
        estimate.trajectory.planar[at, :2], poses_of(estimate)[:, :2], atol=1e-9
    )


@pytest.mark.parametrize(("estimator", "smooths"), [("full", True), ("chen2015", False)])
def test_only_full_smooths(estimator: str, smooths: bool) -> None:
    logbook, reports = filled(estimator, list(scans()[:6])), list[float]()
    before = logbook.poses.copy()
    logbook.finish(reports.append)
    assert bool(reports) is smooths
    assert bool(np.abs(logbook.poses - before).max() > 1e-6) is smooths


def test_smoothing_leaves_what_it_was_given() -> None:
    logbook = filled("full", list(scans()[:6]))
    kept, constraints = logbook.scans.copy(), logbook.constraints.copy()
    reports: list[float] = []
    logbook.finish(reports.append)
    assert all(new is old for new, old in zip(logbook.scans, kept, strict=True))
    assert all(new is old for new, old in zip(logbook.constraints, constraints, strict=True))
    assert (reports[0], reports[-1]) == (0.0, 1.0)
    assert reports == sorted(reports)


def test_one_scan_is_not_smoothed() -> None:
    filled("full", list(scans()[:1])).finish(lambda _: pytest.fail("nothing was to be done"))


def test_asked_on_the_way_it_lays_the_scans_out_as_it_stands() -> None:
    logbook = filled("chen2015", list(scans()[:4]))
    on_the_way = logbook.keyframe_scans()
    assert len(on_the_way) == 4
    kept = [keyframe.scan for keyframe in logbook.finish().keyframes]
    for scan, other in zip(on_the_way, kept, strict=True):
        np.testing.assert_array_equal(scan.points, other.points)
    assert any(
        np.abs(scan.motion - first.motion).max() > 1e-3
        for scan, first in zip(on_the_way, scans()[:4], strict=True)
    )


def test_what_a_subscriber_had_is_kept() -> None:
    logbook = filled("full", list(scans()[:2]))
    logbook.add_online(7, np.arange(6.0) * 0.1)
    online = logbook.finish().online
    np.testing.assert_array_equal(online.stamps_ns, [7])
    np.testing.assert_array_equal(online.poses, [np.arange(6.0) * 0.1])
