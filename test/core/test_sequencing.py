# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msss_graphslam.core.reckoning.sequencing import Sequencer
from msss_graphslam.core.types import Beam, Depth, Inertial, Measurement

SECOND = 10**9
WINDOW, PATIENCE = 0.2, 5.0
WINDOW_NS, PATIENCE_NS = SECOND // 5, 5 * SECOND
PERIOD_NS = SECOND // 4
EMPTY = np.empty(0)


def depth(stamp_ns: int, z: float = 0.0) -> Depth:
    return Depth(stamp_ns, z)


def imu(stamp_ns: int) -> Inertial:
    return Inertial(stamp_ns, None, None)


def made(refused: Counter[str] | None = None) -> Sequencer:
    return Sequencer(WINDOW, PATIENCE, Counter() if refused is None else refused)


def fed(*arrivals: Measurement) -> tuple[Sequencer, list[Measurement]]:
    sequencer = made()
    return sequencer, [ready for arrival in arrivals for ready in sequencer.push(arrival)]


def run(arrivals: list[Measurement]) -> tuple[list[Measurement], Counter[str]]:
    refused: Counter[str] = Counter()
    sequencer = made(refused)
    out = [ready for arrival in arrivals for ready in sequencer.push(arrival)]
    return out + sequencer.flush(), refused


@st.composite
def delayed(draw: st.DrawFn) -> tuple[list[Measurement], list[Measurement]]:
    """Measurements by stamp, and in an order of arrival in which none is too late."""
    stamps = draw(st.lists(st.integers(0, 30 * SECOND), max_size=40, unique=True))
    by_stamp: list[Measurement] = [
        imu(stamp) if stamp % 2 else depth(stamp) for stamp in sorted(stamps)
    ]
    delays = draw(st.lists(st.integers(0, WINDOW_NS), min_size=40, max_size=40))
    arrival = {entry.stamp_ns: entry.stamp_ns + delays[k] for k, entry in enumerate(by_stamp)}
    return by_stamp, sorted(by_stamp, key=lambda entry: arrival[entry.stamp_ns])


@given(delayed())
@settings(max_examples=100)
def test_the_order_does_not_depend_on_the_arrival(
    case: tuple[list[Measurement], list[Measurement]],
) -> None:
    by_stamp, arrivals = case
    out, refused = run(arrivals)
    assert out == by_stamp
    assert not refused


def streams() -> list[list[Measurement]]:
    """Three sensors that speak for 20 s, the beams at the stamps of every other IMU sample."""
    stamps = range(0, 20 * SECOND, PERIOD_NS)
    beams: list[Measurement] = [Beam(at, 0.0, EMPTY, EMPTY) for at in stamps[::2]]
    return [beams, [depth(at + 7) for at in stamps], [imu(at) for at in stamps]]


@given(st.lists(st.integers(0, PATIENCE_NS - 2 * PERIOD_NS), min_size=3, max_size=3))
@settings(max_examples=50, deadline=None)
def test_sensors_may_lag_behind_one_another_by_almost_the_patience(lags: list[int]) -> None:
    """A lagging sensor's last word is older than its lag by one of its periods, half a second."""
    rows = [(one.stamp_ns + lag, one) for lag, s in zip(lags, streams(), strict=True) for one in s]
    out, refused = run([one for _, one in sorted(rows, key=lambda row: row[0])])
    every = [one for stream in streams() for one in stream]
    expected = sorted(every, key=lambda one: (one.stamp_ns, type(one).__name__))
    assert [(type(one), one.stamp_ns) for one in out] == [
        (type(one), one.stamp_ns) for one in expected
    ]
    assert not refused


def test_a_sensor_that_lags_by_more_than_the_patience_is_refused() -> None:
    """Otherwise the limit above would say nothing."""
    lag = PATIENCE_NS + PERIOD_NS
    rows = [(one.stamp_ns, one) for one in streams()[2]]
    rows += [(one.stamp_ns + lag, one) for one in streams()[1]]
    _, refused = run([one for _, one in sorted(rows, key=lambda row: row[0])])
    assert refused["later_than_reorder_window"] > 0


def test_kinds_with_the_same_stamp_come_in_one_order() -> None:
    entries: list[Measurement] = [Beam(5, 0.0, EMPTY, EMPTY), depth(5), imu(5)]
    for arrivals in (entries, entries[::-1], [entries[1], entries[2], entries[0]]):
        out, _ = run(arrivals)
        assert [type(entry) for entry in out] == [Beam, Depth, Inertial]


def test_the_same_stamp_and_kind_keep_the_order_of_arrival() -> None:
    arrivals: list[Measurement] = [depth(5, float(number)) for number in range(20)]
    assert run(arrivals)[0] == arrivals


