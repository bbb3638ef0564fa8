# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.core.beam_log import BeamLog
from msss_graphslam.core.compounding import between, compose, wrap
from msss_graphslam.core.history import DeadReckoningHistory
from msss_graphslam.core.motion_feedback import offset_motion
from msss_graphslam.core.trajectory_correction import Solver, closed_form, nelder_mead
from msss_graphslam.core.types import Array, Odometry, Stamps

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


def filled() -> BeamLog:
    log, history = BeamLog(), DeadReckoningHistory()
    for number, pose in enumerate(reckoned()):
        stamp = number * PERIOD_NS
        history.append(Odometry(stamp, pose, np.eye(6), np.zeros(6), np.eye(6)))
        log.add(stamp, pose + 1.0)
    log.resolve(history)
    return log


def stamps_of(starts: Array) -> Stamps:
    return np.asarray(starts * PERIOD_NS, dtype=np.int64)


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
    trajectory = log.corrected(stamps_of(STARTS), keyframes, solver, NO_OFFSET)
    np.testing.assert_allclose(trajectory.poses[:, :5], reckoned()[:, :5], atol=1e-9)
    np.testing.assert_allclose(wrap(trajectory.poses[:, 5] - reckoned()[:, 5]), 0.0, atol=1e-9)
    np.testing.assert_array_equal(trajectory.stamps_ns, log.stamps)


@SOLVERS
def test_the_trajectory_meets_every_keyframe(solver: Solver) -> None:
    keyframes = moved_keyframes()
    trajectory = filled().corrected(stamps_of(STARTS), keyframes, solver, NO_OFFSET)
    np.testing.assert_allclose(trajectory.planar[STARTS, :2], keyframes[:, :2], atol=1e-12)
    np.testing.assert_allclose(
        wrap(trajectory.planar[STARTS, 2] - keyframes[:, 2]), 0.0, atol=1e-12
    )


@SOLVERS
def test_the_trajectory_makes_no_step_at_a_keyframe(solver: Solver) -> None:
    trajectory = filled().corrected(stamps_of(STARTS), moved_keyframes(), solver, NO_OFFSET)
    steps = between(trajectory.planar[:-1], trajectory.planar[1:])[STARTS[0] :]
    own = between(reckoned()[:-1, [0, 1, 5]], reckoned()[1:, [0, 1, 5]])[STARTS[0] :]
    assert np.abs(steps - own)[:, :2].max() < 0.4 / A_TURN * 2.0
    assert np.abs(wrap(steps[:, 2] - own[:, 2])).max() < 0.15 / A_TURN * 2.0


def test_what_lies_before_the_first_keyframe_stands() -> None:
    trajectory = filled().corrected(stamps_of(STARTS), moved_keyframes(), closed_form, NO_OFFSET)
    np.testing.assert_allclose(trajectory.poses[:7], reckoned()[:7], atol=1e-12)


def test_after_the_last_keyframe_the_known_error_is_taken_out() -> None:
    offset = np.array([0.02, 0.01, 0.03])
    starts = STARTS[:2]
    keyframes = moved_keyframes()[:2]
    trajectory = filled().corrected(stamps_of(starts), keyframes, closed_form, offset)
    planar = reckoned()[47:, [0, 1, 5]]
    elapsed = 0.05 * np.arange(len(planar))
    motion = offset_motion(between(planar[0], planar), elapsed, offset)
    expected = compose(keyframes[1], motion)
    np.testing.assert_allclose(trajectory.planar[47:], expected, atol=1e-12)


def test_height_and_tilt_stay_as_they_were_measured() -> None:
    trajectory = filled().corrected(stamps_of(STARTS), moved_keyframes(), closed_form, NO_OFFSET)
    np.testing.assert_allclose(trajectory.poses[:, 2:5], reckoned()[:, 2:5], atol=1e-12)


def test_without_keyframes_dead_reckoning_is_all_there_is() -> None:
    none = np.empty(0, dtype=np.int64)
    trajectory = filled().corrected(none, np.empty((0, 3)), closed_form, NO_OFFSET)
    np.testing.assert_array_equal(trajectory.poses, filled().dead_reckoning.poses)


def test_an_empty_log_is_an_empty_trajectory() -> None:
    log = BeamLog()
    log.resolve(DeadReckoningHistory())
    none = np.empty(0, dtype=np.int64)
    trajectory = log.corrected(none, np.empty((0, 3)), closed_form, NO_OFFSET)
    assert trajectory.poses.shape == log.online.poses.shape == (0, 6)
    assert log.dead_reckoning.poses.shape == (0, 6)


def test_online_poses_are_kept_and_missing_ones_are_left_out() -> None:
    log = BeamLog()
    log.add(1, None)
    log.add(2, np.arange(6.0))
    np.testing.assert_array_equal(log.online.stamps_ns, [2])
    np.testing.assert_array_equal(log.online.poses, [np.arange(6.0)])
    np.testing.assert_array_equal(log.stamps, [1, 2])


def test_beams_are_looked_up_once_before_their_history_is_forgotten() -> None:
    poses, whole = reckoned(), filled()
    log, history = BeamLog(), DeadReckoningHistory()
    for number, pose in enumerate(poses):
        stamp = number * PERIOD_NS
        history.append(Odometry(stamp, pose, np.eye(6), np.zeros(6), np.eye(6)))
        log.add(stamp, None)
        if number % A_TURN == 0:
            log.resolve(history)
            history.forget_before(stamp)
    log.resolve(history)
    np.testing.assert_array_equal(log.dead_reckoning.poses, whole.dead_reckoning.poses)
