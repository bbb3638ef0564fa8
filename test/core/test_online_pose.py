# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from itertools import pairwise

import numpy as np
import pytest

from msss_graphslam.core.compounding import between, compose, wrap
from msss_graphslam.core.online_pose import OnlinePose, _drift_covariance
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.scans.scan_generation import motion_covariances
from msss_graphslam.core.types import Array, MapCorrection, Odometry, TwistError

PERIOD_NS = 40_000_000
MAP_POSE = np.array([5.0, -3.0, 3.0])
OFFSET = np.array([0.03, -0.01, 0.02])
STEADY = Persistence(1e9, np.zeros(3))
"""A twist error that stays."""


def odometry(number: int, planar: Array, twist: Array | None = None) -> Odometry:
    x, y, yaw = planar
    pose = np.array([x, y, -2.0, 0.02, -0.01, float(wrap(yaw))])
    speeds = np.zeros(6) if twist is None else twist
    return Odometry(number * PERIOD_NS, pose, np.eye(6), speeds, np.eye(6))


def course(count: int = 100) -> list[Odometry]:
    """A course on which the heading passes half a turn several times."""
    rng = np.random.default_rng(0)
    pose, entries = np.array([1.0, 2.0, 2.9]), []
    for number in range(count):
        entries.append(odometry(number, pose))
        pose = compose(pose, rng.normal([0.01, 0.0, 0.1], 0.02))
    return entries


def assert_same(pose: Array, planar: Array, tolerance: float = 1e-12) -> None:
    np.testing.assert_allclose(pose[:2], planar[:2], atol=tolerance)
    np.testing.assert_allclose(wrap(pose[5] - planar[2]), 0.0, atol=tolerance)


def test_is_dead_reckoning_before_any_correction() -> None:
    entries = course()
    online = OnlinePose(entries[0], STEADY)
    for entry in entries:
        pose = online.at(entry, entry.stamp_ns)
        assert_same(pose, entry.planar)
        assert -np.pi < pose[5] <= np.pi
        np.testing.assert_array_equal(pose[2:5], entry.pose[2:5])


def test_goes_on_from_the_correction_by_dead_reckoning() -> None:
    entries = course()
    online = OnlinePose(entries[0], STEADY)
    online.anchor(MAP_POSE, entries[10].planar, entries[10].stamp_ns, np.zeros(3))
    for entry in entries[10:]:
        expected = compose(MAP_POSE, between(entries[10].planar, entry.planar))
        assert_same(online.at(entry, entry.stamp_ns), expected)


def test_equals_the_composition_with_the_twist_error_taken_out() -> None:
    entries = course()
    online = OnlinePose(entries[0], STEADY)
    online.anchor(MAP_POSE, entries[0].planar, 0, OFFSET)
    expected = MAP_POSE
    for before, after in pairwise(entries):
        step = between(before.planar, after.planar)
        expected = compose(expected, compose(step, OFFSET * PERIOD_NS * 1e-9))
        assert_same(online.at(after, after.stamp_ns), expected)


def test_asking_twice_changes_nothing() -> None:
    entries = course(5)
    online = OnlinePose(entries[0], STEADY)
    online.anchor(MAP_POSE, entries[0].planar, 0, OFFSET)
    first = online.at(entries[4], entries[4].stamp_ns)
    np.testing.assert_array_equal(online.at(entries[4], entries[4].stamp_ns), first)


def test_an_anchor_at_its_own_pose_makes_no_step() -> None:
    entries = course(20)
    plain, anchored = OnlinePose(entries[0], STEADY), OnlinePose(entries[0], STEADY)
    for online in (plain, anchored):
        online.anchor(MAP_POSE, entries[0].planar, 0, OFFSET)
        for entry in entries[:10]:
            own = online.at(entry, entry.stamp_ns)
    anchored.anchor(own[[0, 1, 5]], entries[9].planar, entries[9].stamp_ns, OFFSET)
    for entry in entries[10:]:
        assert_same(anchored.at(entry, entry.stamp_ns), plain.at(entry, entry.stamp_ns)[[0, 1, 5]])


def test_looks_ahead_by_the_twist() -> None:
    twist = np.array([0.1, 0.02, 0.0, 0.0, 0.0, 0.05])
    entry = odometry(0, np.array([0.0, 0.0, 0.5 * np.pi]), twist)
    online = OnlinePose(entry, STEADY)
    online.anchor(entry.planar, entry.planar, 0, OFFSET)
    ahead = online.at(entry, 100_000_000)
    speed = twist[[0, 1, 5]] + OFFSET
    assert_same(ahead, compose(entry.planar, 0.1 * speed), 1e-9)


def test_looking_ahead_leaves_no_trace() -> None:
    entries = course(3)
    online = OnlinePose(entries[0], STEADY)
    online.at(entries[0], entries[2].stamp_ns)
    assert_same(online.at(entries[1], entries[1].stamp_ns), entries[1].planar)