def test_nothing_leaves_before_the_patience_has_passed() -> None:
    sequencer = made()
    assert sequencer.push(depth(0)) == []
    assert sequencer.push(depth(PATIENCE_NS - 1)) == []
    assert sequencer.push(depth(PATIENCE_NS)) == [depth(0)]
    assert sequencer.held() == [depth(PATIENCE_NS - 1), depth(PATIENCE_NS)]


def test_what_is_as_late_as_the_patience_at_first_finds_its_place() -> None:
    arrivals: list[Measurement] = [imu(PATIENCE_NS - 1), depth(0)]
    assert run(arrivals) == ([depth(0), imu(PATIENCE_NS - 1)], {})


@pytest.mark.parametrize(("beyond", "refusals"), [(0, 0), (1, 1)])
def test_as_late_as_the_window_is_taken_and_later_is_counted(beyond: int, refusals: int) -> None:
    newest = 10 * SECOND
    late = depth(newest - WINDOW_NS - beyond)
    out, refused = run([depth(0), depth(newest), late])
    assert refused["later_than_reorder_window"] == refusals
    assert out == ([depth(0), late, depth(newest)] if not refusals else [depth(0), depth(newest)])


def test_later_than_the_window_is_taken_where_it_still_fits() -> None:
    """The pressure sensor holds the order back, so the IMU may be out of order by more."""
    arrivals = [imu(0), depth(0), imu(4 * SECOND), depth(4 * SECOND), imu(6 * SECOND)]
    fits = imu(6 * SECOND - 5 * WINDOW_NS)
    sequencer, _ = fed(*arrivals)
    assert sequencer.admits(fits)
    out, refused = run([*arrivals, fits])
    assert out == [depth(0), imu(0), depth(4 * SECOND), imu(4 * SECOND), fits, imu(6 * SECOND)]
    assert not refused
    assert not sequencer.admits(imu(4 * SECOND - 1))
    assert sequencer.admits(imu(4 * SECOND))


def test_no_longer_held_than_the_window_where_all_speak() -> None:
    sequencer, out = fed(imu(0), depth(0), imu(6 * SECOND), depth(6 * SECOND))
    assert out == [depth(0), imu(0)]
    later = 6 * SECOND + WINDOW_NS
    assert sequencer.push(imu(later - 1)) == []
    assert sequencer.push(imu(later)) == [depth(6 * SECOND), imu(6 * SECOND)]


@pytest.mark.parametrize(("silence", "given_up"), [(PATIENCE_NS, False), (PATIENCE_NS + 1, True)])
def test_a_silent_sensor_is_waited_for_as_long_as_the_patience(
    silence: int, given_up: bool
) -> None:
    last = 8 * SECOND
    sequencer, _ = fed(imu(0), depth(0), imu(last), depth(last), imu(last + SECOND))
    waiting = imu(last + SECOND) in sequencer.push(imu(last + silence))
    assert waiting is given_up
    assert sequencer.admits(depth(last + SECOND - 1)) is not given_up


def test_a_sensor_that_was_given_up_is_heard_again() -> None:
    sequencer, _ = fed(imu(0), depth(0), imu(20 * SECOND), imu(21 * SECOND))
    again = depth(21 * SECOND)
    assert sequencer.push(again) == []
    assert sequencer.held() == [again, imu(21 * SECOND)]
    assert sequencer.push(imu(22 * SECOND)) == [again, imu(21 * SECOND)]


def test_held_is_in_order_and_stays_held() -> None:
    sequencer, _ = fed(imu(9), depth(3), imu(3), depth(7, 1.0), depth(7, 2.0))
    expected = [depth(3), imu(3), depth(7, 1.0), depth(7, 2.0), imu(9)]
    assert sequencer.held() == expected
    assert sequencer.held() == expected
    assert sequencer.flush() == expected
    assert sequencer.held() == []


def test_flush_returns_everything_once() -> None:
    sequencer, _ = fed(depth(7), depth(3))
    assert sequencer.flush() == [depth(3), depth(7)]
    assert sequencer.flush() == []


def test_after_a_flush_nothing_goes_back() -> None:
    sequencer, _ = fed(depth(7))
    sequencer.flush()
    assert not sequencer.admits(depth(6))
    assert sequencer.admits(depth(7))


def test_an_empty_one_admits_anything() -> None:
    sequencer = made()
    assert sequencer.admits(depth(-SECOND))
    assert sequencer.held() == sequencer.flush() == []


def test_without_window_and_patience_all_passes_at_once() -> None:
    refused: Counter[str] = Counter()
    sequencer = Sequencer(0.0, 0.0, refused)
    assert sequencer.push(depth(1)) == [depth(1)]
    assert sequencer.push(depth(1)) == [depth(1)]
    assert sequencer.push(depth(0)) == []
    assert refused == {"later_than_reorder_window": 1}
