# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from moving_scans import BASIN, BLIND, CORRIDOR, moving_scans

from msss_graphslam.core.compounding import between, wrap
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.smoothing.joint_smoothing import NARROWING, Reach, Smoothed, smooth
from msss_graphslam.core.types import Array, Scan

NEW_EVERY_TURN = Persistence(100.0, np.zeros(3))
REACH = Reach(2.0, 0.5)


def smoothed(
    scans: list[Scan], pairs: list[tuple[int, int]] | None = None, poses: Array | None = None
) -> Smoothed:
    every = list(combinations(range(len(scans)), 2))
    start = np.zeros((len(scans), 3)) if poses is None else poses
    return smooth(
        scans, start, np.zeros(3), every if pairs is None else pairs, NEW_EVERY_TURN, REACH
    )


def errors(found: Smoothed, truth: Array) -> Array:
    difference = found.poses - truth[: len(found.poses)]
    difference[:, 2] = wrap(difference[:, 2])
    return np.asarray(difference)


def test_motion_that_nobody_measured_is_found_from_the_sonar() -> None:
    scans, truth = moving_scans(BASIN, count=5)
    rough = np.random.default_rng(2).normal(0.0, [0.4, 0.4, 0.08], (5, 3))
    rough[0] = 0.0
    found = smoothed(scans, poses=truth[:5] + rough)
    error = errors(found, truth)
    assert np.abs(errors(smoothed(scans, []), truth)).max() > 4.0
    assert np.hypot(*error[:, :2].T).max() < 0.1
    assert np.abs(error[:, 2]).max() < 0.02
    np.testing.assert_allclose(found.twist, [0.12, 0.03, 0.012], atol=0.02)


def test_the_errors_are_those_that_the_covariances_expect() -> None:
    scans, truth = moving_scans(BASIN, count=6)
    found = smoothed(scans)
    solved = np.linalg.solve(found.covariances[1:], errors(found, truth)[1:, :, None])[..., 0]
    nees = float(np.mean(np.sum(errors(found, truth)[1:] * solved, axis=1)) / 3.0)
    assert 0.05 < nees < 4.0
    assert np.sqrt(found.covariances[1:, 0, 0]).max() < 0.1


def test_along_a_corridor_only_dead_reckoning_speaks() -> None:
    scans, _ = moving_scans(CORRIDOR, count=3, twist=np.zeros(3))
    covariance = smoothed(scans).covariances[1]
    along, across = np.sqrt(np.diag(covariance)[:2])
    assert along > 0.3 * 10.0 * np.sqrt(BLIND[0, 0])
    assert across < 0.1 * along
    assert np.sqrt(covariance[2, 2]) < 0.05


def test_without_any_pair_dead_reckoning_stands() -> None:
    scans, _ = moving_scans(BASIN, count=3)
    found = smoothed(scans, [], np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.1], [2.0, 0.0, -0.1]]))
    np.testing.assert_allclose(found.poses, 0.0, atol=1e-6)
    deviations = np.sqrt([np.diag(entry) for entry in found.covariances])
    np.testing.assert_allclose(deviations[1], 10.0 * np.sqrt(np.diag(BLIND)), rtol=1e-3)
    assert (deviations[2] > deviations[1]).all()


def test_a_sharp_prior_is_not_moved() -> None:
    scans, _ = moving_scans(BASIN, count=3, doubt=1e-6**2 * np.eye(3))
    found = smoothed(scans)
    assert np.abs(found.poses).max() < 1e-3


def test_the_first_keyframe_stays_and_the_rest_hangs_on_it() -> None:
    scans, _ = moving_scans(BASIN, count=4)
    usual = smoothed(scans).poses
    origin = np.array([30.0, -20.0, 2.0])
    moved = smoothed(scans, poses=np.tile(origin, (4, 1))).poses
    np.testing.assert_array_equal(moved[0], origin)
    np.testing.assert_allclose(between(origin, moved), usual, atol=5e-3)


def test_errors_that_persist_are_learned_once() -> None:
    """What pairs of the first scans show narrows the last one, which no pair holds."""
    scans, truth = moving_scans(BASIN, count=4)
    pairs = [(0, 1), (1, 2), (0, 2)]
    lasting = Persistence(1e4, np.diag(BLIND))
    found = smooth(scans, np.zeros((4, 3)), np.zeros(3), pairs, lasting, REACH)
    alone = smoothed(scans, pairs)
    assert found.twist_covariance[0, 0] < 0.3 * alone.twist_covariance[0, 0]
    assert np.hypot(*errors(found, truth)[3, :2]) < np.hypot(*errors(alone, truth)[3, :2])


def test_scans_that_were_lost_keep_their_place_between_the_others() -> None:
    scans, _ = moving_scans(BASIN, count=3)
    silent = replace(
        scans[1],
        twist_covariance=np.zeros((3, 3)),
        beam_index=np.zeros(0, dtype=np.intp),
        body_points=np.zeros((0, 2)),
        body_covariances=np.zeros((0, 2, 2)),
    )
    found = smoothed([scans[0], silent, scans[2]])
    assert np.isfinite(found.poses).all()
    assert np.sqrt(found.covariances[1, 0, 0]) < 1.6 * 10.0 * np.sqrt(BLIND[0, 0])
    assert np.sqrt(found.covariances[2, 0, 0]) > 1e-3


def test_one_scan_is_its_own_map() -> None:
    scans, _ = moving_scans(BASIN, count=1)
    found = smoothed(scans, [])
    np.testing.assert_array_equal(found.poses, np.zeros((1, 3)))
    assert found.twist_covariance == pytest.approx(BLIND, rel=1e-3, abs=1e-9)


def test_the_reach_narrows_and_stays() -> None:
    reach = Reach(2.0, 0.5)
    assert reach.at(0) == 2.0
    assert reach.at(1) == pytest.approx(2.0 * NARROWING)
    assert reach.at(1000) == 0.5
    assert Reach(0.1, 0.5).at(0) == 0.5


def test_progress_comes_to_its_end() -> None:
    scans, _ = moving_scans(BASIN, count=2)
    told: list[float] = []
    smooth(scans, np.zeros((2, 3)), np.zeros(3), [(0, 1)], NEW_EVERY_TURN, REACH, told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
