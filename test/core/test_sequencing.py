# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections import Counter

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from msss_graphslam.core.sequencing import Sequencer
from msss_graphslam.core.types import Beam, Depth, Inertial, Measurement

WINDOW = 0.2
WINDOW_NS = 200_000_000


def depth(stamp_ns: int, z: float = 0.0) -> Depth:
    return Depth(stamp_ns, z)


def run(arrivals: list[Measurement]) -> tuple[list[Measurement], Counter[str]]:
    refused: Counter[str] = Counter()
    sequencer = Sequencer(WINDOW, refused)
    out = [ready for arrival in arrivals for ready in sequencer.push(arrival)]
    return out + sequencer.flush(), refused


@st.composite
def delayed(draw: st.DrawFn) -> tuple[list[Measurement], list[Measurement]]:
    """Measurements by stamp, and in an order of arrival in which none is too late."""
    stamps = draw(st.lists(st.integers(0, 3 * 10**9), max_size=40, unique=True))
    by_stamp: list[Measurement] = [
        Inertial(stamp, None, None) if stamp % 2 else depth(stamp) for stamp in sorted(stamps)
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


def test_kinds_with_the_same_stamp_come_in_one_order() -> None:
    empty = np.empty(0)
    entries: list[Measurement] = [Beam(5, 0.0, empty, empty), depth(5), Inertial(5, None, None)]
    for arrivals in (entries, entries[::-1], [entries[1], entries[2], entries[0]]):
        out, _ = run(arrivals)
        assert [type(entry) for entry in out] == [Beam, Depth, Inertial]


def test_the_same_stamp_and_kind_keep_the_order_of_arrival() -> None:
    arrivals: list[Measurement] = [depth(5, float(number)) for number in range(20)]
    assert run(arrivals)[0] == arrivals


def test_as_late_as_the_window_is_taken_and_later_is_counted() -> None:
    newest = 10**9
    for stamp, refusals in ((newest - WINDOW_NS, 0), (newest - WINDOW_NS - 1, 1)):
        out, refused = run([depth(newest), depth(stamp)])
        assert refused["later_than_reorder_window"] == refusals
        assert len(out) == 2 - refusals


def test_held_no_longer_than_the_window() -> None:
    sequencer = Sequencer(WINDOW, Counter())
    assert sequencer.push(depth(0)) == []
    assert sequencer.push(depth(WINDOW_NS - 1)) == []
    assert sequencer.push(depth(WINDOW_NS)) == [depth(0)]


def test_flush_returns_everything_once() -> None:
    sequencer = Sequencer(WINDOW, Counter())
    sequencer.push(depth(7))
    sequencer.push(depth(3))
    assert sequencer.flush() == [depth(3), depth(7)]
    assert sequencer.flush() == []


def test_a_window_of_nothing_passes_on_at_once() -> None:
    refused: Counter[str] = Counter()
    sequencer = Sequencer(0.0, refused)
    assert sequencer.push(depth(1)) == [depth(1)]
    assert sequencer.push(depth(1)) == [depth(1)]
    assert sequencer.push(depth(0)) == []
    assert refused == {"later_than_reorder_window": 1}
