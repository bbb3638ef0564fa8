# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from synthetic_run import LAUNCH, synthetic_run, without_keyframes

from msss_graphslam.core.types import SonarCalibration
from msss_graphslam.evaluation.assessment import assess, dead_reckoned_points
from msss_graphslam.evaluation.headlines import headlines
from msss_graphslam.evaluation.result_table import evaluate_directory, result_table
from msss_graphslam.evaluation.summary import summarise
from msss_graphslam.results.directory import ResultDirectory

ALWAYS = {
    "duration_s",
    "wall_s",
    "cpu_s",
    "realtime_factor",
    "peak_rss_mib",
    "beams",
    "scans",
    "loop_closures",
    "refused",
    "damage",
    "missing",
    "start_end_gap_m",
    "configuration",
}
WITH_TRUTH = {"position_error_m", "online_position_error_m"}


@pytest.fixture(scope="module")
def assessment():
    return assess(synthetic_run(6))


@pytest.fixture(scope="module")
def blind():
    return assess(synthetic_run(6, with_truth=False))


def test_the_summary_has_the_promised_keys(assessment):
    summary = summarise(assessment)
    assert set(summary) == ALWAYS | WITH_TRUTH
    assert summary["beams"] == 360
    assert summary["scans"] == 6
    assert summary["refused"] == {"beam_without_bins": 3, "imu_not_finite": 1}
    assert set(summary["loop_closures"]) == {"tried", "accepted"}
    assert set(summary["position_error_m"]) == {"dead_reckoning", "full"}
    assert set(summary["position_error_m"]["full"]) == {"mean", "rmse", "max"}
    assert set(summary["online_position_error_m"]) == {"full"}
    assert set(summary["start_end_gap_m"]) == {"dead_reckoning", "full"}
    assert summary["configuration"]["estimator"] == "full"


def test_without_truth_there_is_no_error_anywhere(blind):
    assert set(summarise(blind)) == ALWAYS
    assert blind.errors == {}
    assert blind.online_errors is None
    assert blind.keyframe_consistency is None
    assert blind.anchored_truth is None
    for row in result_table([blind]):
        assert (row.anchored, row.aligned, row.heading) == (None, None, None)
        assert row.start_end_gap > 0.0


def test_a_truth_of_another_time_makes_no_numbers_and_is_said(assessment):
    truth = assessment.record.truth
    late = replace(truth, stamps_ns=truth.stamps_ns + 10**15)
    other = assess(replace(assessment.record, truth=late))
    assert set(summarise(other)) == ALWAYS
    assert "covers no time" in other.truth_note


def test_the_estimate_is_better_than_dead_reckoning_and_anchored(assessment):
    summary = summarise(assessment)["position_error_m"]
    assert summary["full"]["mean"] < 0.1 < summary["dead_reckoning"]["mean"]
    shift = assessment.record.truth.planar - LAUNCH
    np.testing.assert_allclose(assessment.anchored_truth, shift, atol=1e-9)


def test_dead_reckoning_alone_is_one_row_and_one_entry():
    alone = assess(synthetic_run(3, estimator="dead_reckoning"))
    assert [row.name for row in result_table([alone])] == ["dead_reckoning"]
    assert set(summarise(alone)["position_error_m"]) == {"dead_reckoning"}


def test_a_comparison_has_dead_reckoning_once_and_each_estimator_twice():
    runs = [
        assess(synthetic_run(3, estimator=name)) for name in ("dead_reckoning", "uspic", "full")
    ]
    names = [row.name for row in result_table(runs)]
    assert names == ["dead_reckoning", "uspic", "uspic, online", "full", "full, online"]


def test_the_dead_reckoned_map_is_thicker():
    assessment = assess(synthetic_run(12))
    points = dead_reckoned_points(assessment.record.estimate)
    assert len(points) == len(assessment.record.points)
    assert assessment.dead_reckoned_thickness > 1.5 * assessment.thickness


def test_keyframes_are_judged_without_the_fixed_one(assessment):
    assert assessment.keyframe_consistency.samples == 5
    frames = assessment.record.estimate.keyframes
    blown = tuple(replace(frame, covariance=100.0 * frame.covariance) for frame in frames)
    estimate = replace(assessment.record.estimate, keyframes=blown)
    timid = assess(replace(assessment.record, estimate=estimate)).keyframe_consistency
    assert timid.mean == pytest.approx(assessment.keyframe_consistency.mean / 100.0)


def test_a_wrong_launch_heading_is_no_error_of_the_keyframes(assessment):
    truth = assessment.record.truth
    angle = 0.3
    poses = truth.poses.copy()
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    poses[:, :2] = poses[:, :2] @ turn
    poses[:, 5] += angle
    turned = assess(replace(assessment.record, truth=replace(truth, poses=poses)))
    assert turned.errors["full"].anchored.max() > 1.0
    np.testing.assert_allclose(turned.keyframe_errors, assessment.keyframe_errors, atol=1e-9)


def test_covariances_of_zero_are_not_judged(assessment):
    frames = assessment.record.estimate.keyframes
    sure = tuple(replace(frame, covariance=np.zeros((3, 3))) for frame in frames)
    estimate = replace(assessment.record.estimate, keyframes=sure)
    assert assess(replace(assessment.record, estimate=estimate)).keyframe_consistency is None


def test_less_than_a_turn_is_assessed(assessment):
    short = assess(without_keyframes(assessment.record))
    assert summarise(short)["scans"] == 0
    assert short.thickness is None
    assert short.keyframe_consistency is None


def test_a_directory_is_evaluated_as_the_run_was(assessment, tmp_path):
    directory = ResultDirectory.create(tmp_path)
    directory.write_estimate(assessment.record)
    rows = {row.name: row for row in evaluate_directory(directory, assessment.record.truth)}
    table = {row.name: row for row in result_table([assessment])}
    for name, other in (
        ("dead_reckoning", "dead_reckoning"),
        ("trajectory", "full"),
        ("online", "full, online"),
    ):
        assert rows[name].anchored.mean == pytest.approx(table[other].anchored.mean, abs=1e-8)
        assert rows[name].aligned.max == pytest.approx(table[other].aligned.max, abs=1e-8)


def test_a_head_that_disagrees_with_the_velocity_sensor_is_told(assessment):
    run = assessment.record
    found = SonarCalibration(0.03, 1.005, np.diag([0.01, 0.02]) ** 2)
    told = assess(replace(run, estimate=replace(run.estimate, sonar_calibration=found)))
    assert summarise(told)["sonar_calibration"] == {
        "mount_yaw_rad": 0.03,
        "mount_yaw_deviation_rad": 0.01,
        "range_scale": 1.005,
        "range_scale_deviation": 0.02,
    }
    (line,) = (entry for entry in headlines([told]) if entry.name == "head against DVL")
    assert line.value == "+1.7\u00b0"
    assert line.note == "\u00b1 0.6\u00b0; ranges \u00d7 1.005 \u00b1 0.020"
    assert len(headlines([assessment])) == len(headlines([told])) - 1
