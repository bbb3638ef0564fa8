# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Dead reckoning that goes on from an earlier pose, and one that forks."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
import pytest
from reckoned import CONFIG, beam, depth, imu, nanoseconds, times, turning
from same_odometry import said

from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.reckoning.dead_reckoning import DeadReckoning
from msss_graphslam.core.types import Inertial, Measurement, Odometry

POSE = np.array([5.0, -3.0, -1.5, 0.02, -0.01, 3.0])


def resumed(pose: np.ndarray = POSE) -> tuple[DeadReckoning, Counter[str]]:
    refused: Counter[str] = Counter()
    reckoning = DeadReckoning(CONFIG, refused)
    reckoning.resume(nanoseconds(0.0), pose)
    return reckoning, refused


def level(seconds: float, yaw: float) -> Inertial:
    return Inertial(nanoseconds(seconds), np.array([0.02, -0.01, yaw]), np.zeros(3))


def test_resumed_there_is_odometry_at_once() -> None:
    """No alignment: the attitude is known."""
    reckoning, _ = resumed()
    (first,) = reckoning.process(level(0.0, 3.0))
    np.testing.assert_allclose(first.pose, POSE, atol=1e-9)


@pytest.mark.parametrize("gap", [0.04, 2.0, 20.0])
def test_resumed_the_gap_is_bridged_at_the_assumed_speed(gap: float) -> None:
    reckoning, refused = resumed()
    (first,) = reckoning.process(level(gap, 3.0))
    way = gap * CONFIG.surge_speed * np.array([np.cos(3.0), np.sin(3.0)])
    np.testing.assert_allclose(first.pose[:2], POSE[:2] + way, rtol=1e-3)
    np.testing.assert_allclose(first.pose[5], 3.0, atol=1e-9)
    assert not refused


def test_resumed_the_uncertainty_grows_with_the_gap() -> None:
    spreads = []
    for gap in (0.04, 1.0, 5.0, 30.0):
        (first,) = resumed()[0].process(level(gap, 3.0))
        assert np.linalg.eigvalsh(first.covariance)[0] > -1e-15
        np.testing.assert_allclose(first.covariance, first.covariance.T, atol=1e-12)
        spreads.append(float(np.trace(first.covariance[:2, :2])))
    assert (np.diff(spreads) > 0.0).all()
    assert spreads[0] < 1e-3 < spreads[-1]


def test_resumed_the_uncertainty_goes_on_growing() -> None:
    reckoning, _ = resumed()
    found = [entry for at in times(0.0, 30.0) for entry in reckoning.process(level(at, 3.0))]
    spreads = [float(np.trace(entry.covariance[:2, :2])) for entry in found]
    assert (np.diff(spreads) >= 0.0).all()


def test_resumed_without_a_gap_it_is_near_the_one_that_never_stopped() -> None:
    whole = DeadReckoning(CONFIG, Counter())
    entries = [one for at in turning(20.0, 0.05) for one in whole.process(at)]
    stop = 300
    reckoning = DeadReckoning(CONFIG, Counter())
    reckoning.resume(entries[stop].stamp_ns, entries[stop].pose)
    rest = [one for at in turning(20.0, 0.05)[stop + 1 :] for one in reckoning.process(at)]
    assert [one.stamp_ns for one in rest] == [one.stamp_ns for one in entries[stop + 1 :]]
    away = rest[-1].pose - entries[-1].pose
    assert np.hypot(*away[:2]) < 0.02
    assert abs(wrap(away[5])) < 0.01


@pytest.mark.parametrize("turned", [0.03, -0.03])
@pytest.mark.parametrize("gap", [0.04, 10.0])
def test_resumed_the_compass_is_heard_at_once(gap: float, turned: float) -> None:
    """Not with the slow gain of a heading that the gyro has held."""
    reckoning, refused = resumed()
    (first,) = reckoning.process(level(gap, 3.0 + turned))
    share = wrap(first.pose[5] - 3.0) / turned
    assert 0.01 < share <= 1.0
    assert not refused


