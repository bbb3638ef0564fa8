# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Publishers, stamps and inputs watched, without ROS."""

import pytest

from msss_graphslam.messages.refusal import Refusal
from msss_graphslam.ros.input_watch import InputWatch
from msss_graphslam.ros.publisher_watch import PublisherWatch
from msss_graphslam.ros.stamp_watch import StampWatch

SECOND = 1_000_000_000


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def _refused(watch: PublisherWatch, number: int, now: float) -> bool:
    try:
        watch.check(number, now)
    except Refusal as refusal:
        assert refusal.reason == "second_publisher"
        return True
    return False


def test_the_first_publisher_is_followed() -> None:
    watch = PublisherWatch(lambda: 2)
    mixed = [500, 1, 501, 2, 502, 3]
    taken = [number for i, number in enumerate(mixed) if not _refused(watch, number, 0.1 * i)]
    assert taken == [500, 501, 502]


def test_one_publisher_may_start_again() -> None:
    watch = PublisherWatch(lambda: 1)
    assert [watch.check(number, 0.0) for number in (500, 1, 2)] == [0, 0, 0]


@pytest.mark.parametrize(
    ("number", "refused"), [(500, True), (501, False), (1500, False), (1501, True)]
)
def test_the_window_has_two_sides(number: int, refused: bool) -> None:
    watch = PublisherWatch(lambda: 2)
    watch.check(500, 0.0)
    assert _refused(watch, number, 0.1) is refused


@pytest.mark.parametrize(("silence", "refused"), [(1.9, True), (2.1, False)])
def test_after_a_silence_whoever_speaks_is_followed(silence: float, refused: bool) -> None:
    watch = PublisherWatch(lambda: 2)
    watch.check(5000, 10.0)
    assert _refused(watch, 1, 10.0 + silence) is refused
    if not refused:
        assert _refused(watch, 5001, 10.1 + silence) is True


@pytest.mark.parametrize("exclusive", [True, False])
def test_missing_numbers_are_counted(exclusive: bool) -> None:
    watch = PublisherWatch(lambda: 1, exclusive=exclusive)
    assert [watch.check(number, 0.0) for number in (7, 8, 11, 12)] == [0, 0, 2, 0]


def test_several_publishers_are_all_taken_where_they_may_be() -> None:
    watch = PublisherWatch(lambda: 2, exclusive=False)
    assert [watch.check(number, 0.0) for number in (500, 1, 501, 2, 3)] == [0] * 5


@pytest.mark.parametrize(("number", "lost"), [(200_007, 199_999), (200_008, 0)])
def test_what_an_outage_takes_of_the_only_publisher_is_counted(number: int, lost: int) -> None:
    watch = PublisherWatch(lambda: 1, exclusive=False)
    watch.check(7, 0.0)
    assert watch.check(number, 0.0) == lost


def test_a_new_publisher_has_lost_nothing() -> None:
    watch = PublisherWatch(lambda: 1)
    assert [watch.check(number, 0.0) for number in (7, 5000, 5002, 1, 2)] == [0, 0, 1, 0, 0]


def test_publishers_that_do_not_number_are_taken_as_they_come() -> None:
    watch = PublisherWatch(lambda: 2)
    assert not any(_refused(watch, 2**64 - 1, 0.0) for _ in range(3))
    assert not watch.numbered


def _check(watch: StampWatch, *seconds: float) -> None:
    for stamp in seconds:
        try:
            watch.check(int(stamp * SECOND))
        except Refusal:
            continue


def test_one_stamp_out_of_order_is_no_complaint() -> None:
    watch = StampWatch("imu/data")
    _check(watch, 10.0, 11.0, 10.5)
    assert watch.complaint == ""
    _check(watch, 10.6)
    assert watch.complaint == (
        "clock of imu/data went back by 0.400 s; refused until it has caught up (or call ~/reset)"
    )
    _check(watch, 11.5)
    assert watch.complaint == ""


def test_after_a_reset_any_stamp_is_in_order() -> None:
    watch = StampWatch("imu/data")
    _check(watch, 100.0, 3.0, 4.0)
    assert watch.complaint
    watch.reset()
    watch.check(3 * SECOND)
    assert watch.complaint == ""


def test_stamps_that_jump_ahead_again_and_again_are_a_complaint() -> None:
    watch = StampWatch("imu/data")
    _check(watch, 1.0, 1000.0, 5000.0)
    assert watch.complaint.startswith("clock of imu/data jumps ahead by 4999.000 s")


def test_rate_and_age_are_those_of_arrival() -> None:
    clock = Clock()
    watch = InputWatch("imu/data", clock)
    for _ in range(300):
        clock.now += 0.1
        watch.seen(SECOND)
    clock.now += 0.5
    rows = dict(watch.values)
    assert rows["rate/imu/data"] == pytest.approx(9.5, abs=0.11)
    assert rows["age/imu/data"] == pytest.approx(0.5)
    assert rows["received/imu/data"] == 300
    clock.now += 10.0
    assert watch.rate == 0.0


def test_without_input_the_age_is_none_and_the_silence_grows() -> None:
    clock = Clock()
    watch = InputWatch("imu/data", clock)
    clock.now += 3.0
    assert dict(watch.values)["age/imu/data"] == "none"
    assert watch.silence == 3.0


@pytest.mark.parametrize(
    ("period", "gap", "count"), [(0.1, 0.9, 0), (0.1, 1.1, 1), (1.0, 4.9, 0), (1.0, 5.1, 1)]
)
def test_a_gap_is_five_periods_and_a_second(period: float, gap: float, count: int) -> None:
    watch = InputWatch("imu/data", Clock())
    stamps = [round(i * period * SECOND) for i in range(20)]
    for stamp in [*stamps, stamps[-1] + round(gap * SECOND)]:
        watch.seen(stamp)
    assert watch.gaps == count


def test_messages_without_a_stamp_that_can_be_trusted_make_no_gaps() -> None:
    watch = InputWatch("imu/data", Clock())
    for stamp in (SECOND, 2 * SECOND, None, 3 * SECOND, 2 * SECOND):
        watch.seen(stamp)
    assert (watch.received, watch.gaps) == (5, 0)
