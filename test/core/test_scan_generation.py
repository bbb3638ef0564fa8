# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from msss_graphslam.config.groups import Sonar
from msss_graphslam.core.compounding import between, compose, transform_points, wrap
from msss_graphslam.core.reckoning.attitude import rotation_matrix
from msss_graphslam.core.scans.history import DeadReckoningHistory, Turn
from msss_graphslam.core.scans.motion_feedback import offset_motion
from msss_graphslam.core.scans.scan_generation import (
    generate_scan,
    lay_out,
    motion_covariances,
    reckoned_motion,
)
from msss_graphslam.core.types import Array, Odometry, Reading, Scan

BEAMS = 200
PERIOD_NS = 50_000_000
START_NS = 1_700_000_000_000_000_000
SONAR = Sonar()
ROOM = np.array([8.0, 5.0])
TWIST_COVARIANCE = np.diag([0.03, 0.01, 0.02, 0.0, 0.0, 0.004]) ** 2
bearings = 2.0 * np.pi / BEAMS * np.arange(BEAMS)


def driven(speed: float = 0.2, rate: float = 0.05) -> Array:
    """Planar poses (b + 1, 3) on a circle through the room, up to the next turn's first beam."""
    time = PERIOD_NS * 1e-9 * np.arange(BEAMS + 1)
    yaw = 0.4 + rate * time
    position = -1.0 + 0.5j + speed / (1j * rate) * (np.exp(1j * yaw) - np.exp(0.4j))
    return np.column_stack([position.real, position.imag, yaw])


def history_of(planar: Array, roll: float = 0.0, pitch: float = 0.0) -> DeadReckoningHistory:
    history = DeadReckoningHistory()
    for number, (x, y, yaw) in enumerate(planar):
        pose = np.array([x, y, -2.0 - 0.001 * number, roll, pitch, float(wrap(yaw))])
        twist = np.zeros(6)
        stamp = START_NS + number * PERIOD_NS
        history.append(Odometry(stamp, pose, np.eye(6), twist, TWIST_COVARIANCE))
    return history


def reading(number: int, bearing: float, ranges: list[float]) -> Reading:
    return Reading(
        START_NS + number * PERIOD_NS,
        float(wrap(bearing)),
        np.array(ranges),
        np.full(len(ranges), 0.01),
        np.full(len(ranges), 40.0),
        20.0,
    )


def turn_of(ranges: list[list[float]]) -> Turn:
    readings = [reading(k, bearings[k], seen) for k, seen in enumerate(ranges)]
    return Turn(readings, START_NS + BEAMS * PERIOD_NS, 2.0 * np.pi, complete=True)


def to_walls(planar: Array, sonar: Sonar = SONAR) -> list[list[float]]:
    """The range to the walls of the room along every beam; nothing of the core's in it."""
    ranges = []
    for (x, y, yaw), bearing in zip(planar, bearings, strict=False):
        at = x + 1j * y + np.exp(1j * yaw) * (sonar.mount_x + 1j * sonar.mount_y)
        way = np.exp(1j * (yaw + sonar.mount_yaw + bearing))
        direction = np.array([way.real, way.imag])
        walls = np.sign(direction) * ROOM - [at.real, at.imag]
        ranges.append([float(np.min(walls / direction))])
    return ranges


def room_scan(sonar: Sonar = SONAR) -> Scan:
    planar = driven()
    return generate_scan(turn_of(to_walls(planar, sonar)), history_of(planar), sonar)


def off_the_walls(scan: Scan) -> Array:
    """The distance of every point from the walls [m]."""
    placed = np.abs(transform_points(scan.odometry, scan.points)) - ROOM
    return np.asarray(np.abs(placed.max(axis=1)))


@pytest.mark.parametrize(
    "sonar", [SONAR, replace(SONAR, mount_x=0.4, mount_y=-0.2, mount_yaw=0.7)]
)
def test_a_moving_vehicle_sees_the_room_undistorted(sonar: Sonar) -> None:
    scan = room_scan(sonar)
    assert len(scan.points) == BEAMS
    np.testing.assert_allclose(off_the_walls(scan), 0.0, atol=1e-9)


@pytest.mark.parametrize("name", ["mount_x", "mount_y", "mount_yaw"])
def test_a_wrong_mounting_shows(name: str) -> None:
    planar = driven()
    turn = turn_of(to_walls(planar, replace(SONAR, **{name: 0.3})))
    assert off_the_walls(generate_scan(turn, history_of(planar), SONAR)).max() > 0.2


def test_the_motion_is_that_of_the_odometry() -> None:
    planar = driven()
    scan = room_scan()
    np.testing.assert_allclose(scan.motion, between(planar[0], planar[:-1]), atol=1e-9)
    np.testing.assert_allclose(reckoned_motion(scan.reckoned)[:-1], scan.motion, atol=1e-15)
    np.testing.assert_allclose(scan.reckoned[:, [0, 1]], planar[:, :2], atol=1e-9)
    np.testing.assert_allclose(wrap(scan.reckoned[:, 5] - planar[:, 2]), 0.0, atol=1e-9)
    np.testing.assert_allclose(scan.motion[0], np.zeros(3), atol=1e-15)
    np.testing.assert_allclose(scan.odometry, planar[0], atol=1e-12)
    np.testing.assert_allclose(scan.heights, -2.0 - 0.001 * np.arange(BEAMS), atol=1e-12)
    assert (scan.stamp_ns, scan.end_stamp_ns) == (START_NS, START_NS + BEAMS * PERIOD_NS)
    np.testing.assert_allclose(scan.beam_times, 0.05 * np.arange(BEAMS + 1))


