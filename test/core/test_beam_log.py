# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from itertools import pairwise

import numpy as np
import pytest

from msss_graphslam.core.beam_log import BeamLog
from msss_graphslam.core.compounding import between, compose, wrap
from msss_graphslam.core.scans.motion_feedback import offset_motion
from msss_graphslam.core.scans.scan_generation import reckoned_scan
from msss_graphslam.core.scans.trajectory_correction import Solver, closed_form, nelder_mead
from msss_graphslam.core.types import Array, Scan

COUNT, A_TURN = 130, 40
PERIOD_NS = 50_000_000
STARTS = np.array([7, 47, 87, 127])
NO_OFFSET = np.zeros(3)
SOLVERS = pytest.mark.parametrize("solver", [closed_form, nelder_mead])


def reckoned() -> Array:
    rng = np.random.default_rng(0)
    pose, poses = np.array([1.0, 2.0, 3.0]), []
    for _ in range(COUNT):
        poses.append(pose)
        pose = compose(pose, rng.normal([0.005, 0.0, 0.004], 0.001))
    planar = np.array(poses)
    level = np.tile([0.01, -0.02], (COUNT, 1))
    return np.column_stack([planar[:, :2], np.linspace(-1, -2, COUNT), level, planar[:, 2]])


def scan_of(start: int, stop: int, *, usable: bool = True) -> Scan:
    """The turn of the beams from ``start`` to before ``stop``."""
    poses = reckoned()
    return reckoned_scan(
        beam_stamps_ns=PERIOD_NS * np.arange(start, stop, dtype=np.int64),
        end_stamp_ns=stop * PERIOD_NS,
        reckoned=poses[np.minimum(np.arange(start, stop + 1), COUNT - 1)],
        twist_covariance=np.eye(3),
        beam_index=np.zeros(0, dtype=np.intp),
        body_points=np.zeros((0, 2)),
        body_covariances=np.zeros((0, 2, 2)),
        usable=usable,
    )


def keyframe_scans() -> list[Scan]:
    return [scan_of(*ends) for ends in pairwise([*STARTS.tolist(), COUNT])]


def filled() -> BeamLog:
    """A log of a dropped turn and four that made keyframes."""
    log = BeamLog()
    for scan in [scan_of(0, int(STARTS[0]), usable=False), *keyframe_scans()]:
        log.add_scan(scan)
    return log


def moved_keyframes() -> Array:
    """The keyframes where an optimiser might put them."""
    rng = np.random.default_rng(1)
    planar = reckoned()[:, [0, 1, 5]]
    poses = compose(np.array([0.3, -0.2, 0.1]), planar[STARTS])
    return np.asarray(poses + rng.normal(0.0, [0.1, 0.1, 0.03], (4, 3)))


@SOLVERS
def test_nothing_to_correct_is_the_dead_reckoning(solver: Solver) -> None:
    log = filled()
    keyframes = reckoned()[STARTS][:, [0, 1, 5]]
    trajectory = log.corrected(keyframe_scans(), keyframes, solver, NO_OFFSET)
    np.testing.assert_allclose(trajectory.poses[:, :5], reckoned()[:, :5], atol=1e-9)
    np.testing.assert_allclose(wrap(trajectory.poses[:, 5] - reckoned()[:, 5]), 0.0, atol=1e-9)
    np.testing.assert_array_equal(trajectory.stamps_ns, PERIOD_NS * np.arange(COUNT))


@SOLVERS
def test_the_trajectory_meets_every_keyframe(solver: Solver) -> None:
    keyframes = moved_keyframes()
    trajectory = filled().corrected(keyframe_scans(), keyframes, solver, NO_OFFSET)
    np.testing.assert_allclose(trajectory.planar[STARTS, :2], keyframes[:, :2], atol=1e-12)
    np.testing.assert_allclose(
        wrap(trajectory.planar[STARTS, 2] - keyframes[:, 2]), 0.0, atol=1e-12
    )


@SOLVERS
def test_the_trajectory_makes_no_step_at_a_keyframe(solver: Solver) -> None:
    trajectory = filled().corrected(keyframe_scans(), moved_keyframes(), solver, NO_OFFSET)
    steps = between(trajectory.planar[:-1], trajectory.planar[1:])[STARTS[0] :]
    own = between(reckoned()[:-1, [0, 1, 5]], reckoned()[1:, [0, 1, 5]])[STARTS[0] :]
    assert np.abs(steps - own)[:, :2].max() < 0.4 / A_TURN * 2.0
    assert np.abs(wrap(steps[:, 2] - own[:, 2])).max() < 0.15 / A_TURN * 2.0


