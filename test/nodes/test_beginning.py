# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import pytest

from msss_graphslam.nodes.beginning import Beginning


class Clock:
    now = 50.0

    def __call__(self) -> float:
        return self.now


@pytest.mark.parametrize(
    ("arrivals", "now", "whole", "more"),
    [
        ([], 2.9, True, True),
        ([], 3.1, True, False),
        ([2.5], 3.4, True, True),
        ([2.5], 3.6, True, False),
        ([2.5, 3.2], 4.1, True, True),
        ([14.5], 14.9, True, True),
        ([14.5], 15.1, True, False),
    ],
)
def test_more_is_expected_at_first_and_while_something_comes_but_not_for_ever(
    arrivals: list[float], now: float, whole: bool, more: bool
) -> None:
    clock = Clock()
    beginning = Beginning(clock)
    for arrival in arrivals:
        clock.now = 50.0 + arrival
        beginning.note()
    clock.now = 50.0 + now
    assert beginning.expects_more(whole=whole) == more


@pytest.mark.parametrize(("seconds", "more"), [(14.9, True), (15.1, False)])
def test_what_is_not_whole_is_waited_for_since_the_first_question(
    seconds: float, more: bool
) -> None:
    clock = Clock()
    beginning = Beginning(clock)
    clock.now = 1000.0
    assert not beginning.expects_more(whole=True)
    assert beginning.expects_more(whole=False)
    clock.now += seconds
    assert beginning.expects_more(whole=False) == more
    assert not beginning.expects_more(whole=True)
    assert beginning.expects_more(whole=False)