def test_the_motion_is_continuous_between_corrections() -> None:
    """A subscriber sees no larger steps than dead reckoning makes, whenever it asks."""
    twist = np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.2])
    entries, pose = [], np.zeros(3)
    for number in range(50):
        entries.append(odometry(number, pose, twist))
        pose = compose(pose, np.array([0.004, 0.0, 0.008]))
    online = OnlinePose(entries[0], STEADY)
    online.anchor(MAP_POSE, entries[0].planar, 0, np.zeros(3))
    poses = np.array(
        [
            online.at(entry, entry.stamp_ns + delay)
            for entry in entries
            for delay in (0, 20_000_000)
        ]
    )
    steps = np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1)
    np.testing.assert_allclose(steps, 0.002, rtol=0.01)
    assert np.abs(wrap(np.diff(poses[:, 5]))).max() == pytest.approx(0.004, rel=0.01)


def test_the_odometry_is_not_changed() -> None:
    entry = course(1)[0]
    before = entry.pose.copy()
    online = OnlinePose(entry, STEADY)
    online.anchor(MAP_POSE, entry.planar, 0, OFFSET)
    online.at(entry, 10)
    np.testing.assert_array_equal(entry.pose, before)


SPREAD = np.array([[4e-3, 1e-3, 2e-4], [1e-3, 2e-3, -1e-4], [2e-4, -1e-4, 1e-4]])
TWIST_SPREAD = np.diag([0.02, 0.01, 0.004]) ** 2


def correction(stamp_ns: int, offset: Array = OFFSET) -> MapCorrection:
    return MapCorrection(stamp_ns, MAP_POSE, SPREAD, TwistError(offset, TWIST_SPREAD))


def followed(entries: list[Odometry]) -> OnlinePose:
    online = OnlinePose(entries[0], STEADY)
    for entry in entries:
        online.at(entry, entry.stamp_ns)
    return online


@pytest.mark.parametrize("late", [0, 1, 5, 60])
def test_a_correction_of_the_past_is_the_same_as_one_in_time(late: int) -> None:
    entries = course()
    in_time, too_late = followed(entries[:31]), followed(entries[: 31 + late])
    in_time.correct(correction(entries[30].stamp_ns))
    too_late.correct(correction(entries[30].stamp_ns))
    for entry in entries[31:]:
        expected = in_time.at(entry, entry.stamp_ns)
        if entry.stamp_ns >= entries[30 + late].stamp_ns:
            assert_same(too_late.at(entry, entry.stamp_ns), expected[[0, 1, 5]])


def test_a_correction_at_an_odometry_is_an_anchor() -> None:
    entries = course()
    online, anchored = followed(entries[:31]), OnlinePose(entries[0], STEADY)
    online.correct(correction(entries[30].stamp_ns))
    anchored.anchor(MAP_POSE, entries[30].planar, entries[30].stamp_ns, OFFSET)
    for entry in entries[30:]:
        expected = anchored.at(entry, entry.stamp_ns)
        assert_same(online.at(entry, entry.stamp_ns), expected[[0, 1, 5]])


def test_a_correction_between_two_odometries_takes_the_pose_between() -> None:
    entries = course()
    half = entries[30].stamp_ns + PERIOD_NS // 2
    online = followed(entries[:40])
    online.correct(correction(half, np.zeros(3)))
    middle = entries[30].planar + 0.5 * (entries[31].planar - entries[30].planar)
    for entry in entries[40:]:
        expected = compose(MAP_POSE, between(middle, entry.planar))
        found = online.at(entry, entry.stamp_ns)
        np.testing.assert_allclose(found[:2], expected[:2], atol=1e-9)


def test_the_newest_correction_counts() -> None:
    entries = course()
    online, once = followed(entries[:50]), followed(entries[:50])
    online.correct(correction(entries[10].stamp_ns, 3.0 * OFFSET))
    for one in (online, once):
        one.correct(correction(entries[40].stamp_ns))
    expected = once.at(entries[60], entries[60].stamp_ns)
    assert_same(online.at(entries[60], entries[60].stamp_ns), expected[[0, 1, 5]])


def test_what_is_remembered_is_caught_up_with_as_what_was_asked() -> None:
    entries = course()
    asked, remembered = followed(entries[:50]), followed(entries[:1])
    for entry in entries[:50]:
        remembered.remember(entry)
    for online in (asked, remembered):
        online.correct(correction(entries[20].stamp_ns))
    expected = asked.at(entries[49], entries[49].stamp_ns)
    np.testing.assert_array_equal(remembered.at(entries[49], entries[49].stamp_ns), expected)


def test_a_correction_may_come_before_anything_was_asked() -> None:
    """As after a restart: where dead reckoning is now, the map says it was then."""
    entries = course()
    online = OnlinePose(entries[0], STEADY)
    online.correct(correction(entries[0].stamp_ns, np.zeros(3)))
    expected = compose(MAP_POSE, between(entries[0].planar, entries[5].planar))
    assert_same(online.at(entries[5], entries[5].stamp_ns), expected)


def test_a_late_correction_still_finds_its_odometry_after_a_long_time() -> None:
    """A minute of a fast IMU; what is kept is bounded, but not as short as that."""
    entries = [odometry(number, np.array([0.004 * number, 0.0, 0.0])) for number in range(13_000)]
    online = followed(entries)
    online.correct(correction(entries[-3000].stamp_ns, np.zeros(3)))
    expected = compose(MAP_POSE, np.array([0.004 * 2999, 0.0, 0.0]))
    assert_same(online.at(entries[-1], entries[-1].stamp_ns), expected, 1e-9)


