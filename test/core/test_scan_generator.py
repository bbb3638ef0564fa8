# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from small_mission import seconds_of, until

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.reckoning.dead_reckoning import DeadReckoning
from msss_graphslam.core.scans import scan_generator
from msss_graphslam.core.scans.scan_generator import EARLY_PARTS, PART, ScanGenerator, around
from msss_graphslam.core.types import Beam, Odometry, Reading, Scan

CONFIGURATION = Configuration()
DURATION = 35.0


def beams(end: float = DURATION) -> list[Beam]:
    return [entry for entry in until(end) if isinstance(entry, Beam)]


@cache
def odometry(end: float = DURATION) -> tuple[Odometry, ...]:
    reckoning = DeadReckoning(CONFIGURATION.dead_reckoning, Counter())
    return tuple(entry for one in until(end) for entry in reckoning.process(one))


def fed(
    entries: Iterable[Beam | Odometry], refused: Counter[str] | None = None
) -> tuple[list[Scan], ScanGenerator]:
    generator = ScanGenerator(CONFIGURATION, Counter() if refused is None else refused)
    scans = []
    for entry in entries:
        if isinstance(entry, Beam):
            scans += generator.add_beam(entry)
        else:
            scans += generator.add_odometry(entry)
    return scans, generator


def generated(
    entries: Iterable[Beam | Odometry], refused: Counter[str] | None = None
) -> list[Scan]:
    scans, generator = fed(entries, refused)
    return scans + generator.finish()


def by_stamp(
    some: Iterable[Beam | Odometry], lag_ns: int = 0, jitter_ns: int = 0, seed: int = 0
) -> list[Beam | Odometry]:
    """Beams and odometry by their stamps, the odometry later by ``lag_ns`` and at random."""
    rng, entries, arrivals = np.random.default_rng(seed), list(some), []
    latest = {Beam: 0, Odometry: 0}
    for entry in sorted(entries, key=lambda one: one.stamp_ns):
        lag = (isinstance(entry, Odometry) * lag_ns) + int(rng.integers(0, jitter_ns + 1))
        latest[type(entry)] = max(latest[type(entry)], entry.stamp_ns + lag)
        arrivals.append((latest[type(entry)], entry))
    return [entry for _, entry in sorted(arrivals, key=lambda row: row[0])]


def contents(scans: list[Scan]) -> list[tuple[bytes | int | bool, ...]]:
    """Every number of the scans, to be compared bit by bit."""
    return [
        (
            scan.beam_stamps_ns.tobytes(),
            scan.end_stamp_ns,
            scan.reckoned.tobytes(),
            scan.twist_covariance.tobytes(),
            scan.beam_index.tobytes(),
            scan.points.tobytes(),
            scan.covariances.tobytes(),
            scan.motion_covariances.tobytes(),
            scan.complete,
            scan.usable,
        )
        for scan in scans
    ]


@cache
def expected() -> tuple[Scan, ...]:
    return tuple(generated(by_stamp([*beams(), *odometry()])))


@pytest.mark.parametrize("seed", range(3))
def test_the_scans_do_not_depend_on_the_interleaving(seed: int) -> None:
    entries = by_stamp([*beams(), *odometry()], jitter_ns=4 * 10**9, seed=seed)
    assert contents(generated(entries)) == contents(list(expected()))


@pytest.mark.parametrize("lag_ns", [-20 * 10**9, -(10**8), 10**8, 20 * 10**9])
def test_the_scans_do_not_depend_on_which_comes_first(lag_ns: int) -> None:
    entries = by_stamp([*beams(), *odometry()], lag_ns=lag_ns)
    assert contents(generated(entries)) == contents(list(expected()))


def test_all_beams_first_or_all_odometry_first() -> None:
    assert contents(generated([*beams(), *odometry()])) == contents(list(expected()))
    assert contents(generated([*odometry(), *beams()])) == contents(list(expected()))


def stamps_of(scans: Iterable[Scan]) -> list[int]:
    return [int(stamp) for scan in scans for stamp in scan.beam_stamps_ns]


def test_every_beam_is_in_exactly_one_scan_in_order() -> None:
    assert [scan.complete for scan in expected()] == [True] * 4 + [False]
    assert stamps_of(expected()) == [beam.stamp_ns for beam in beams()]


def test_a_turn_ends_where_the_next_begins_by_the_same_dead_reckoning() -> None:
    for scan, following in zip(expected()[:-1], expected()[1:], strict=True):
        assert scan.end_stamp_ns == following.stamp_ns
        np.testing.assert_array_equal(scan.reckoned[-1], following.reckoned[0])


