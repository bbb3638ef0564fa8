# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msss_graphslam.core.types import Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.evaluation.alignment import align
from msss_graphslam.evaluation.errors import (
    LONGEST_TRUTH_GAP_NS,
    Statistics,
    interpolate,
    position_errors,
    start_end_gap,
)

SECOND = 1_000_000_000


def trajectory(seconds, planar):
    poses = np.zeros((len(planar), 6))
    poses[:, [0, 1, 5]] = planar
    return Trajectory((np.array(seconds) * SECOND).astype(np.int64), poses)


def moved(planar, x, y, yaw):
    cosine, sine = np.cos(yaw), np.sin(yaw)
    turned = planar[:, :2] @ np.array([[cosine, sine], [-sine, cosine]])
    return np.column_stack([turned + np.array([x, y]), planar[:, 2] + yaw])


def test_anchored_errors_by_hand():
    truth = trajectory([0, 1, 2], [[10.0, 5.0, 0.0], [11.0, 5.0, 0.0], [12.0, 5.0, 0.0]])
    estimate = trajectory([0, 1, 2], [[0.0, 0.0, 0.1], [1.0, 0.3, 0.1], [2.0, 0.4, -0.1]])
    errors = position_errors(estimate, truth)
    np.testing.assert_allclose(errors.anchored, [0.0, 0.3, 0.4], atol=1e-12)
    np.testing.assert_allclose(errors.heading, [0.1, 0.1, -0.1], atol=1e-12)
    np.testing.assert_allclose(errors.truth[:, :2], [[0, 0], [1, 0], [2, 0]], atol=1e-12)
    statistics = Statistics.of(errors.anchored)
    assert statistics.mean == pytest.approx(0.7 / 3.0)
    assert statistics.rmse == pytest.approx(np.sqrt(0.25 / 3.0))
    assert statistics.max == pytest.approx(0.4)


def test_an_estimate_that_begins_late_has_the_error_of_its_frame():
    truth = trajectory(range(4), [[float(x), 0.0, 0.0] for x in range(4)])
    whole = trajectory(range(4), [[float(x), 0.0, 0.0] for x in range(4)])
    late = trajectory([2, 3], [[2.0, 0.7, 0.0], [3.0, 0.1, 0.0]])
    np.testing.assert_allclose(position_errors(late, truth, whole).anchored, [0.7, 0.1])
    np.testing.assert_allclose(position_errors(late, truth).anchored, [0.0, 0.6])


def test_depth_is_no_error():
    truth = trajectory([0, 1], [[0, 0, 0], [1, 0, 0]])
    estimate = trajectory([0, 1], [[0, 0, 0], [1, 0, 0]])
    estimate.poses[:, 2] = -30.0
    assert position_errors(estimate, truth).anchored.max() == 0.0


def test_an_error_of_the_launch_heading_counts_anchored_but_not_aligned():
    planar = np.column_stack([np.linspace(0.0, 10.0, 11), np.zeros(11), np.zeros(11)])
    errors = position_errors(
        trajectory(range(11), moved(planar, 0.0, 0.0, 0.1)), trajectory(range(11), planar)
    )
    assert errors.anchored[-1] == pytest.approx(2.0 * 10.0 * np.sin(0.05))
    np.testing.assert_allclose(errors.aligned, 0.0, atol=1e-12)
    np.testing.assert_allclose(errors.heading, 0.1)


shifts = st.floats(-100.0, 100.0)


@given(shifts, shifts, st.floats(-3.1, 3.1), st.integers(0, 2**32 - 1))
def test_aligned_errors_do_not_depend_on_where_the_estimate_lies(x, y, yaw, seed):
    generator = np.random.default_rng(seed)
    planar = generator.normal(0.0, 10.0, (20, 3))
    truth = trajectory(range(20), planar)
    noisy = planar + generator.normal(0.0, 0.5, planar.shape)
    here = position_errors(trajectory(range(20), noisy), truth)
    there = position_errors(trajectory(range(20), moved(noisy, x, y, yaw)), truth)
    np.testing.assert_allclose(there.aligned, here.aligned, atol=1e-8)
    assert np.sum(here.aligned**2) <= np.sum(here.anchored**2) + 1e-9


