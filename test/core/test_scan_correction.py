# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from itertools import pairwise

import numpy as np
import pytest
from small_mission import scans

from msss_graphslam.core.compounding import between, compose, transform_points
from msss_graphslam.core.scans.motion_feedback import offset_motion
from msss_graphslam.core.scans.scan_correction import correct_scan, corrected_scans
from msss_graphslam.core.scans.scan_generation import motion_covariances
from msss_graphslam.core.scans.trajectory_correction import Solver, closed_form, nelder_mead
from msss_graphslam.core.types import Array, Scan, TwistError

ERROR = TwistError(np.array([0.03, -0.02, 0.01]), np.diag([1e-5, 2e-5, 1e-7]))
SOLVERS = pytest.mark.parametrize("solver", [closed_form, nelder_mead])


def reckoned() -> Array:
    return np.array([scan.odometry for scan in scans()])


def moved(seed: int = 0) -> Array:
    """Keyframes as an optimiser might put them."""
    return np.asarray(
        reckoned() + np.random.default_rng(seed).normal(0.0, [0.1, 0.1, 0.02], (len(scans()), 3))
    )


def assert_same_layout(scan: Scan, other: Scan, tolerance: float = 1e-9) -> None:
    np.testing.assert_allclose(scan.motion, other.motion, atol=tolerance)
    np.testing.assert_allclose(scan.points, other.points, atol=tolerance)
    np.testing.assert_allclose(scan.covariances, other.covariances, atol=tolerance)


@SOLVERS
def test_where_nothing_is_wrong_the_scan_stays(solver: Solver) -> None:
    first, second = scans()[:2]
    target = between(first.odometry, second.odometry)
    scan, delta = correct_scan(first, second, target, solver, first.twist_covariance)
    assert_same_layout(scan, first)
    np.testing.assert_allclose(delta, 0.0, atol=1e-9)


@SOLVERS
def test_the_motion_leads_to_the_following_keyframe(solver: Solver) -> None:
    first, second = scans()[:2]
    target = between(first.odometry, second.odometry) + np.array([0.3, -0.2, 0.05])
    scan, delta = correct_scan(first, second, target, solver, first.twist_covariance)
    last_step = between(first.motion[-1], between(first.odometry, second.odometry))
    met = compose(scan.motion[-1], compose(last_step, delta))
    np.testing.assert_allclose(met, target, atol=0.01)
    assert np.abs(delta).max() > 1e-4


def test_the_points_are_those_measured_placed_by_the_motion() -> None:
    first, second = scans()[:2]
    target = between(first.odometry, second.odometry) + np.array([0.3, -0.2, 0.05])
    scan, _ = correct_scan(first, second, target, closed_form, ERROR.covariance)
    placed = transform_points(scan.motion[scan.beam_index], scan.body_points)
    np.testing.assert_allclose(scan.points, placed, atol=1e-12)
    expected = motion_covariances(scan.motion, first.beam_times[:-1], ERROR.covariance)
    np.testing.assert_allclose(scan.motion_covariances, expected, atol=1e-15)
    assert scan.reckoned is first.reckoned
    assert scan.twist_covariance is first.twist_covariance


def test_by_dead_reckoning_s_own_poses_all_stay() -> None:
    for scan, first in zip(
        corrected_scans(scans(), reckoned(), closed_form, None), scans(), strict=True
    ):
        assert_same_layout(scan, first)


@pytest.mark.parametrize("known", [None, ERROR])
def test_each_but_the_last_is_corrected_to_the_next(known: TwistError | None) -> None:
    poses = moved()
    found = corrected_scans(scans(), poses, closed_form, known)
    assert len(found) == len(scans())
    pairs = zip(pairwise(scans()), pairwise(poses), found[:-1], strict=True)
    for (scan, following), ends, corrected in pairs:
        one, _ = correct_scan(scan, following, between(*ends), closed_form, scan.twist_covariance)
        assert_same_layout(corrected, one, 1e-15)
        assert np.abs(corrected.motion - scan.motion).max() > 1e-3


def test_the_last_has_the_known_error_taken_out() -> None:
    last = scans()[-1]
    *_, found = corrected_scans(scans(), moved(), closed_form, ERROR)
    motion = offset_motion(last.motion, last.beam_times[:-1], ERROR.mean)
    np.testing.assert_allclose(found.motion, motion, atol=1e-15)
    expected = motion_covariances(motion, last.beam_times[:-1], ERROR.covariance)
    np.testing.assert_allclose(found.motion_covariances, expected, atol=1e-15)
    assert corrected_scans(scans(), moved(), closed_form, None)[-1] is last


def test_one_scan_is_the_last_and_none_is_none() -> None:
    poses = reckoned()[:1]
    assert corrected_scans(scans()[:1], poses, closed_form, None) == [scans()[0]]
    (found,) = corrected_scans(scans()[:1], poses, closed_form, ERROR)
    assert np.abs(found.motion - scans()[0].motion).max() > 1e-2
    assert corrected_scans([], np.empty((0, 3)), closed_form, ERROR) == []


def test_scans_and_poses_have_to_be_as_many() -> None:
    with pytest.raises(ValueError, match=r"shorter|longer"):
        corrected_scans(scans(), reckoned()[:-1], closed_form, None)


def test_what_was_given_stays_as_it_was() -> None:
    before = [scan.points.copy() for scan in scans()]
    corrected_scans(scans(), moved(), closed_form, ERROR)
    for scan, points in zip(scans(), before, strict=True):
        np.testing.assert_array_equal(scan.points, points)