def test_a_scan_comes_with_the_odometry_that_covers_it() -> None:
    generator = ScanGenerator(CONFIGURATION, Counter())
    assert [scan for beam in beams() for scan in generator.add_beam(beam)] == []
    assert generator.waiting == 4
    end = expected()[0].end_stamp_ns
    before = [entry for entry in odometry() if entry.stamp_ns < end]
    assert [scan for entry in before for scan in generator.add_odometry(entry)] == []
    covering = odometry()[len(before)]
    (scan,) = generator.add_odometry(covering)
    assert scan.end_stamp_ns == end <= covering.stamp_ns
    assert generator.waiting == 3


@pytest.mark.parametrize(("short_ns", "scans"), [(0, 1), (1, 0)])
def test_covered_from_both_sides(short_ns: int, scans: int) -> None:
    end = expected()[0].end_stamp_ns
    entry = replace(odometry()[-1], stamp_ns=end - short_ns)
    found, _ = fed([*beams(), odometry()[0], entry])
    assert len(found) == scans


def with_gap() -> list[Beam]:
    return [beam for beam in beams() if not 12.0 < seconds_of(beam) < 17.0]


def test_a_dropped_turn_is_not_usable_and_keeps_its_beams() -> None:
    refused: Counter[str] = Counter()
    scans = generated(by_stamp([*with_gap(), *odometry()]), refused)
    assert stamps_of(scans) == [beam.stamp_ns for beam in with_gap()]
    dropped, last = (scan for scan in scans if not scan.usable)
    assert last is scans[-1]
    assert refused["turn_dropped_for_a_gap"] == 1
    assert refused["beams_in_dropped_turns"] == len(dropped.beam_stamps_ns)
    assert len(dropped.points) == 0
    assert not dropped.complete
    assert np.isfinite(dropped.reckoned).all()
    assert all(len(scan.points) for scan in scans if scan.usable)


@pytest.mark.parametrize("lag_ns", [-20 * 10**9, 20 * 10**9])
def test_dropped_turns_do_not_depend_on_the_interleaving_either(lag_ns: int) -> None:
    in_time = generated(by_stamp([*with_gap(), *odometry()]))
    assert contents(generated(by_stamp([*with_gap(), *odometry()], lag_ns))) == contents(in_time)


def test_a_beam_that_is_not_newer_is_counted_and_in_no_scan() -> None:
    refused: Counter[str] = Counter()
    twice = [beam for beam in beams() for _ in range(2)]
    assert contents(generated([*twice, *odometry()], refused)) == contents(list(expected()))
    assert refused == {"beam_not_newer": len(beams())}


def test_at_the_end_also_what_no_odometry_covers() -> None:
    early = [entry for entry in odometry() if seconds_of_odometry(entry) < 15.0]
    scans, generator = fed([*beams(), *early])
    assert len(scans) == 1
    rest = generator.finish()
    assert stamps_of([*scans, *rest]) == [beam.stamp_ns for beam in beams()]
    np.testing.assert_array_equal(rest[-1].reckoned[-1], early[-1].pose)
    assert generator.waiting == 0
    assert generator.finish() == []


def seconds_of_odometry(entry: Odometry) -> float:
    return (entry.stamp_ns - beams()[0].stamp_ns) * 1e-9


def test_without_odometry_there_are_no_scans() -> None:
    assert generated(beams()) == []


def test_without_beams_there_are_no_scans() -> None:
    assert generated(odometry()) == []
    assert generated([]) == []