def test_a_turn_that_is_not_usable_has_poses_but_no_points() -> None:
    planar = driven()
    turn = turn_of(to_walls(planar))
    turn.usable, turn.complete = False, False
    scan, whole = generate_scan(turn, history_of(planar), SONAR), room_scan()
    assert not scan.usable
    assert not scan.complete
    assert len(scan.points) == len(scan.beam_index) == len(scan.covariances) == 0
    np.testing.assert_array_equal(scan.reckoned, whole.reckoned)
    np.testing.assert_array_equal(scan.motion, whole.motion)
    assert len(whole.points) == BEAMS


def test_the_nearest_candidate_is_taken_and_beams_without_one_still_move() -> None:
    planar = driven()
    ranges: list[list[float]] = [[] for _ in range(BEAMS)]
    ranges[3], ranges[150] = [2.0, 7.0], [4.0]
    scan = generate_scan(turn_of(ranges), history_of(planar), SONAR)
    np.testing.assert_array_equal(scan.beam_index, [3, 150])
    np.testing.assert_allclose(np.linalg.norm(scan.body_points, axis=1), [2.0, 4.0])
    assert scan.motion.shape == (BEAMS, 3)


def test_a_turn_without_any_echo_is_a_scan_without_points() -> None:
    scan = generate_scan(turn_of([[]] * BEAMS), history_of(driven()), SONAR)
    assert scan.points.shape == (0, 2)
    assert scan.covariances.shape == (0, 2, 2)
    assert scan.body_covariances.shape == (0, 2, 2)


def test_roll_and_pitch_are_levelled() -> None:
    roll, pitch = 0.1, -0.15
    scan = generate_scan(turn_of([[6.0]] * BEAMS), history_of(driven(), roll, pitch), SONAR)
    body = 6.0 * np.column_stack([np.cos(bearings), np.sin(bearings), np.zeros(BEAMS)])
    levelled = body @ np.array(rotation_matrix((roll, pitch, 0.0))).T
    np.testing.assert_allclose(scan.body_points, levelled[:, :2], atol=1e-12)


def test_polar_covariance_lies_along_and_across_the_beam() -> None:
    scan = generate_scan(turn_of([[6.0]] * BEAMS), history_of(driven()), SONAR)
    for number in (0, 37, 111):
        along = np.array([np.cos(bearings[number]), np.sin(bearings[number])])
        across = np.array([-along[1], along[0]])
        covariance = scan.body_covariances[number]
        assert along @ covariance @ along == pytest.approx(0.01)
        width = SONAR.beam_width * 6.0
        assert across @ covariance @ across == pytest.approx(width**2 / 12.0)
        assert along @ covariance @ across == pytest.approx(0.0, abs=1e-12)


def test_laying_out_with_the_same_motion_changes_nothing() -> None:
    scan = room_scan()
    again = lay_out(scan, scan.motion, scan.twist_covariance)
    for name in ("motion", "motion_covariances", "points", "covariances"):
        np.testing.assert_array_equal(getattr(again, name), getattr(scan, name))


def test_laying_out_does_not_depend_on_the_layout_before() -> None:
    scan = room_scan()
    bent = compose(scan.motion, np.array([0.1, 0.2, 0.3]))
    there_and_back = lay_out(lay_out(scan, bent, np.eye(3)), scan.motion, scan.twist_covariance)
    np.testing.assert_array_equal(there_and_back.points, scan.points)
    np.testing.assert_array_equal(there_and_back.covariances, scan.covariances)


def test_a_corrected_motion_takes_the_distortion_out() -> None:
    planar, wrong = driven(), driven(speed=0.14)
    scan = generate_scan(turn_of(to_walls(planar)), history_of(wrong), SONAR)
    assert off_the_walls(scan).max() > 0.2
    corrected = lay_out(scan, between(planar[0], planar[:-1]), scan.twist_covariance)
    np.testing.assert_allclose(off_the_walls(corrected), 0.0, atol=1e-9)


def test_motion_covariance_equals_a_monte_carlo() -> None:
    rng = np.random.default_rng(0)
    elapsed = 0.05 * np.arange(BEAMS)
    planar = driven()[:-1]
    motion = between(planar[0], planar)
    deviations = np.array([0.03, 0.01, 0.004])
    ends = np.array(
        [
            offset_motion(motion, elapsed, error)[-1]
            for error in deviations * rng.normal(size=(4000, 3))
        ]
    )
    computed = motion_covariances(motion, elapsed, np.diag(deviations**2))
    np.testing.assert_allclose(np.sqrt(np.diag(computed[-1])), np.std(ends, axis=0), rtol=0.05)
    correlation = computed[-1] / np.sqrt(np.outer(np.diag(computed[-1]), np.diag(computed[-1])))
    np.testing.assert_allclose(correlation, np.corrcoef(ends.T), atol=0.06)
    np.testing.assert_array_equal(computed[0], np.zeros((3, 3)))


def test_point_covariance_equals_a_monte_carlo() -> None:
    rng = np.random.default_rng(1)
    scan = room_scan()
    number, draws = 170, 4000
    motions = np.array(
        [
            offset_motion(scan.motion, scan.beam_times[:-1], error)[number]
            for error in rng.multivariate_normal(np.zeros(3), scan.twist_covariance, draws)
        ]
    )
    body = rng.multivariate_normal(scan.body_points[number], scan.body_covariances[number], draws)
    sampled = np.cov(transform_points(motions, body).T)
    np.testing.assert_allclose(scan.covariances[number], sampled, rtol=0.1, atol=2e-3)


def test_the_twist_error_is_that_of_the_first_beam() -> None:
    expected = np.diag([0.03, 0.01, 0.004]) ** 2
    np.testing.assert_allclose(room_scan().twist_covariance, expected)
