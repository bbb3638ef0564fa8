# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msss_graphslam.core.compounding import between, compose, wrap
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.scans.trajectory_correction import (
    Solver,
    closed_form,
    compose_corrected,
    correct,
    correct_motion,
    nelder_mead,
)
from msss_graphslam.core.types import Array

SOLVERS = pytest.mark.parametrize("solver", [closed_form, nelder_mead])


def odometry(seed: int, count: int = 240) -> Array:
    """A turn of the head at 0.1 m/s on a winding course."""
    rng = np.random.default_rng(seed)
    steps = np.tile([0.005, 0.0, rng.uniform(-0.004, 0.004)], (count, 1))
    return steps + rng.normal(0.0, [0.001, 0.001, 0.002], (count, 3))


def displaced(steps: Array, error: Array) -> Array:
    end = compose_corrected(steps, np.zeros(3))[-1] + error
    return np.array([end[0], end[1], float(wrap(end[2]))])


errors = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-0.3, 0.3)).map(np.array)


def test_composition_equals_a_loop_of_compounding() -> None:
    steps, delta = odometry(1), np.array([0.001, -0.002, 0.003])
    pose, expected = np.zeros(3), []
    for step in steps:
        pose = compose(pose, compose(step, delta))
        expected.append(pose)
    np.testing.assert_allclose(compose_corrected(steps, delta), expected, atol=1e-12)


@SOLVERS
@given(st.integers(0, 1000), errors)
@settings(max_examples=15, deadline=None)
def test_the_end_meets_the_next_keyframe(solver: Solver, seed: int, error: Array) -> None:
    steps = odometry(seed)
    target = displaced(steps, error)
    end = correct(steps, target, solver).poses[-1]
    np.testing.assert_allclose(end[:2], target[:2], atol=1e-12)
    assert abs(wrap(end[2] - target[2])) < 1e-12


@given(st.integers(0, 1000), errors)
@settings(max_examples=50, deadline=None)
def test_closed_form_solves_equation_14(seed: int, error: Array) -> None:
    steps = odometry(seed)
    target = displaced(steps, error)
    end = compose_corrected(steps, closed_form(steps, target))[-1]
    np.testing.assert_allclose(between(target, end), np.zeros(3), atol=1e-10)


@given(st.integers(0, 1000), errors)
@settings(max_examples=15, deadline=None)
def test_nelder_mead_finds_the_same_correction(seed: int, error: Array) -> None:
    steps = odometry(seed)
    target = displaced(steps, error)
    np.testing.assert_allclose(nelder_mead(steps, target), closed_form(steps, target), atol=2e-7)


@SOLVERS
def test_nothing_to_correct_changes_nothing(solver: Solver) -> None:
    steps = odometry(2)
    reckoned = compose_corrected(steps, np.zeros(3))
    correction = correct(steps, reckoned[-1], solver)
    np.testing.assert_allclose(correction.delta, np.zeros(3), atol=1e-7)
    np.testing.assert_allclose(correction.poses, reckoned, atol=1e-6)


@SOLVERS
def test_correction_is_the_same_in_every_step(solver: Solver) -> None:
    steps = odometry(3)
    correction = correct(steps, displaced(steps, np.array([0.4, -0.3, 0.1])), solver)
    poses = np.vstack([np.zeros(3), correction.poses])
    shares = between(steps, between(poses[:-1], poses[1:]))
    np.testing.assert_allclose(shares, np.tile(correction.delta, (240, 1)), atol=1e-6)


def test_heading_error_of_more_than_half_a_turn_goes_the_short_way() -> None:
    steps = np.tile([0.005, 0.0, 0.012], (240, 1))
    target = displaced(steps, np.array([0.0, 0.0, 0.3]))
    assert target[2] < 0.0
    np.testing.assert_allclose(closed_form(steps, target)[2], 0.3 / 240, atol=1e-12)


def test_a_whole_turn_of_the_vehicle_is_still_met_with_small_corrections() -> None:
    steps = np.tile([0.005, 0.0, 2.0 * np.pi / 240], (240, 1))
    reckoned = compose_corrected(steps, np.zeros(3))
    target = displaced(steps, np.array([0.4, -0.3, 0.0]))
    poses = correct(steps, target, closed_form).poses
    np.testing.assert_allclose(between(target, poses[-1]), np.zeros(3), atol=1e-12)
    assert np.hypot(*(poses - reckoned)[:, :2].T).max() < 0.51


def test_a_rest_across_the_turn_of_the_angle_is_small() -> None:
    def just_off(relative_odometry: Array, target: Array) -> Array:
        return np.add(closed_form(relative_odometry, target), [0.0, 0.0, 1e-9])

    steps = np.tile([0.005, 0.0, np.pi / 240], (240, 1))
    target = compose_corrected(steps, np.zeros(3))[-1]
    target[2] = np.pi - 1e-9
    poses = correct(steps, target, just_off).poses
    np.testing.assert_allclose(poses[:-1, 2], np.cumsum(steps[:, 2])[:-1], atol=1e-6)


def test_one_step_takes_the_whole_correction() -> None:
    target = np.array([1.0, 2.0, 0.5])
    correction = correct(np.array([[0.9, 2.2, 0.4]]), target, closed_form)
    np.testing.assert_allclose(correction.poses, [target], atol=1e-12)


@SOLVERS
def test_motion_of_a_scan_keeps_its_first_pose(solver: Solver) -> None:
    reckoned = np.vstack([np.zeros(3), compose_corrected(odometry(4), np.zeros(3))])
    target = reckoned[-1] + [0.2, 0.1, 0.05]
    motion = correct_motion(reckoned[:-1], reckoned[-1], target, solver).poses
    assert motion.shape == (240, 3)
    np.testing.assert_array_equal(motion[0], np.zeros(3))
    shift = np.hypot(*(motion - reckoned[:-1])[:, :2].T)
    assert 0.0 < shift[100] < shift[-1] < 0.23


def test_the_paper_s_estimators_search_as_the_paper_does() -> None:
    assert ESTIMATORS["full"].solver is closed_form
    assert {ESTIMATORS[name].solver for name in ("uspic", "chen2015")} == {nelder_mead}