def test_resumed_what_lies_before_is_refused() -> None:
    reckoning, refused = resumed()
    assert reckoning.process(level(-0.01, 3.0)) == []
    assert refused == {"dead_reckoning_late": 1}


def test_resumed_beams_alone_are_enough() -> None:
    reckoning, _ = resumed()
    found = [one for at in times(0.0, 3.0) for one in reckoning.process(beam(at))]
    assert len(found) == len(times(0.0, 3.0))
    assert np.isfinite(found[-1].covariance).all()


def forked() -> tuple[DeadReckoning, DeadReckoning, Counter[str]]:
    """One that has run for a while, and its fork."""
    reckoning = DeadReckoning(CONFIG, Counter())
    for measurement in [*turning(10.0, 0.05), depth(10.0, 0.0)]:
        reckoning.process(measurement)
    refused: Counter[str] = Counter()
    return reckoning, reckoning.fork(refused), refused


def later(rate: float, start: float = 10.04) -> list[Inertial]:
    return [imu(at, 0.5 + rate * (at - 10.0), rate) for at in times(start, 15.0)]


def reckon(reckoning: DeadReckoning, entries: Sequence[Measurement]) -> list[Odometry]:
    return [one for at in entries for one in reckoning.process(at)]


def test_a_fork_says_the_same_of_the_same() -> None:
    reckoning, fork, _ = forked()
    assert said(reckon(reckoning, later(0.1))) == said(reckon(fork, later(0.1)))


@pytest.mark.parametrize("forked_first", [False, True])
def test_neither_knows_of_what_the_other_has_taken_in(forked_first: bool) -> None:
    reckoning, fork, _ = forked()
    alone = said(reckon(forked()[0], later(0.1)))
    one, other = (fork, reckoning) if forked_first else (reckoning, fork)
    reckon(one, later(-0.1))
    assert said(reckon(other, later(0.1))) == alone


@pytest.mark.parametrize("forked_first", [False, True])
def test_neither_knows_of_an_update_without_a_prediction(forked_first: bool) -> None:
    """A depth at the stamp of the fork changes the state where it stands."""
    reckoning, fork, refused = forked()
    alone = said(reckon(forked()[0], later(0.1)))
    one, other = (fork, reckoning) if forked_first else (reckoning, fork)
    one.process(depth(10.0, 0.01))
    assert not refused
    assert said(reckon(other, later(0.1))) == alone
    assert said(reckon(one, later(0.1))) != alone


def test_a_fork_counts_elsewhere() -> None:
    refused, elsewhere = Counter[str](), Counter[str]()
    reckoning = DeadReckoning(CONFIG, refused)
    reckon(reckoning, turning(3.0, 0.0))
    fork = reckoning.fork(elsewhere)
    fork.process(depth(3.0, 500.0))
    assert (refused, elsewhere) == ({}, {"depth_innovation": 1})
    reckoning.process(depth(3.0, 500.0))
    assert (refused, elsewhere) == ({"depth_innovation": 1},) * 2


def test_a_fork_has_a_patience_of_its_own() -> None:
    """What the fork refuses brings its original no nearer to a reset."""
    reckoning, fork, _ = forked()
    fork.process(depth(10.0, 500.0))
    counted: Counter[str] = Counter()
    reckoning.fork(counted).process(depth(10.0 + 2.0 * CONFIG.patience, 500.0))
    assert counted == {"depth_innovation": 1}


def test_a_fork_before_the_alignment_aligns_by_itself() -> None:
    reckoning = DeadReckoning(CONFIG, Counter())
    entries = turning(4.0, 0.0, start=0.3)
    half = round(0.5 * CONFIG.alignment_time / 0.04)
    reckon(reckoning, entries[:half])
    fork = reckoning.fork(Counter())
    others = reckon(fork, turning(4.0, 0.0, start=0.4)[half:])
    own = reckon(reckoning, entries[half:])
    whole = DeadReckoning(CONFIG, Counter())
    assert said(own) == said(reckon(whole, entries))
    assert others[0].pose[5] > own[0].pose[5] + 0.01
