# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The times in a recording: of arrival live, of the replay's clock at publishing in a replay."""

from collections.abc import Callable

import pytest

from msss_graphslam.nodes.recorded_time import RecordedTime

NOW = 500


class Written(list[tuple[int, int]]):
    """Log and publish times, in the order of writing."""

    def of(self, time: RecordedTime, *published: int) -> None:
        for published_ns in published:
            time.date(published_ns, self._write())

    def _write(self) -> Callable[[int, int], None]:
        return lambda log_ns, publish_ns: self.append((log_ns, publish_ns))


@pytest.fixture
def replayed() -> RecordedTime:
    return RecordedTime(lambda: NOW, is_replayed=True)


def test_live_it_is_the_time_of_arrival() -> None:
    time, written = RecordedTime(lambda: NOW, is_replayed=False), Written()
    written.of(time, 400, 0)
    assert written == [(NOW, 400), (NOW, NOW)]


def test_what_is_taken_late_keeps_its_place(replayed: RecordedTime) -> None:
    written = Written()
    for published_ns, clock_ns in ((100, 10_000), (110, 11_000), (120, 12_000)):
        replayed.tick(published_ns, clock_ns)
    written.of(replayed, 121, 112, 103, 101, 110)
    assert written == [(12_001, 121), (11_002, 112), (10_003, 103), (10_001, 101), (11_000, 110)]


@pytest.mark.parametrize("published_ns", [1099, 1100, 1101])
def test_time_does_not_pass_the_next_reading(replayed: RecordedTime, published_ns: int) -> None:
    """As it would where the replay is slower than real time, or waits."""
    written = Written()
    replayed.tick(1000, 10)
    replayed.tick(1100, 20)
    written.of(replayed, published_ns)
    assert written == [({1099: 19, 1100: 20, 1101: 21}[published_ns], published_ns)]
    replayed.tick(5000, 30)
    written.of(replayed, 4999, 90_000)
    assert [log_ns for log_ns, _ in written[1:]] == [29, 39]


def test_what_comes_before_the_clock_gets_its_first_reading(replayed: RecordedTime) -> None:
    written = Written()
    written.of(replayed, 100, 300)
    assert written == []
    replayed.tick(200, 7_000)
    assert written == [(7_000, 100), (7_000, 300)]
    replayed.tick(400, 8_000)
    assert len(written) == 2


def test_without_a_clock_nothing_is_lost(replayed: RecordedTime) -> None:
    written = Written()
    written.of(replayed, 100)
    replayed.finish()
    assert written == [(100, 100)]


def test_a_clock_that_goes_back_is_followed(replayed: RecordedTime) -> None:
    """As at the second lap of a replay in a loop."""
    written = Written()
    for published_ns, clock_ns in ((100, 900), (200, 1000), (300, 0), (400, 100)):
        replayed.tick(published_ns, clock_ns)
    written.of(replayed, 250, 350, 450)
    assert written == [(1000, 250), (50, 350), (150, 450)]


def test_a_middleware_that_tells_no_times_leaves_those_of_arrival(
    replayed: RecordedTime,
) -> None:
    written = Written()
    replayed.tick(0, 10_000)
    written.of(replayed, 0)
    assert written == [(NOW, NOW)]
