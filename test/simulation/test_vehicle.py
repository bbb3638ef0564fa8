# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from msss_graphslam.simulation.inertial import (
    NoiseLevel,
    measure_inertial,
    measure_pressure,
    measure_velocity,
)
from msss_graphslam.simulation.vehicle import Motion, drive
from msss_graphslam.simulation.worlds import world_named


@pytest.fixture(scope="module")
def motion() -> Motion:
    world = world_named("paper")
    return drive(world.path, world.laps, world.depth, 3, 1.0)


def dead_reckoning_error(seed: int, scale: float) -> float:
    """Mean error [m] of 0.1 m/s along the compass, the plainest dead reckoning there is."""
    world = world_named("paper")
    motion = drive(world.path, world.laps, world.depth, seed, scale)
    samples = measure_inertial(motion, seed, scale)
    yaw = samples.orientations[:, 2]
    steps = 0.1 * 0.04 * np.stack([np.cos(yaw), np.sin(yaw)], axis=1)
    error = np.cumsum(steps, axis=0) - motion.at(samples.times)[:, :2]
    return float(np.linalg.norm(error, axis=1).mean())


def test_dead_reckoning_drifts_as_in_the_paper() -> None:
    errors = [dead_reckoning_error(seed, NoiseLevel.PAPER.scale) for seed in range(20)]
    assert 5.0 < np.mean(errors) < 7.0


def test_noise_levels_are_ordered() -> None:
    mean = {
        level: np.mean([dead_reckoning_error(seed, level.scale) for seed in range(4)])
        for level in NoiseLevel
    }
    assert 2.0 * mean[NoiseLevel.LOW] < mean[NoiseLevel.PAPER] < mean[NoiseLevel.HIGH]


def test_the_speed_has_its_mean_and_deviation() -> None:
    world = world_named("marina")
    velocities = drive(world.path, world.laps, 2.0, 5, 1.0)
    speed = np.linalg.norm(velocities.velocities_at(velocities.times)[:, :2], axis=1)
    assert speed.mean() == pytest.approx(0.1, rel=0.1)
    assert speed.std() == pytest.approx(0.02, rel=0.35)
    assert speed.min() > 0.01


def test_the_slip_shows_as_sideways_velocity(motion: Motion) -> None:
    velocity = motion.velocities_at(motion.times)
    slip = np.degrees(np.arctan2(velocity[:, 1], velocity[:, 0]))
    assert abs(slip.mean()) < 3.0
    assert slip.std() == pytest.approx(4.0, rel=0.4)


def test_integrated_velocities_lead_along_the_path(motion: Motion) -> None:
    velocity = motion.velocities_at(motion.times)
    yaw = motion.poses[:, 5]
    east = np.cos(yaw) * velocity[:, 0] - np.sin(yaw) * velocity[:, 1]
    np.testing.assert_allclose(np.cumsum(east) * motion.period, motion.poses[:, 0], atol=5e-3)


def test_integrated_gyros_give_the_attitude(motion: Motion) -> None:
    """Rates are in the body frame: turn a rotation matrix by them."""
    count = 5000
    rates = motion.angular_velocities_at(motion.times[:count] + 0.5 * motion.period)
    attitude = Rotation.from_euler("ZYX", motion.poses[0, :2:-1])
    for rate in rates[:-1]:
        attitude = attitude * Rotation.from_rotvec(rate * motion.period)
    expected = Rotation.from_euler("ZYX", motion.poses[count - 1, :2:-1])
    assert np.degrees((attitude.inv() * expected).magnitude()) < 0.05


def test_the_compass_is_true_at_launch_and_drifts_slowly(motion: Motion) -> None:
    launch, later = [], []
    for seed in range(40):
        samples = measure_inertial(motion, seed, 1.0)
        error = np.degrees(samples.orientations[:, 2] - motion.at(samples.times)[:, 5])
        launch.append(error[:25].mean())
        later.append(error[-25:].mean())
        assert np.std(np.diff(error)) == pytest.approx(0.5 * np.sqrt(2.0), rel=0.05)
    assert np.std(launch) < 0.6
    assert np.std(later) == pytest.approx(6.0, rel=0.4)


def test_gyros_have_their_noise_and_a_constant_bias(motion: Motion) -> None:
    samples = measure_inertial(motion, 1, 1.0)
    error = np.degrees(samples.angular_velocities - motion.angular_velocities_at(samples.times))
    np.testing.assert_allclose(error.std(axis=0), 0.15, rtol=0.05)
    assert np.abs(error.mean(axis=0)).max() < 0.08


def test_pressure_is_absolute_and_follows_the_depth(motion: Motion) -> None:
    samples = measure_pressure(motion, 1)
    depth = (samples.pressures - 101_325.0) / (1000.0 * 9.80665)
    error = depth + motion.at(samples.times)[:, 2]
    assert abs(error.mean()) < 0.002
    assert error.std() == pytest.approx(0.0102, rel=0.05)


def test_the_dvl_measures_the_body_velocity(motion: Motion) -> None:
    samples = measure_velocity(motion, 1)
    error = samples.velocities - motion.velocities_at(samples.times)
    np.testing.assert_allclose(error.std(axis=0), 0.01, rtol=0.05)
    assert np.diff(samples.times).max() == pytest.approx(0.2)
