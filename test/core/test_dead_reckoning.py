# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from msss_graphslam.config.groups import DeadReckoning as Config
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.dead_reckoning import DeadReckoning
from msss_graphslam.core.types import (
    Array,
    Beam,
    BodyVelocity,
    Depth,
    Inertial,
    Measurement,
    Odometry,
)

CONFIG = Config()
LEVEL = np.zeros(3)
PERIOD = 0.04
START_NS = 1_700_000_000_000_000_000


def nanoseconds(seconds: float) -> int:
    return START_NS + round(seconds * 1e9)


def heading(yaw: float) -> Array:
    return np.array([0.0, 0.0, float(wrap(yaw))])


def imu(seconds: float, yaw: float = 0.0, rate: float = 0.0) -> Inertial:
    return Inertial(nanoseconds(seconds), heading(yaw), np.array([0.0, 0.0, rate]))


def beam(seconds: float) -> Beam:
    return Beam(nanoseconds(seconds), 0.0, np.array([1.0]), np.array([0.0]))


def depth(seconds: float, z: float) -> Depth:
    return Depth(nanoseconds(seconds), z)


def times(start: float, stop: float, period: float = PERIOD) -> list[float]:
    return [float(time) for time in np.arange(start, stop + 1e-9, period)]


def turning(duration: float, rate: float, start: float = 0.0) -> list[Measurement]:
    return [imu(time, start + rate * time, rate) for time in times(0.0, duration)]


class Run:
    """Dead reckoning, what it gave and what it refused."""

    def __init__(self, config: Config = CONFIG) -> None:
        self.refused: Counter[str] = Counter()
        self.odometry: list[Odometry] = []
        self._dead_reckoning = DeadReckoning(config, self.refused)

    def feed(self, measurements: Iterable[Measurement]) -> "Run":
        for measurement in sorted(measurements, key=lambda entry: entry.stamp_ns):
            self.feed_late(measurement)
        return self

    def feed_late(self, measurement: Measurement) -> list[Odometry]:
        brought = self._dead_reckoning.process(measurement)
        self.odometry += brought
        return brought

    def start(self) -> "Run":
        self.odometry += self._dead_reckoning.start()
        return self

    @property
    def last(self) -> Odometry:
        return self.odometry[-1]


def test_straight_ahead_at_the_assumed_speed() -> None:
    run = Run().feed(turning(60.0, 0.0, start=0.5))
    expected = 60.0 * CONFIG.surge_speed * np.array([np.cos(0.5), np.sin(0.5)])
    np.testing.assert_allclose(run.last.pose[:2], expected, atol=1e-9)
    assert run.last.pose[5] == pytest.approx(0.5, abs=1e-9)
    assert len(run.odometry) == 1501
    assert not run.refused


def test_a_circle_closes() -> None:
    radius, rate = 1.0, 0.1
    run = Run().feed(turning(2.0 * np.pi / rate, rate))
    poses = np.array([entry.pose for entry in run.odometry])
    centre = np.array([0.0, radius])
    np.testing.assert_allclose(np.linalg.norm(poses[:, :2] - centre, axis=1), radius, atol=0.005)
    quarter = poses[round(0.5 * np.pi / rate / PERIOD)]
    np.testing.assert_allclose(quarter[[0, 1, 5]], [1.0, 1.0, 0.5 * np.pi], atol=0.01)
    np.testing.assert_allclose(poses[-1, :2], 0.0, atol=0.01)


@pytest.mark.parametrize("start", [np.pi - 0.05, -np.pi + 0.05])
@pytest.mark.parametrize("rate", [0.1, -0.1])
def test_the_heading_goes_through_half_a_turn_unharmed(start: float, rate: float) -> None:
    run = Run().feed(turning(10.0, rate, start))
    yaws = np.array([entry.pose[5] for entry in run.odometry])
    assert not run.refused
    assert (np.abs(yaws) <= np.pi).all()
    np.testing.assert_allclose(np.unwrap(yaws)[-1] - yaws[0], 10.0 * rate, atol=1e-6)


def test_a_dvl_takes_the_place_of_the_assumed_speed() -> None:
    velocity = np.array([0.16, 0.03, 0.0])
    dvl = [
        BodyVelocity(nanoseconds(time), velocity, 1e-4 * np.eye(3))
        for time in times(0.0, 100.0, 0.2)
    ]
    run = Run().feed([*turning(100.0, 0.0), *dvl])
    np.testing.assert_allclose(run.last.twist[:3], velocity, atol=0.002)
    np.testing.assert_allclose(run.last.pose[:2], 100.0 * velocity[:2], atol=0.15)
    assert run.last.covariance[0, 0] < (0.1 * CONFIG.surge_noise * 100.0) ** 2
    assert not run.refused


