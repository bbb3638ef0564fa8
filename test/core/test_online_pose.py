# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from itertools import pairwise

import numpy as np
import pytest

from msss_graphslam.core.compounding import between, compose, wrap
from msss_graphslam.core.online_pose import OnlinePose
from msss_graphslam.core.types import Array, Odometry

PERIOD_NS = 40_000_000
MAP_POSE = np.array([5.0, -3.0, 3.0])
OFFSET = np.array([0.03, -0.01, 0.02])


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
    online = OnlinePose(entries[0])
    for entry in entries:
        pose = online.at(entry, entry.stamp_ns)
        assert_same(pose, entry.planar)
        assert -np.pi < pose[5] <= np.pi
        np.testing.assert_array_equal(pose[2:5], entry.pose[2:5])


def test_goes_on_from_the_correction_by_dead_reckoning() -> None:
    entries = course()
    online = OnlinePose(entries[0])
    online.anchor(MAP_POSE, entries[10].planar, entries[10].stamp_ns, np.zeros(3))
    for entry in entries[10:]:
        expected = compose(MAP_POSE, between(entries[10].planar, entry.planar))
        assert_same(online.at(entry, entry.stamp_ns), expected)


def test_equals_the_composition_with_the_twist_error_taken_out() -> None:
    entries = course()
    online = OnlinePose(entries[0])
    online.anchor(MAP_POSE, entries[0].planar, 0, OFFSET)
    expected = MAP_POSE
    for before, after in pairwise(entries):
        step = between(before.planar, after.planar)
        expected = compose(expected, compose(step, OFFSET * PERIOD_NS * 1e-9))
        assert_same(online.at(after, after.stamp_ns), expected)


def test_asking_twice_changes_nothing() -> None:
    entries = course(5)
    online = OnlinePose(entries[0])
    online.anchor(MAP_POSE, entries[0].planar, 0, OFFSET)
    first = online.at(entries[4], entries[4].stamp_ns)
    np.testing.assert_array_equal(online.at(entries[4], entries[4].stamp_ns), first)


def test_an_anchor_at_its_own_pose_makes_no_step() -> None:
    entries = course(20)
    plain, anchored = OnlinePose(entries[0]), OnlinePose(entries[0])
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
    online = OnlinePose(entry)
    online.anchor(entry.planar, entry.planar, 0, OFFSET)
    ahead = online.at(entry, 100_000_000)
    speed = twist[[0, 1, 5]] + OFFSET
    assert_same(ahead, compose(entry.planar, 0.1 * speed), 1e-9)


def test_looking_ahead_leaves_no_trace() -> None:
    entries = course(3)
    online = OnlinePose(entries[0])
    online.at(entries[0], entries[2].stamp_ns)
    assert_same(online.at(entries[1], entries[1].stamp_ns), entries[1].planar)


def test_the_motion_is_continuous_between_corrections() -> None:
    """A subscriber sees no larger steps than dead reckoning makes, whenever it asks."""
    twist = np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.2])
    entries, pose = [], np.zeros(3)
    for number in range(50):
        entries.append(odometry(number, pose, twist))
        pose = compose(pose, np.array([0.004, 0.0, 0.008]))
    online = OnlinePose(entries[0])
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
    online = OnlinePose(entry)
    online.anchor(MAP_POSE, entry.planar, 0, OFFSET)
    online.at(entry, 10)
    np.testing.assert_array_equal(entry.pose, before)
