# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msss_graphslam.config.groups import Scanning
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.scans.history import Turn, TurnDetector
from msss_graphslam.core.types import Array, Reading

PERIOD_NS = 50_000_000
NOTHING = np.empty(0)
GAP_NS = round(Scanning().gap * 1e9)
senses = pytest.mark.parametrize("sense", [1.0, -1.0])


def readings(bearings: Array) -> list[Reading]:
    return [
        Reading(number * PERIOD_NS, float(bearing), NOTHING, NOTHING, NOTHING, 20.0)
        for number, bearing in enumerate(wrap(bearings))
    ]


def shifted(entries: list[Reading], by_ns: int) -> list[Reading]:
    return [
        Reading(entry.stamp_ns + by_ns, entry.bearing, NOTHING, NOTHING, NOTHING, 20.0)
        for entry in entries
    ]


def turning(beams: int, a_turn: int, sense: float = 1.0, start: float = 0.0) -> Array:
    return start + sense * 2.0 * np.pi / a_turn * np.arange(beams)


def sweeping(beams: int, a_sweep: int, step: float) -> Array:
    """To and fro; the outermost bearing of every sweep is measured once."""
    phase = np.mod(np.arange(beams), 2 * a_sweep)
    return step * (a_sweep - np.abs(phase - a_sweep))


def detect(entries: list[Reading]) -> tuple[list[Turn], Turn | None, Counter[str]]:
    refused: Counter[str] = Counter()
    detector = TurnDetector(Scanning(), refused)
    turns = [turn for entry in entries if (turn := detector.add(entry)) is not None]
    return turns, detector.finish(), refused


def all_readings(turns: list[Turn], last: Turn | None) -> list[Reading]:
    parts = [*turns, last] if last is not None else turns
    return [entry for turn in parts for entry in turn.readings]


@senses
@pytest.mark.parametrize("a_turn", [240, 200, 60])
@given(st.floats(-np.pi, np.pi))
@settings(max_examples=10, deadline=None)
def test_every_turn_has_exactly_its_beams(a_turn: int, sense: float, start: float) -> None:
    turns, last, refused = detect(readings(turning(3 * a_turn + 7, a_turn, sense, start)))
    assert [len(turn.readings) for turn in turns] == [a_turn] * 3
    assert all(turn.complete for turn in turns)
    assert last is not None
    assert len(last.readings) == 7
    assert not refused


@senses
def test_a_turn_ends_where_the_next_begins(sense: float) -> None:
    turns, last, _ = detect(readings(turning(500, 240, sense)))
    assert turns[0].end_ns == turns[1].readings[0].stamp_ns
    assert last is not None
    assert turns[1].end_ns == last.readings[0].stamp_ns
    assert turns[0].swept == pytest.approx(2.0 * np.pi * 239 / 240)


@senses
def test_a_sector_is_cut_where_the_head_reverses(sense: float) -> None:
    entries = readings(sense * sweeping(300, 40, 0.03))
    turns, last, refused = detect(entries)
    assert [len(turn.readings) for turn in turns] == [41, *[40] * 6]
    assert all_readings(turns, last) == entries
    assert all(turn.complete for turn in turns)
    assert turns[0].swept == pytest.approx(40 * 0.03)
    assert not refused


def test_a_sector_across_astern_is_cut_the_same() -> None:
    turns, _, _ = detect(readings(np.pi - 0.6 + sweeping(300, 40, 0.03)))
    assert [len(turn.readings) for turn in turns] == [41, *[40] * 6]


def test_the_last_part_of_a_turn_is_not_complete() -> None:
    entries = readings(turning(100, 240))
    turns, last, _ = detect(entries)
    assert turns == []
    assert last is not None
    assert not last.complete
    assert last.readings == entries
    assert last.end_ns == entries[-1].stamp_ns
    assert last.swept == pytest.approx(2.0 * np.pi * 99 / 240)


def test_no_readings_no_turn() -> None:
    assert detect([])[1] is None


@pytest.mark.parametrize(("silence", "dropped"), [(GAP_NS, 0), (GAP_NS + 1, 1)])
def test_the_gap_from_both_sides(silence: int, dropped: int) -> None:
    bearings = turning(300, 240)
    entries = readings(bearings[:100])
    entries += shifted(readings(bearings[100:]), entries[-1].stamp_ns + silence)
    turns, last, refused = detect(entries)
    assert refused["turn_dropped_for_a_gap"] == dropped
    assert refused["beams_in_dropped_turns"] == 100 * dropped
    assert all_readings(turns, last) == entries
    assert [len(turn.readings) for turn in turns if not turn.usable] == [100] * dropped


