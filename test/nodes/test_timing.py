# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When slow work is done, and when nothing is on its way any more."""

import pytest

from msss_graphslam.nodes.timing import Leisure, Throttle


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_work_is_done_when_asked_for_and_not_too_often() -> None:
    clock, done = Clock(), []
    throttle = Throttle(2.0, clock)
    assert not throttle.run(lambda: done.append(1))
    throttle.ask()
    assert throttle.run(lambda: done.append(1))
    throttle.ask()
    clock.now += 1.99
    assert not throttle.run(lambda: done.append(1))
    clock.now += 0.02
    assert throttle.run(lambda: done.append(1))
    assert not throttle.run(lambda: done.append(1))
    assert len(done) == 2


def test_long_work_is_done_more_rarely() -> None:
    clock = Clock()
    throttle = Throttle(0.0, clock)

    def work() -> None:
        clock.now += 1.0

    throttle.ask()
    assert throttle.run(work)
    throttle.ask()
    clock.now += 8.9
    assert not throttle.run(work)
    clock.now += 0.8
    assert throttle.run(work)


def leisure_after_two_keyframes(clock: Clock) -> Leisure:
    """One came 8 s ago, the other just now."""
    leisure = Leisure(clock)
    leisure.end()
    clock.now += 8.0
    leisure.end()
    return leisure


@pytest.mark.parametrize(
    ("since", "lasts"), [(0.0, True), (3.9, True), (4.1, False), (15.9, False), (16.1, True)]
)
def test_there_is_leisure_after_a_keyframe_and_when_none_comes(since: float, lasts: bool) -> None:
    clock = Clock()
    leisure = leisure_after_two_keyframes(clock)
    clock.now += since
    assert leisure.lasts is lasts


def test_there_is_leisure_as_long_as_nothing_has_come() -> None:
    clock = Clock()
    leisure = Leisure(clock)
    clock.now += 1.0
    assert leisure.lasts


def test_the_newest_interval_counts() -> None:
    clock = Clock()
    leisure = leisure_after_two_keyframes(clock)
    clock.now += 2.0
    leisure.end()
    clock.now += 1.5
    assert not leisure.lasts