def test_what_lies_before_the_first_keyframe_stands() -> None:
    trajectory = filled().corrected(keyframe_scans(), moved_keyframes(), closed_form, NO_OFFSET)
    np.testing.assert_allclose(trajectory.poses[:7], reckoned()[:7], atol=1e-12)


def test_after_the_last_keyframe_the_known_error_is_taken_out() -> None:
    offset = np.array([0.02, 0.01, 0.03])
    keyframes = moved_keyframes()[:2]
    trajectory = filled().corrected(keyframe_scans(), keyframes, closed_form, offset)
    planar = reckoned()[47:, [0, 1, 5]]
    elapsed = 0.05 * np.arange(len(planar))
    motion = offset_motion(between(planar[0], planar), elapsed, offset)
    expected = compose(keyframes[1], motion)
    np.testing.assert_allclose(trajectory.planar[47:], expected, atol=1e-12)


def test_height_and_tilt_stay_as_they_were_measured() -> None:
    trajectory = filled().corrected(keyframe_scans(), moved_keyframes(), closed_form, NO_OFFSET)
    np.testing.assert_allclose(trajectory.poses[:, 2:5], reckoned()[:, 2:5], atol=1e-12)


def test_scans_beyond_the_keyframes_are_dead_reckoned_on() -> None:
    """A scan that has no pose yet changes nothing."""
    two = moved_keyframes()[:2]
    with_more = filled().corrected(keyframe_scans(), two, closed_form, NO_OFFSET)
    without = filled().corrected(keyframe_scans()[:2], two, closed_form, NO_OFFSET)
    np.testing.assert_array_equal(with_more.poses, without.poses)


def test_a_dropped_turn_between_keyframes_is_corrected_with_them() -> None:
    first, dropped, last = scan_of(0, 40), scan_of(40, 80, usable=False), scan_of(80, 120)
    log = BeamLog()
    for scan in (first, dropped, last):
        log.add_scan(scan)
    poses = reckoned()[:, [0, 1, 5]]
    keyframes = np.array([poses[0], compose(poses[80], np.array([0.4, 0.0, 0.0]))])
    trajectory = log.corrected([first, last], keyframes, closed_form, NO_OFFSET)
    np.testing.assert_array_equal(trajectory.stamps_ns, PERIOD_NS * np.arange(120))
    moved = np.linalg.norm((trajectory.planar - poses[:120])[:, :2], axis=1)
    np.testing.assert_allclose(moved[80:], 0.4, atol=1e-9)
    assert 0.1 < moved[40] < moved[79] < 0.4


def test_without_keyframes_dead_reckoning_is_all_there_is() -> None:
    trajectory = filled().corrected([], np.empty((0, 3)), closed_form, NO_OFFSET)
    np.testing.assert_array_equal(trajectory.poses, filled().dead_reckoning.poses)
    assert len(trajectory.poses) == COUNT


def test_scans_without_poses_are_dead_reckoning_alone() -> None:
    trajectory = filled().corrected(keyframe_scans(), np.empty((0, 3)), closed_form, NO_OFFSET)
    np.testing.assert_array_equal(trajectory.poses, filled().dead_reckoning.poses)


def test_the_beams_are_those_of_the_scans_and_no_turn_s_end() -> None:
    found = filled().dead_reckoning
    np.testing.assert_array_equal(found.stamps_ns, PERIOD_NS * np.arange(COUNT))
    np.testing.assert_array_equal(found.poses, reckoned())


def test_an_empty_log_is_an_empty_trajectory() -> None:
    log = BeamLog()
    trajectory = log.corrected([], np.empty((0, 3)), closed_form, NO_OFFSET)
    assert trajectory.poses.shape == log.online.poses.shape == (0, 6)
    assert log.dead_reckoning.poses.shape == (0, 6)
    assert trajectory.stamps_ns.dtype == log.online.stamps_ns.dtype == np.int64


def test_online_poses_are_kept_apart_from_the_beams() -> None:
    log = BeamLog()
    log.add_online(2, np.arange(6.0))
    np.testing.assert_array_equal(log.online.stamps_ns, [2])
    np.testing.assert_array_equal(log.online.poses, [np.arange(6.0)])
    assert len(log.dead_reckoning.stamps_ns) == 0


def test_online_poses_are_not_copied_so_none_comes_while_they_are_held() -> None:
    log = BeamLog()
    log.add_online(2, np.arange(6.0))
    held = log.online
    with pytest.raises(BufferError):
        log.add_online(3, np.zeros(6))
    np.testing.assert_array_equal(held.poses, [np.arange(6.0)])
    del held
    log.add_online(3, np.zeros(6))
    assert log.online.stamps_ns.tolist() == [2, 3]
    assert log.online.poses.shape == (2, 6)
