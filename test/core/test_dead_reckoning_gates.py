# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import itertools
from dataclasses import replace

import numpy as np
import pytest
from reckoned import (
    CONFIG,
    LEVEL,
    Run,
    beam,
    depth,
    imu,
    nanoseconds,
    seconds_of,
    times,
    turning,
)

from msss_graphslam.core.types import (
    BodyVelocity,
    Inertial,
    Measurement,
)


@pytest.mark.parametrize(("share", "refused"), [(0.99, 0), (1.01, 1)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_depth_gate_from_both_sides(share: float, refused: int, sign: float) -> None:
    run = Run().feed([depth(0.0, -1.0), *turning(5.0, 0.0)])
    spread = run.last.covariance[2, 2] + CONFIG.depth_noise**2
    jump = sign * share * CONFIG.innovation_gate * float(np.sqrt(spread))
    run.feed_late(depth(5.0, run.last.pose[2] + jump))
    assert run.refused["depth_innovation"] == refused


@pytest.mark.parametrize(("share", "refused"), [(0.99, 0), (1.01, 1)])
@pytest.mark.parametrize(("angle", "name"), [(0, "roll"), (1, "pitch"), (2, "yaw")])
def test_the_attitude_gates_from_both_sides(
    share: float, refused: int, angle: int, name: str
) -> None:
    run = Run(replace(CONFIG, compass_drift=0.0)).feed(turning(5.0, 0.0))
    spread = run.last.covariance[3 + angle, 3 + angle] + CONFIG.compass_noise**2
    angles = run.last.pose[3:].copy()
    angles[angle] += share * CONFIG.innovation_gate * np.sqrt(spread)
    run.feed_late(Inertial(nanoseconds(5.0), angles, LEVEL))
    assert run.refused[f"{name}_innovation"] == refused
    assert sum(run.refused.values()) == refused


@pytest.mark.parametrize(("share", "refused"), [(0.99, 0), (1.01, 1)])
def test_the_dvl_gate_from_both_sides(share: float, refused: int) -> None:
    run = Run().feed(turning(5.0, 0.0))
    spread = run.last.twist_covariance[1, 1] + 1e-4
    velocity = run.last.twist[:3].copy()
    velocity[1] += share * CONFIG.innovation_gate * np.sqrt(spread)
    run.feed_late(BodyVelocity(nanoseconds(5.0), velocity, 1e-4 * np.eye(3)))
    assert run.refused["dvl_y_innovation"] == refused
    assert sum(run.refused.values()) == refused


def test_a_single_outlier_moves_nothing() -> None:
    run = Run().feed([depth(0.0, -1.0), *turning(5.0, 0.0)])
    run.feed_late(depth(5.0, 50.0))
    (after,) = run.feed_late(imu(5.04))
    assert after.pose[2] == pytest.approx(-1.0, abs=1e-3)


def test_patience_ends_and_the_state_follows() -> None:
    before = [depth(time, -1.0) for time in times(0.0, 5.0, 0.1)]
    after = [depth(time, -6.0) for time in times(5.1, 12.0, 0.1)]
    run = Run().feed([*turning(12.0, 0.0), *before, *after])
    heights = np.array([entry.pose[2] for entry in run.odometry])
    stamps = np.array([seconds_of(entry) for entry in run.odometry])
    patient = (stamps > 5.2) & (stamps < 5.1 + CONFIG.patience)
    assert (heights[patient] > -1.1).all()
    np.testing.assert_allclose(heights[stamps > 5.2 + CONFIG.patience], -6.0, atol=0.05)
    assert run.refused["depth_reset"] == 1
    assert run.refused["depth_innovation"] == pytest.approx(CONFIG.patience / 0.1 + 1, abs=1)


def test_outliers_with_good_samples_between_never_exhaust_the_patience() -> None:
    heights = itertools.cycle([40.0, -1.0])
    depths = [depth(time, next(heights)) for time in times(1.0, 20.0, 0.1)]
    run = Run().feed([depth(0.0, -1.0), *turning(20.0, 0.0), *depths])
    assert run.refused["depth_reset"] == 0
    assert run.refused["depth_innovation"] == pytest.approx(95, abs=1)
    assert run.last.pose[2] == pytest.approx(-1.0, abs=0.05)


@pytest.mark.parametrize("late", [imu(4.9), depth(4.9, 0.0), beam(4.9)])
def test_what_comes_late_is_counted_and_left_out(late: Measurement) -> None:
    run = Run().feed(turning(5.0, 0.0))
    assert run.feed_late(late) == []
    assert run.refused == {"dead_reckoning_late": 1}
