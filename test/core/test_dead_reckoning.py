# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0

import numpy as np
import pytest
from reckoned import (
    CONFIG,
    PERIOD,
    Run,
    beam,
    depth,
    heading,
    imu,
    nanoseconds,
    seconds_of,
    times,
    turning,
)

from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.types import (
    Array,
    BodyVelocity,
    Inertial,
)


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


@pytest.mark.parametrize("lag", [0.0, 0.01, 0.03])
def test_a_dvl_does_not_disturb_the_heading(lag: float) -> None:
    """Where the rate pulses five times a second, at the pace of the DVL."""
    moments = times(0.0, 20.0)
    rates = np.array([0.5 * (number % 5 in {2, 3}) for number in range(len(moments))])
    yaws = np.append(0.0, np.cumsum(0.5 * PERIOD * (rates[1:] + rates[:-1])))
    samples = [imu(*sample) for sample in zip(moments, yaws, rates, strict=True)]
    dvl = [
        BodyVelocity(nanoseconds(time + lag), np.array([0.1, 0.0, 0.0]), 1e-4 * np.eye(3))
        for time in times(0.08, 19.9, 0.2)
    ]
    alone, beside = Run().feed(samples), Run().feed([*dvl, *samples])
    assert beside.last.pose[5] == pytest.approx(alone.last.pose[5], abs=1e-4)
    assert beside.last.pose[5] == pytest.approx(wrap(yaws[-1]), abs=5e-3)


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


def test_a_changing_turn_rate_is_integrated_between_the_samples() -> None:
    samples = [
        Inertial(nanoseconds(time), None, np.array([0.0, 0.0, 0.02 * time]))
        for time in times(0.0, 10.0)
    ]
    assert Run().feed(samples).last.pose[5] == pytest.approx(1.0, abs=1e-9)


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


def test_without_any_sensor_of_motion_the_speed_is_a_guess() -> None:
    run = Run().feed([beam(time) for time in times(0.0, 20.0)])
    new = CONFIG.drift_noise**2 / 10.0
    slow = [CONFIG.surge_noise**2, CONFIG.sway_noise**2]
    np.testing.assert_allclose(np.diag(run.last.twist_covariance)[:2], np.add(slow, new))
    assert run.last.covariance[1, 1] > CONFIG.drift_noise**2 * 20.0


@pytest.mark.parametrize("at", [0.0, 0.5, 10.0])
def test_once_an_imu_was_heard_the_assumed_speed_holds(at: float) -> None:
    """From the start if it speaks during the alignment, and through its silence."""
    beams = [beam(time) for time in times(0.02, 20.0)]
    feed = sorted([*beams, imu(at)], key=lambda entry: entry.stamp_ns)
    run = Run().feed(feed)
    surge = run.last.twist_covariance[0, 0]
    assert surge == pytest.approx(CONFIG.surge_noise**2, rel=1e-3)
    drifted = CONFIG.drift_noise**2 * (at if at > CONFIG.alignment_time else 0.0)
    usual = (CONFIG.surge_noise * 20.0) ** 2
    assert run.last.covariance[0, 0] == pytest.approx(drifted + usual, abs=0.6 * usual)


def test_the_beams_clock_while_the_imu_is_silent() -> None:
    samples = [entry for entry in turning(30.0, 0.0) if not 10.0 < seconds_of(entry) < 20.0]
    run = Run().feed([*samples, *[beam(time) for time in times(0.02, 30.0)]])
    silent = [entry for entry in run.odometry if 10.0 < seconds_of(entry) < 20.0]
    first = seconds_of(silent[0]) - 10.0
    assert CONFIG.sensor_timeout < first < CONFIG.sensor_timeout + 2.0 * PERIOD
    np.testing.assert_allclose(np.diff([seconds_of(entry) for entry in silent]), PERIOD, atol=1e-6)
    assert run.last.pose[0] == pytest.approx(3.0, abs=1e-9)
    assert run.last.stamp_ns == nanoseconds(30.0)


def test_a_silent_gyro_is_not_believed_to_go_on_turning() -> None:
    run = Run().feed(turning(10.0, 0.1)).feed([beam(time) for time in times(10.02, 15.0)])
    assert run.last.twist[5] == 0.0
    assert run.last.pose[5] == pytest.approx(1.0, abs=0.01)
    assert run.last.twist_covariance[5, 5] == pytest.approx(CONFIG.turn_rate_noise**2 / 10.0)


@pytest.mark.parametrize(("silence", "trusted"), [(0.4, "gyro"), (5.0, "compass")])
def test_after_a_long_silence_the_compass_gives_the_heading(silence: float, trusted: str) -> None:
    """What the vehicle turned in the meantime nobody has measured."""
    turned = 0.03 if trusted == "gyro" else 0.3
    later = [imu(time, turned) for time in times(10.0 + silence, 12.0 + silence)]
    clock = [beam(time) for time in times(10.02, 10.0 + silence)]
    run = Run().feed(turning(10.0, 0.0)).feed(clock).feed(later)
    expected = 0.0 if trusted == "gyro" else turned
    assert run.last.pose[5] == pytest.approx(expected, abs=0.02)
    assert not run.refused


def test_a_drifting_compass_does_not_shake_the_heading_within_a_turn() -> None:
    steady = turning(20.0, 0.0)
    biased = [imu(time, 0.08) for time in times(20.04, 120.0)]
    run = Run().feed([*steady, *biased])
    yaws = np.array([entry.pose[5] for entry in run.odometry])
    after_a_turn = yaws[round(30.0 / PERIOD)]
    assert 0.0 < after_a_turn < 0.11 * 0.08
    assert yaws[-1] == pytest.approx(0.08 * (1.0 - np.exp(-1.0)), rel=0.05)


def launched(rng: np.random.Generator) -> Run:
    """A mission of which the compass' bias, 0 at launch, walks away from the yaw pi."""
    walk = CONFIG.compass_drift * np.sqrt(2.0 * PERIOD / CONFIG.compass_correlation_time)
    bias = np.append(0.0, np.cumsum(walk * rng.normal(size=25)))
    yaws = np.pi + bias + CONFIG.compass_noise * rng.normal(size=26)
    return Run().feed([imu(PERIOD * number, yaw) for number, yaw in enumerate(yaws)])


def test_alignment_knows_how_well_it_knows_the_heading() -> None:
    rng = np.random.default_rng(0)
    runs = [launched(rng) for _ in range(300)]
    errors = np.array([float(wrap(run.odometry[0].pose[5] - np.pi)) for run in runs])
    deviation = np.sqrt(runs[0].odometry[0].covariance[5, 5])
    assert np.std(errors) == pytest.approx(deviation, rel=0.15)
    assert np.mean(errors) == pytest.approx(0.0, abs=3.0 * deviation / np.sqrt(300.0))


def test_alignment_trusts_the_compass_the_less_the_longer_it_has_drifted() -> None:
    early, late = (
        Run().feed([imu(PERIOD * number, 0.1 * (number == odd)) for number in range(26)])
        for odd in (2, 24)
    )
    first, last = (run.odometry[0].pose[5] for run in (early, late))
    assert first > 0.1 / 26.0 > 0.1 / 100.0 > last > 0.0


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
