# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msss_graphslam.core.scans.history import DeadReckoningHistory
from msss_graphslam.core.types import Array, Odometry

stamp_lists = st.lists(st.integers(0, 1000), min_size=1, max_size=20, unique=True).map(sorted)


def odometry(stamp_ns: int, pose: Array | None = None) -> Odometry:
    values = np.full(6, 0.001 * stamp_ns) if pose is None else pose
    return Odometry(stamp_ns, values, np.eye(6), np.zeros(6), np.eye(6))


def history(*stamps: int) -> DeadReckoningHistory:
    kept = DeadReckoningHistory()
    for stamp in stamps:
        kept.append(odometry(stamp))
    return kept


def pose_at(kept: DeadReckoningHistory, stamp_ns: int) -> Array:
    return np.asarray(kept.poses_at(np.array([stamp_ns], dtype=np.int64))[0])


@given(stamp_lists, st.integers(-100, 1100))
def test_poses_are_interpolated_and_never_extrapolated(stamps: list[int], stamp: int) -> None:
    expected = 0.001 * np.clip(stamp, stamps[0], stamps[-1])
    np.testing.assert_allclose(pose_at(history(*stamps), stamp), expected, atol=1e-12)


def test_angles_go_the_short_way_round() -> None:
    kept = DeadReckoningHistory()
    kept.append(odometry(0, np.array([0.0, 0.0, 0.0, 0.1, -0.1, 3.0])))
    kept.append(odometry(10, np.array([1.0, 2.0, 3.0, -0.1, 0.1, -3.0])))
    middle = pose_at(kept, 5)
    np.testing.assert_allclose(middle[:5], [0.5, 1.0, 1.5, 0.0, 0.0], atol=1e-12)
    assert abs(middle[5]) == pytest.approx(np.pi)
    assert pose_at(kept, 2)[5] == pytest.approx(3.0 + 0.2 * (2.0 * np.pi - 6.0))


def test_stamps_of_an_epoch_keep_their_nanoseconds() -> None:
    start = 1_750_000_000_000_000_000
    kept = DeadReckoningHistory()
    kept.append(odometry(start, np.zeros(6)))
    kept.append(odometry(start + 1000, np.array([1.0, 0, 0, 0, 0, 0])))
    assert pose_at(kept, start + 1)[0] == pytest.approx(0.001, rel=1e-12)


def test_what_is_not_newer_is_left_out() -> None:
    kept = history(10, 20)
    for stamp in (20, 15):
        kept.append(odometry(stamp, np.full(6, 9.0)))
    assert kept.latest is not None
    assert kept.latest.stamp_ns == 20
    np.testing.assert_allclose(pose_at(kept, 20), 0.02)


def test_covers_up_to_the_newest() -> None:
    kept = history(10, 20)
    assert kept.covers(20)
    assert not kept.covers(21)
    assert not DeadReckoningHistory().covers(-100)


def test_at_is_the_last_not_after() -> None:
    kept = history(10, 20, 30)
    assert [kept.at(stamp).stamp_ns for stamp in (5, 10, 19, 20, 29, 99)] == [
        10, 10, 10, 20, 20, 30,
    ]  # fmt: skip


def test_an_empty_history_has_no_latest() -> None:
    assert DeadReckoningHistory().latest is None


@given(stamp_lists, st.integers(0, 1000), st.integers(0, 1000))
def test_forgetting_changes_nothing_from_there_on(
    stamps: list[int], forget: int, later: int
) -> None:
    whole, forgetful = history(*stamps), history(*stamps)
    forgetful.forget_before(forget)
    stamp = forget + later
    np.testing.assert_allclose(pose_at(forgetful, stamp), pose_at(whole, stamp), atol=1e-12)
    assert whole.at(stamp).stamp_ns == forgetful.at(stamp).stamp_ns


def test_forgetting_bounds_the_memory() -> None:
    kept = history(*range(100))
    kept.forget_before(90)
    assert kept.at(0).stamp_ns == 90


def stamps_since(kept: DeadReckoningHistory, stamp_ns: int) -> list[int]:
    return [entry.stamp_ns for entry in kept.since(stamp_ns)]


def test_since_is_what_is_newer() -> None:
    kept = history(10, 20, 30)
    assert stamps_since(kept, 9) == [10, 20, 30]
    assert stamps_since(kept, 10) == [20, 30]
    assert stamps_since(kept, 19) == [20, 30]
    assert stamps_since(kept, 30) == []
    assert stamps_since(DeadReckoningHistory(), 0) == []


@pytest.mark.parametrize(("count", "left"), [(1, [30]), (2, [20, 30]), (3, [10, 20, 30])])
def test_the_last_are_kept(count: int, left: list[int]) -> None:
    kept = history(10, 20, 30)
    kept.keep_last(count)
    assert stamps_since(kept, 0) == left
    assert len(kept) == count
    np.testing.assert_allclose(pose_at(kept, 30), 0.03)
    assert kept.latest is not None
    assert kept.latest.stamp_ns == 30


def test_more_than_there_is_may_be_kept() -> None:
    kept = history(10, 20)
    kept.keep_last(5)
    assert len(kept) == 2


def test_the_length_is_what_has_been_taken() -> None:
    assert len(DeadReckoningHistory()) == 0
    assert len(history(10, 20, 20, 15)) == 2
