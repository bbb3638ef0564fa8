# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections import Counter
from contextlib import AbstractContextManager, nullcontext

import numpy as np
import pytest
from estimate_checks import assert_same_bytes, assert_sound
from small_mission import LAUNCH_NS, estimated, position_errors, recorded, run, seconds_of, until

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.scans.scan_generator import BLOCK
from msss_graphslam.core.types import (
    Beam,
    ConstraintKind,
    Estimate,
)
from msss_graphslam.simulation.echo_model import EchoKind

EVERY_ESTIMATOR = pytest.mark.parametrize("estimator", list(ESTIMATORS))
WINDOW = Configuration().sensors.reorder_window


def count(estimate: Estimate, kind: ConstraintKind) -> int:
    return sum(entry.kind is kind and entry.accepted for entry in estimate.constraints)


@pytest.mark.parametrize(
    ("estimator", "mean", "online"),
    [
        ("dead_reckoning", 0.8, 0.8),
        ("uspic", 0.4, 0.4),
        ("chen2015", 0.4, 0.4),
        ("full", 0.06, 0.12),
    ],
)
def test_accuracy_on_a_short_mission(estimator: str, mean: float, online: float) -> None:
    estimate, truth = estimated(estimator), recorded().truth
    assert_sound(estimate, len(recorded().beams))
    assert position_errors(estimate.trajectory, truth).mean() < mean
    assert position_errors(estimate.online, truth).mean() < online


def test_accuracy_on_echoes_with_noise_ghosts_and_specks() -> None:
    mission = recorded(2, echo=EchoKind.REAL)
    estimate, _ = run(mission.measurements)
    assert_sound(estimate, len(mission.beams))
    assert position_errors(estimate.trajectory, mission.truth).mean() < 0.06


def test_dead_reckoning_alone_is_a_good_deal_worse() -> None:
    """Otherwise the limits above would say nothing."""
    truth = recorded().truth
    reckoned = position_errors(estimated("dead_reckoning").trajectory, truth).mean()
    assert reckoned > 5.0 * position_errors(estimated("full").trajectory, truth).mean()


def test_a_dvl_makes_dead_reckoning_better() -> None:
    mission = recorded(1, dvl=True)
    estimate, _ = run(mission.measurements, "dead_reckoning")
    without = position_errors(estimated("dead_reckoning").trajectory, mission.truth)
    assert position_errors(estimate.trajectory, mission.truth).mean() < 0.5 * without.mean()


def test_dead_reckoning_is_its_own_trajectory() -> None:
    estimate = estimated("dead_reckoning")
    np.testing.assert_allclose(estimate.trajectory.poses, estimate.dead_reckoning.poses, atol=1e-6)
    assert {entry.kind for entry in estimate.constraints} == {ConstraintKind.ODOMETRY}


@EVERY_ESTIMATOR
def test_what_each_estimator_uses(estimator: str) -> None:
    estimate, recipe = estimated(estimator), ESTIMATORS[estimator]
    turns = len(estimate.keyframes) - 1
    kinds = Counter(entry.kind for entry in estimate.constraints)
    assert estimate.estimator == estimator
    assert count(estimate, ConstraintKind.CONSECUTIVE) == (turns if recipe.matcher else 0)
    assert (kinds[ConstraintKind.ODOMETRY] > 0) is (estimator in ("dead_reckoning", "full"))
    if not recipe.closes_loops:
        assert kinds[ConstraintKind.LOOP] == 0


def test_full_closes_loops() -> None:
    assert count(estimated("full"), ConstraintKind.LOOP) > 10


def test_the_first_pose_is_the_dead_reckoning_s() -> None:
    estimate = estimated("full")
    np.testing.assert_allclose(
        estimate.trajectory.poses[0], estimate.dead_reckoning.poses[0], atol=1e-6
    )


def test_the_trajectory_goes_through_the_keyframes() -> None:
    estimate = estimated("full")
    stamps = [keyframe.scan.stamp_ns for keyframe in estimate.keyframes]
    at = np.searchsorted(estimate.trajectory.stamps_ns, stamps)
    poses = np.array([keyframe.pose for keyframe in estimate.keyframes])
    np.testing.assert_allclose(estimate.trajectory.planar[at, :2], poses[:, :2], atol=1e-9)


def test_the_trajectory_is_smooth() -> None:
    steps = np.diff(estimated("full").trajectory.planar[:, :2], axis=0)
    assert np.linalg.norm(steps, axis=1).max() < 0.02


@EVERY_ESTIMATOR
def test_the_same_measurements_give_the_same_bytes(estimator: str) -> None:
    measurements = until(30.0)
    assert_same_bytes(run(measurements, estimator)[0], run(measurements, estimator)[0])


def test_the_order_of_arrival_does_not_matter_within_the_window() -> None:
    rng = np.random.default_rng(0)
    measurements = until(35.0)
    delays = rng.uniform(0.0, WINDOW, len(measurements))
    arrival = np.argsort([seconds_of(entry) for entry in measurements] + delays, kind="stable")
    shuffled = [measurements[index] for index in arrival]
    assert shuffled != measurements
    estimate, refused = run(shuffled)
    assert_same_bytes(estimate, run(measurements)[0])
    assert not refused


def test_online_uses_nothing_later() -> None:
    early, late = run(until(30.0))[0], run(until(40.0))[0]
    known = len(early.online.stamps_ns)
    assert known > 600
    np.testing.assert_array_equal(early.online.poses, late.online.poses[:known])


def test_online_begins_with_the_first_pose_that_there_is() -> None:
    estimate = estimated("full")
    first = (estimate.online.stamps_ns[0] - LAUNCH_NS) * 1e-9
    alignment = Configuration().dead_reckoning.alignment_time
    assert alignment <= first < alignment + 0.1
    assert len(estimate.online.stamps_ns) > len(recorded().beams) - 30


def test_online_is_dead_reckoning_where_nothing_corrects_it() -> None:
    """Corrections come a little after the turn's end; what has moved since counts once."""
    estimate = estimated("dead_reckoning")
    at = np.searchsorted(estimate.dead_reckoning.stamps_ns, estimate.online.stamps_ns)
    away = estimate.online.poses - estimate.dead_reckoning.poses[at]
    assert np.linalg.norm(away[:, :2], axis=1).max() < 0.0005


def test_every_stage_is_entered() -> None:
    entered: Counter[str] = Counter()

    def stage(name: str) -> AbstractContextManager[object]:
        entered[name] += 1
        return nullcontext()

    pipeline = Pipeline(Configuration(), ESTIMATORS["full"], Counter(), stage)
    for entry in until(30.0):
        pipeline.process(entry)
    pipeline.finish()
    beams = sum(isinstance(entry, Beam) for entry in until(30.0))
    turns = entered["scan_generation"]
    assert beams / BLOCK <= entered["beam_segmentation"] <= beams / BLOCK + turns
    assert set(entered) == {
        "dead_reckoning",
        "beam_segmentation",
        "scan_generation",
        "scan_matching",
        "data_association",
        "trajectory_correction",
        "back_end",
        "joint_smoothing",
    }


def test_progress_ends_at_one_or_before() -> None:
    pipeline = Pipeline(Configuration(), ESTIMATORS["full"], Counter())
    for entry in until(30.0):
        pipeline.process(entry)
    reported: list[float] = []
    pipeline.finish(reported.append)
    assert reported == sorted(reported)
    assert 0.0 < reported[-1] <= 1.0