@senses
@pytest.mark.parametrize(("jump", "dropped"), [(0.49, 0), (0.51, 1), (2.0, 1), (-0.51, 1)])
def test_the_bearing_jump_from_both_sides(jump: float, dropped: int, sense: float) -> None:
    bearings = turning(200, 240)
    bearings[100:] += jump - 2.0 * np.pi / 240
    entries = readings(sense * bearings)
    turns, last, refused = detect(entries)
    assert refused["turn_dropped_for_a_bearing_jump"] == dropped
    assert refused["beams_in_dropped_turns"] == 100 * dropped
    assert all_readings(turns, last) == entries
    assert [len(turn.readings) for turn in turns if not turn.usable] == [100] * dropped


def test_a_dropped_turn_ends_at_its_own_last_beam() -> None:
    """Not at the next one's first: nothing is known of the gap."""
    bearings = turning(300, 240)
    entries = readings(bearings[:100])
    entries += shifted(readings(bearings[100:]), entries[-1].stamp_ns + GAP_NS + 1)
    (dropped,), last, _ = detect(entries)
    assert dropped.end_ns == entries[99].stamp_ns
    assert not dropped.complete
    assert last is not None
    assert last.readings == entries[100:]


@pytest.mark.parametrize(("beams", "usable"), [(64, False), (65, True)])
def test_a_last_part_is_usable_from_the_part_turn_on(beams: int, usable: bool) -> None:
    """Beams of 2 / 63.5 rad: 63 steps are less than the 2 rad of the default, 64 are more."""
    part = Scanning().part_turn
    turns, last, refused = detect(readings(part / 63.5 * np.arange(beams)))
    assert turns == []
    assert last is not None
    assert last.usable is usable
    assert len(last.readings) == beams
    assert not refused


def test_repeated_bearings_do_not_end_a_turn() -> None:
    turns, _, refused = detect(readings(np.repeat(turning(500, 240), 2)))
    assert [len(turn.readings) for turn in turns] == [480, 480]
    assert not refused


@pytest.mark.parametrize(("later_ns", "refused_beams"), [(1, 0), (0, 1), (-1, 1)])
def test_a_beam_must_be_newer_than_the_last(later_ns: int, refused_beams: int) -> None:
    """Even where the head reverses, or a turn would last no time at all."""
    first, second = readings(np.array([0.0, 0.1]))
    (third,) = shifted(readings(np.array([0.05])), second.stamp_ns + later_ns)
    turns, last, refused = detect([first, second, third])
    assert refused["beam_not_newer"] == refused_beams
    assert len(turns) == 1 - refused_beams
    assert len(all_readings(turns, last)) == 3 - refused_beams


@given(st.sets(st.integers(1, 239), max_size=60), st.sampled_from([1.0, -1.0]))
@settings(max_examples=50, deadline=None)
def test_lost_beams_do_not_shift_the_turns(lost: set[int], sense: float) -> None:
    """With some beams of the second turn missing the third still begins at its own."""
    entries = readings(turning(721, 240, sense))
    kept = [entry for number, entry in enumerate(entries) if number - 240 not in lost]
    turns, last, refused = detect(kept)
    if "turn_dropped_for_a_bearing_jump" not in refused:
        assert [turn.end_ns // PERIOD_NS for turn in turns] == [240, 480, 720]
    assert all_readings(turns, last) == kept


@given(
    st.lists(st.tuples(st.floats(-np.pi, np.pi), st.integers(0, 3 * 10**9)), max_size=60),
)
@settings(max_examples=200, deadline=None)
def test_no_beam_is_lost_or_doubled(beams: list[tuple[float, int]]) -> None:
    """Whatever the head does: every beam is in one turn or counted, in order."""
    stamps = np.cumsum([delay for _, delay in beams], dtype=np.int64)
    entries = [
        Reading(int(stamp), bearing, NOTHING, NOTHING, NOTHING, 20.0)
        for stamp, (bearing, _) in zip(stamps, beams, strict=True)
    ]
    turns, last, refused = detect(entries)
    found = all_readings(turns, last)
    assert len(found) + refused["beam_not_newer"] == len(entries)
    for turn in turns:
        left = turn.end_ns - turn.readings[-1].stamp_ns
        assert left > 0 if turn.usable else left == 0
    dropped = sum(len(turn.readings) for turn in turns if not turn.usable)
    assert dropped == refused["beams_in_dropped_turns"]
    remaining = iter(entries)
    assert all(any(entry is other for other in remaining) for entry in found)