def test_a_silent_dvl_leaves_its_last_word_with_growing_doubt() -> None:
    dvl = [
        BodyVelocity(nanoseconds(time), np.array([0.16, 0.0, 0.0]), 1e-6 * np.eye(3))
        for time in times(0.0, 10.0, 0.2)
    ]
    run = Run().feed([*turning(110.0, 0.0), *dvl])
    last_word, later = run.odometry[round(10.0 / PERIOD)], run.last
    decay = np.exp(-100.0 / CONFIG.velocity_correlation_time)
    assert later.twist[0] == pytest.approx(0.1 + 0.06 * decay, abs=0.001)
    assert last_word.twist_covariance[0, 0] < 0.01 * CONFIG.surge_noise**2
    expected = CONFIG.surge_noise**2 * (1.0 - decay**2)
    assert later.twist_covariance[0, 0] == pytest.approx(expected, rel=0.01)


def test_depth_sets_the_height() -> None:
    depths = [depth(time, -3.0) for time in times(0.0, 10.0, 0.1)]
    run = Run().feed([*turning(10.0, 0.0), *depths])
    np.testing.assert_allclose([entry.pose[2] for entry in run.odometry], -3.0, atol=1e-9)


def test_without_orientation_the_gyro_turns_from_zero() -> None:
    samples = [
        Inertial(nanoseconds(time), None, np.array([0.0, 0.0, 0.1])) for time in times(0.0, 10.0)
    ]
    run = Run().feed(samples)
    assert run.last.pose[5] == pytest.approx(1.0, abs=1e-9)
    assert run.last.twist[5] == 0.1


def test_without_rates_the_heading_follows_the_compass() -> None:
    samples = [Inertial(nanoseconds(time), heading(0.05 * time), None) for time in times(0, 40.0)]
    run = Run().feed(samples)
    assert run.last.pose[5] == pytest.approx(2.0, abs=0.05)
    with_gyro = Run().feed(turning(2.0, 0.0)).last.twist_covariance[5, 5]
    assert with_gyro < run.last.twist_covariance[5, 5] < 0.1 * CONFIG.turn_rate_noise**2
    assert not run.refused


def test_without_an_imu_the_beams_clock() -> None:
    run = Run().feed([beam(time) for time in times(0.0, 20.0)])
    assert len(run.odometry) == 501
    np.testing.assert_allclose(run.last.pose, [2.0, 0.0, 0.0, 0.0, 0.0, 0.0], atol=1e-9)
    doubt = CONFIG.turn_rate_noise**2 * 20.0
    assert run.last.covariance[5, 5] == pytest.approx(doubt, rel=1e-6)


def test_the_beams_clock_while_the_imu_is_silent() -> None:
    samples = [entry for entry in turning(30.0, 0.0) if not 10.0 < _time(entry) < 20.0]
    run = Run().feed([*samples, *[beam(time) for time in times(0.02, 30.0)]])
    silent = [entry for entry in run.odometry if 10.0 < _time(entry) < 20.0]
    first = _time(silent[0]) - 10.0
    assert CONFIG.sensor_timeout < first < CONFIG.sensor_timeout + 2.0 * PERIOD
    np.testing.assert_allclose(np.diff([_time(entry) for entry in silent]), PERIOD, atol=1e-6)
    assert run.last.pose[0] == pytest.approx(3.0, abs=1e-9)
    assert run.last.stamp_ns == nanoseconds(30.0)


def test_a_silent_gyro_is_not_believed_to_go_on_turning() -> None:
    run = Run().feed(turning(10.0, 0.1)).feed([beam(time) for time in times(10.02, 15.0)])
    assert run.last.twist[5] == 0.0
    assert run.last.pose[5] == pytest.approx(1.0, abs=0.01)
    assert run.last.twist_covariance[5, 5] == pytest.approx(CONFIG.turn_rate_noise**2 / 10.0)


def _time(entry: Measurement | Odometry) -> float:
    return (entry.stamp_ns - START_NS) * 1e-9


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
    velocity = run.last.twist[:3] + [0.0, share * CONFIG.innovation_gate * spread**0.5, 0.0]
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
    stamps = np.array([_time(entry) for entry in run.odometry])
    patient = (stamps > 5.2) & (stamps < 5.1 + CONFIG.patience)
    assert (heights[patient] > -1.1).all()
    np.testing.assert_allclose(heights[stamps > 5.2 + CONFIG.patience], -6.0, atol=0.05)
    assert run.refused["depth_reset"] == 1
    assert run.refused["depth_innovation"] == pytest.approx(CONFIG.patience / 0.1 + 1, abs=1)


def test_outliers_with_good_samples_between_never_exhaust_the_patience() -> None:
    depths = [
        depth(time, -1.0 if number % 2 else 40.0) for number, time in enumerate(times(1.0, 20, 0.1))
    ]
    run = Run().feed([depth(0.0, -1.0), *turning(20.0, 0.0), *depths])
    assert run.refused["depth_reset"] == 0
    assert run.refused["depth_innovation"] == pytest.approx(95, abs=1)
    assert run.last.pose[2] == pytest.approx(-1.0, abs=0.05)