def driving(count: int = 100, rate: float = 0.0) -> list[Odometry]:
    pose, entries = np.array([1.0, 2.0, 0.3]), []
    for number in range(count):
        entries.append(odometry(number, pose))
        pose = compose(pose, np.array([0.01, 0.0, rate]))
    return entries


def test_the_covariance_is_dead_reckoning_s_before_any_correction() -> None:
    entry = course(1)[0]
    online = OnlinePose(entry, STEADY)
    np.testing.assert_array_equal(online.covariance(entry), entry.covariance)
    assert online.covariance(entry) is not entry.covariance


def planar(covariance: Array) -> Array:
    return covariance[np.ix_([0, 1, 5], [0, 1, 5])]


@pytest.mark.parametrize("rate", [0.0, 0.02])
def test_the_covariance_begins_with_the_correction_s_and_grows(rate: float) -> None:
    entries = driving(rate=rate)
    online = followed(entries[:11])
    online.correct(correction(entries[10].stamp_ns))
    np.testing.assert_allclose(planar(online.covariance(entries[10])), SPREAD, atol=1e-12)
    headings, spreads = [], []
    for entry in entries[10:]:
        online.at(entry, entry.stamp_ns)
        covariance = online.covariance(entry)
        np.testing.assert_allclose(covariance, covariance.T, atol=1e-15)
        assert np.linalg.eigvalsh(covariance)[0] > 0.0
        headings.append(covariance[5, 5])
        spreads.append(np.linalg.det(planar(covariance)))
    assert (np.diff(headings) > 0.0).all()
    assert (np.diff(spreads) > 0.0).all()


def test_the_covariance_is_that_of_samples() -> None:
    """An oracle: the pose and a twist error drawn at random and carried on."""
    entries = driving(rate=0.01)
    online = followed(entries[:1])
    online.correct(correction(0, np.zeros(3)))
    online.at(entries[-1], entries[-1].stamp_ns)
    rng, found = np.random.default_rng(0), []
    for _ in range(400):
        sample = OnlinePose(entries[0], STEADY)
        pose = rng.multivariate_normal(MAP_POSE, SPREAD)
        twist = rng.multivariate_normal(np.zeros(3), TWIST_SPREAD)
        sample.anchor(pose, entries[0].planar, 0, twist)
        for entry in entries[1:]:
            last = sample.at(entry, entry.stamp_ns)
        found.append([last[0], last[1], last[5]])
    spread = np.cov(np.array(found).T)
    ratios = np.linalg.eigvals(np.linalg.solve(planar(online.covariance(entries[-1])), spread))
    assert (ratios.real > 0.7).all()
    assert (ratios.real < 1.3).all()


def test_an_error_that_changes_takes_the_pose_farther() -> None:
    """An oracle: straight on at a speed whose error is a Gauss-Markov process, known at first."""
    lasting, seconds = 50.0, 40
    rng, decay = np.random.default_rng(1), np.exp(-1.0 / lasting)
    error, way = np.zeros(4000), np.zeros(4000)
    for noise in rng.normal(size=(seconds, 4000)):
        way += error
        error = decay * error + 0.03 * np.sqrt(1.0 - decay**2) * noise
    entries = [odometry(25 * second, np.array([0.1 * second, 0.0, 0.0])) for second in range(41)]
    online = OnlinePose(entries[0], Persistence(lasting, np.array([0.03**2, 0.0, 0.0])))
    known = TwistError(np.zeros(3), 1e-12 * np.eye(3))
    online.correct(MapCorrection(0, np.zeros(3), 1e-12 * np.eye(3), known))
    for entry in entries:
        online.at(entry, entry.stamp_ns)
    stated = online.covariance(entries[-1])
    assert stated[0, 0] == pytest.approx(np.var(way), rel=0.1)
    assert stated[1, 1] < 1e-6


def test_depth_and_tilt_keep_dead_reckoning_s_covariance() -> None:
    entries = driving()
    online = followed(entries)
    online.correct(correction(entries[50].stamp_ns))
    covariance = online.covariance(entries[-1])
    np.testing.assert_array_equal(covariance[2:5, 2:5], np.eye(3))
    assert not covariance[np.ix_([0, 1, 5], [2, 3, 4])].any()


@pytest.mark.parametrize("seed", range(10))
def test_drift_is_that_of_a_scan_whose_vehicle_moves_steadily(seed: int) -> None:
    rng = np.random.default_rng(seed)
    motion, elapsed, root = rng.normal(size=3), rng.uniform(0.1, 20.0), rng.normal(size=(3, 3))
    shares = np.linspace(0.0, 1.0, 9)
    wanted = motion_covariances(shares[:, None] * motion, shares * elapsed, root @ root.T)[-1]
    np.testing.assert_allclose(_drift_covariance(motion, elapsed, root @ root.T), wanted, 1e-10)