@given(shifts, shifts)
def test_anchored_errors_do_not_depend_on_the_origin_of_truth(x, y):
    planar = np.random.default_rng(2).normal(size=(10, 3))
    estimate = trajectory(range(10), planar)
    truth = planar[::-1] + np.array([x, y, 0.0])
    reference = position_errors(estimate, trajectory(range(10), planar[::-1]))
    errors = position_errors(estimate, trajectory(range(10), truth))
    np.testing.assert_allclose(errors.anchored, reference.anchored, atol=1e-9)


def test_alignment_keeps_scale():
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    np.testing.assert_allclose(np.ptp(align(1.1 * square, square), axis=0), [2.2, 1.1])


def test_alignment_does_not_mirror():
    corner = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]])
    first, second, third = align(corner * [1.0, -1.0], corner)
    assert np.linalg.det([second - first, third - first]) == pytest.approx(-2.0)


def test_truth_is_interpolated_the_short_way_round():
    truth = trajectory([0, 2], [[0.0, 0.0, 3.0], [4.0, 2.0, -3.0]])
    poses, covered = interpolate(truth, np.array([SECOND // 2]))
    assert covered.tolist() == [True]
    np.testing.assert_allclose(poses[0, :2], [1.0, 0.5])
    assert poses[0, 2] == pytest.approx(3.0 + 0.25 * (2.0 * np.pi - 6.0))


def test_heading_errors_are_wrapped():
    truth = trajectory([0, 1], [[0, 0, 3.1], [1, 0, 3.1]])
    estimate = trajectory([0, 1], [[0, 0, -3.1], [1, 0, -3.1]])
    np.testing.assert_allclose(position_errors(estimate, truth).heading, 2.0 * np.pi - 6.2)


def test_stamps_outside_the_truth_are_left_out_and_counted():
    truth = trajectory([1, 2, 3], [[0, 0, 0], [1, 0, 0], [2, 0, 0]])
    estimate = trajectory([0, 1, 2, 3, 4, 5], [[9, 9, 0]] + [[k, 0, 0] for k in range(5)])
    errors = position_errors(estimate, truth)
    assert errors.left_out == 3
    np.testing.assert_allclose(errors.anchored, 0.0, atol=1e-12)


@pytest.mark.parametrize(("excess_ns", "covered"), [(0, 3), (1, 2)])
def test_truth_is_not_interpolated_across_a_long_silence(excess_ns, covered):
    end = LONGEST_TRUTH_GAP_NS + excess_ns
    truth = Trajectory(np.array([0, end]), np.zeros((2, 6)))
    _, found = interpolate(truth, np.array([0, end // 2, end]))
    assert np.count_nonzero(found) == covered
    assert found[0]
    assert found[-1]


def test_nanoseconds_count_at_todays_epoch():
    start = 1_700_000_000 * SECOND
    truth = Trajectory(np.array([start, start + SECOND]), np.array([[0.0] * 6, [1.0] + [0.0] * 5]))
    poses, _ = interpolate(truth, np.array([start + 250_000_001]))
    assert poses[0, 0] == pytest.approx(0.250000001, abs=1e-12)


def test_truth_of_another_time_is_refused():
    path = [[0, 0, 0], [1, 0, 0]]
    with pytest.raises(UserError, match="covers no time"):
        position_errors(trajectory([0, 1], path), trajectory([100, 101], path))


def test_the_gap_is_from_the_first_to_the_last_position():
    assert start_end_gap(trajectory([0, 1, 2], [[1, 1, 0], [50, 9, 0], [4, 5, 0]])) == 5.0
