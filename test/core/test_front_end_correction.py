# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a correction does to the front end, and which one it tells of itself."""

import numpy as np
import pytest
from short_slam import CHEN, CONFIGURATION, FULL, slam_of, true_poses
from small_mission import recorded, scans

from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.recipes import Recipe


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


def test_keyframes_come_with_positive_covariances_that_grow_from_nothing() -> None:
    covariances = [node.covariance for node in slam_of(FULL).front_end.nodes]
    spreads = [float(np.trace(covariance[:2, :2])) for covariance in covariances]
    assert spreads[0] < 1e-9
    assert all(spread > spreads[0] for spread in spreads[1:])
    assert all(np.linalg.eigvalsh(covariance)[0] > 0.0 for covariance in covariances)