@pytest.mark.parametrize("late", [imu(4.9), depth(4.9, 0.0), beam(4.9)])
def test_what_comes_late_is_counted_and_left_out(late: Measurement) -> None:
    run = Run().feed(turning(5.0, 0.0))
    assert run.feed_late(late) == []
    assert run.refused == {"dead_reckoning_late": 1}


def test_a_drifting_compass_does_not_shake_the_heading_within_a_turn() -> None:
    steady = turning(20.0, 0.0)
    biased = [imu(time, 0.08) for time in times(20.04, 120.0)]
    run = Run().feed([*steady, *biased])
    yaws = np.array([entry.pose[5] for entry in run.odometry])
    after_a_turn = yaws[round(30.0 / PERIOD)]
    assert 0.0 < after_a_turn < 0.11 * 0.08
    assert yaws[-1] == pytest.approx(0.08 * (1.0 - np.exp(-1.0)), rel=0.05)


def test_alignment_averages_the_first_second_and_knows_how_well() -> None:
    rng = np.random.default_rng(0)
    noise = CONFIG.compass_noise
    first = []
    for _ in range(200):
        yaws = np.pi + noise * rng.normal(size=26)
        run = Run().feed([imu(PERIOD * number, yaw) for number, yaw in enumerate(yaws)])
        first.append(float(wrap(run.odometry[0].pose[5] - np.pi)))
    assert np.std(first) == pytest.approx(noise / np.sqrt(26.0), rel=0.15)
    assert np.mean(first) == pytest.approx(0.0, abs=3.0 * noise / np.sqrt(26.0 * 200.0))


def test_alignment_takes_the_turning_out() -> None:
    run = Run().feed(turning(1.0, 0.4, start=1.0))
    assert run.odometry[0].pose[5] == pytest.approx(1.0, abs=1e-9)


def test_nothing_comes_out_before_the_alignment_and_nothing_is_lost() -> None:
    run = Run()
    for number, time in enumerate(times(0.0, CONFIG.alignment_time)[:-1]):
        assert run.feed_late(imu(time)) == [], number
    brought = run.feed_late(imu(CONFIG.alignment_time))
    assert [entry.stamp_ns for entry in brought] == [
        nanoseconds(time) for time in times(0.0, CONFIG.alignment_time)
    ]


def test_a_recording_shorter_than_the_alignment_is_worked_off_at_the_end() -> None:
    run = Run().feed(turning(0.5, 0.0))
    assert not run.odometry
    assert len(run.start().odometry) == 13
    assert Run().start().odometry == []


def test_an_odometry_is_not_changed_by_the_ones_after_it() -> None:
    run = Run().feed(turning(2.0, 0.1))
    early = run.odometry[10]
    pose, covariance = early.pose.copy(), early.covariance.copy()
    run.feed([imu(time, 0.1 * time, 0.1) for time in times(2.04, 3.0)])
    np.testing.assert_array_equal(early.pose, pose)
    np.testing.assert_array_equal(early.covariance, covariance)


def test_errors_are_as_large_as_the_covariance_says() -> None:
    """NEES of (x, y, yaw) with the noise that the configuration describes; 3 is perfect."""
    nees = np.mean([_nees(seed) for seed in range(20)])
    assert 1.5 < nees < 4.5


def _nees(seed: int) -> float:
    rng = np.random.default_rng(seed)
    period, count = 0.2, 900
    surge = CONFIG.surge_speed + _gauss_markov(rng, CONFIG.surge_noise, 100.0, period, count)
    sway = _gauss_markov(rng, CONFIG.sway_noise, 100.0, period, count)
    bias = _gauss_markov(rng, CONFIG.compass_drift, 500.0, period, count)
    bias -= bias[0]
    time = period * np.arange(count)
    yaw, rate = 0.5 * np.sin(0.05 * time), 0.025 * np.cos(0.05 * time)
    compass = yaw + bias + CONFIG.compass_noise * rng.normal(size=count)
    gyro = rate + CONFIG.gyro_noise / np.sqrt(period) * rng.normal(size=count)
    gyro += CONFIG.gyro_bias * rng.normal()
    track = np.cumsum(period * (surge + 1j * sway) * np.exp(1j * yaw))
    run = Run().feed(
        imu(float(t), angle, w) for t, angle, w in zip(time, compass, gyro, strict=True)
    )
    end = track[-2]
    error = run.last.planar - [end.real, end.imag, yaw[-1]]
    return float(error @ np.linalg.solve(run.last.covariance[np.ix_([0, 1, 5], [0, 1, 5])], error))


def _gauss_markov(
    rng: np.random.Generator, deviation: float, time: float, period: float, count: int
) -> Array:
    decay = np.exp(-period / time)
    values = [deviation * rng.normal()]
    for shock in deviation * np.sqrt(1.0 - decay**2) * rng.normal(size=count - 1):
        values.append(decay * values[-1] + shock)
    return np.array(values)