def parts(entries: Iterable[Beam | Odometry]) -> tuple[list[Scan], list[Scan]]:
    """Return the parts of turns, asked for after every entry, and the scans."""
    generator, found, scans = ScanGenerator(CONFIGURATION, Counter()), [], []
    for entry in entries:
        is_beam = isinstance(entry, Beam)
        scans += generator.add_beam(entry) if is_beam else generator.add_odometry(entry)
        part = generator.part()
        if part is not None:
            found.append(part)
            assert generator.part() is None
    return found, scans + generator.finish()


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_part_is_the_beginning_of_its_turn_and_ends_at_its_third(way: float) -> None:
    heard = [replace(beam, bearing=way * beam.bearing) for beam in beams()]
    found, scans = parts(by_stamp([*heard, *odometry()]))
    bearings = {beam.stamp_ns: beam.bearing for beam in heard}
    turns = {scan.stamp_ns: scan for scan in scans}
    of_turns = {stamp_ns: [p for p in found if p.stamp_ns == stamp_ns] for stamp_ns in turns}
    # The last turn may be too short for any.
    expected = [[PART], list(EARLY_PARTS), [PART], [PART], [PART]]
    for (stamp_ns, its_parts), due in zip(of_turns.items(), expected, strict=True):
        assert len(its_parts) == len(due) or not turns[stamp_ns].complete
        for part, angle in zip(its_parts, due, strict=False):
            count = len(part.beam_stamps_ns)
            scan = turns[stamp_ns]
            np.testing.assert_array_equal(part.beam_stamps_ns, scan.beam_stamps_ns[:count])
            np.testing.assert_allclose(part.reckoned[:-1], scan.reckoned[:count], atol=1e-9)
            looked = np.unwrap([bearings[int(stamp)] for stamp in part.beam_stamps_ns])
            swept = np.abs(looked - looked[0])
            assert swept[-2] < angle
            assert swept[-1] >= angle - 1e-9
            assert not part.complete


@pytest.mark.parametrize("lacking", [0, 1])
def test_a_part_that_shows_nothing_is_followed_by_another(
    lacking: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def of_turn(number: int) -> list[Scan]:
        found, scans = parts(by_stamp([*beams(), *odometry()]))
        return [part for part in found if part.stamp_ns == scans[number].stamp_ns]

    (third,) = of_turn(2)
    monkeypatch.setattr(scan_generator, "TELLING", len(third.points) + lacking)
    swept = [len(part.beam_stamps_ns) for part in of_turn(2)]
    assert len(swept) == 1 + lacking
    assert swept[-1] == pytest.approx((1 + lacking) * len(third.beam_stamps_ns), abs=2)


def reading(number: int, bearing: float) -> Reading:
    return Reading(number, bearing, np.empty(0), np.empty(0), np.empty(0), 20.0)


def test_behind_a_part_comes_the_turn_before_where_the_part_has_not_looked() -> None:
    before = [reading(number, 0.1 * number) for number in range(62)]
    part = [reading(100 + number, 6.2 + 0.1 * number) for number in range(3)]
    together = around(part, before)
    assert [one.stamp_ns for one in together] == [100, 101, 102, *range(3, 62)]
    assert around(part, []) == part
    assert around([], before) == []


def test_behind_a_sweep_s_part_comes_the_sweep_back() -> None:
    before = [reading(number, 0.1 * number) for number in range(20)]
    part = [reading(100 + number, 1.9 - 0.1 * number) for number in range(3)]
    together = around(part, before)
    assert [one.stamp_ns for one in together] == [100, 101, 102, *range(16, -1, -1)]


def test_early_parts_show_the_first_wall_seen_again() -> None:
    assert EARLY_PARTS[0] == pytest.approx(np.radians(15.0))
    assert PART in EARLY_PARTS
    assert tuple(sorted(EARLY_PARTS)) == EARLY_PARTS


def test_after_a_dropped_turn_nothing_has_shown_the_speed_either() -> None:
    heard = [beam for beam in beams() if not 13.0 < seconds_of(beam) < 16.0]
    found, scans = parts(by_stamp([*heard, *odometry()]))
    counts = [sum(part.stamp_ns == scan.stamp_ns for part in found) for scan in scans]
    dropped = [scan.usable for scan in scans].index(False)
    assert counts[dropped + 1] == 1
    assert counts[dropped + 2] > 1


def test_parts_leave_the_scans_as_they_are() -> None:
    entries = by_stamp([*beams(), *odometry()])
    assert contents(parts(entries)[1]) == contents(generated(entries))


def test_a_part_waits_for_its_odometry_and_not_beyond_its_turn() -> None:
    scans = generated(by_stamp([*beams(), *odometry()]))
    third = len(scans[0].beam_stamps_ns) // 3 + 2
    generator = ScanGenerator(CONFIGURATION, Counter())
    for beam in beams()[:third]:
        generator.add_beam(beam)
    assert generator.part() is None
    covering = [entry for entry in odometry() if entry.stamp_ns <= beams()[third].stamp_ns]
    for entry in covering:
        generator.add_odometry(entry)
    assert generator.part() is not None
    late = ScanGenerator(CONFIGURATION, Counter())
    for beam in beams()[: len(scans[0].beam_stamps_ns) + 1]:
        late.add_beam(beam)
    for entry in odometry():
        late.add_odometry(entry)
    assert late.part() is None
