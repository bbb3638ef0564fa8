# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import pickle

import numpy as np
import pytest
from small_mission import scans

from msss_graphslam.core.compounding import between_covariance
from msss_graphslam.core.scans import corrected_keyframes as module
from msss_graphslam.core.scans.bare_scans import LaidOut, bare
from msss_graphslam.core.scans.corrected_keyframes import CorrectedKeyframes, corrected_keyframes
from msss_graphslam.core.scans.scan_correction import corrected_scans
from msss_graphslam.core.scans.trajectory_correction import closed_form
from msss_graphslam.core.types import Array, Keyframe, Scan, TwistError

ERROR = TwistError(np.array([0.03, -0.02, 0.01]), np.diag([1e-5, 2e-5, 1e-7]))
ARRAYS = ("motion", "motion_covariances", "points", "covariances", "reckoned")


def bare_scans() -> list[Scan]:
    every = [bare(scan) for scan in scans()]
    return [*every[:-1], *LaidOut(every[-1:])]


def poses() -> Array:
    odometry = np.array([scan.odometry for scan in scans()])
    rng = np.random.default_rng(0)
    return np.asarray(odometry + rng.normal(0.0, [0.1, 0.1, 0.02], odometry.shape))


def covariances() -> Array:
    return np.array([(1.0 + number) * np.eye(3) for number in range(len(scans()))])


def frames() -> CorrectedKeyframes:
    return CorrectedKeyframes(bare_scans(), poses(), covariances(), closed_form, ERROR)


def assert_same(frame: Keyframe, number: int) -> None:
    expected = corrected_scans(scans(), poses(), closed_form, ERROR)[number]
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(frame.scan, name), getattr(expected, name))
    np.testing.assert_array_equal(frame.pose, poses()[number])
    np.testing.assert_array_equal(frame.covariance, covariances()[number])


def test_each_is_its_scan_made_anew_with_pose_and_covariance() -> None:
    assert len(frames()) == len(scans()) > 3
    for number, frame in enumerate(frames()):
        assert_same(frame, number)


@pytest.mark.parametrize("place", [-1, -2, 0])
def test_places_count_from_the_end_too(place: int) -> None:
    assert_same(frames()[place], range(len(scans()))[place])


def test_a_part_is_made_of_the_whole() -> None:
    """The scan before the part's end is corrected by the keyframe after it."""
    part = frames()[1:3]
    assert [frame.scan.stamp_ns for frame in part] == [scan.stamp_ns for scan in scans()[1:3]]
    assert_same(part[-1], 2)
    assert_same(part[:1][0], 1)
    assert list(frames()[2:2]) == []


@pytest.mark.parametrize("place", [len(scans()), -len(scans()) - 1])
def test_there_are_no_others(place: int) -> None:
    with pytest.raises(IndexError):
        frames()[place]
    with pytest.raises(IndexError):
        frames()[1:3][2]


def test_it_goes_from_process_to_process() -> None:
    assert_same(pickle.loads(pickle.dumps(frames()))[1], 1)  # noqa: S301


@pytest.mark.parametrize(("more", "laid_out"), [(0, True), (-1, False)])
def test_so_many_are_laid_out_at_once(
    monkeypatch: pytest.MonkeyPatch, more: int, laid_out: bool
) -> None:
    monkeypatch.setattr(module, "KEPT", len(scans()) + more)
    found = corrected_keyframes(bare_scans(), poses(), covariances(), closed_form, ERROR)
    assert isinstance(found, tuple) is laid_out
    assert len(found) == len(scans())
    for number, frame in enumerate(found):
        assert_same(frame, number)


def spreads(scale: float) -> CorrectedKeyframes:
    """The same with keyframes known to so many metres and radians."""
    known = scale**2 * np.tile(np.eye(3), (len(scans()), 1, 1))
    return CorrectedKeyframes(bare_scans(), poses(), known, closed_form, ERROR)


def test_a_scan_between_known_keyframes_states_what_error_they_leave() -> None:
    """The end of its motion is as uncertain as the one keyframe is in the other's frame."""
    scan = spreads(0.001)[1].scan
    first, second = poses()[1:3]
    left = 1e-6 * np.eye(3)
    wanted = between_covariance(first, left, second, left)
    # The way was a little different before it was corrected.
    np.testing.assert_allclose(np.diag(scan.motion_covariances[-1]), np.diag(wanted), rtol=0.1)
    loose = spreads(10.0)[1].scan
    assert np.trace(scan.motion_covariances[-1]) < 0.01 * np.trace(loose.motion_covariances[-1])
    np.testing.assert_array_equal(scan.points, loose.points)


def test_dead_reckoning_may_know_better_than_keyframes() -> None:
    expected = corrected_scans(scans(), poses(), closed_form, ERROR)[1]
    found = spreads(10.0)[1].scan
    np.testing.assert_array_equal(found.motion_covariances, expected.motion_covariances)


def test_what_is_not_learned_leaves_dead_reckonings_error() -> None:
    known = 1e-6 * np.tile(np.eye(3), (len(scans()), 1, 1))
    plain = CorrectedKeyframes(bare_scans(), poses(), known, closed_form, None)[1].scan
    expected = corrected_scans(scans(), poses(), closed_form, None)[1]
    np.testing.assert_array_equal(plain.motion_covariances, expected.motion_covariances)


def test_none_at_all() -> None:
    assert corrected_keyframes([], np.empty((0, 3)), [], closed_form, None) == ()


def test_what_does_not_belong_together_is_refused() -> None:
    with pytest.raises(ValueError, match="poses"):
        CorrectedKeyframes(bare_scans(), poses()[1:], covariances(), closed_form, ERROR)
    with pytest.raises(ValueError, match="covariances"):
        CorrectedKeyframes(bare_scans(), poses(), covariances()[1:], closed_form, ERROR)
