# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When a dead process comes back: both sides of every limit."""

from msss_graphslam.live.restarts import Restarts


def test_it_comes_back_after_half_a_second_and_once() -> None:
    restarts = Restarts()
    assert not restarts.take(0.0)
    assert restarts.died(10.0)
    assert not restarts.take(10.49)
    assert restarts.take(10.5)
    assert not restarts.take(20.0)
    assert restarts.count == 1


def test_the_sixth_death_within_a_minute_is_the_last() -> None:
    restarts = Restarts()
    assert [restarts.died(float(second)) for second in range(0, 60, 10)] == [True] * 5 + [
        False
    ] * 1


def test_after_a_minute_an_old_death_counts_no_more() -> None:
    restarts = Restarts()
    for second in range(5):
        assert restarts.died(float(second))
    assert not restarts.died(59.9)
    assert restarts.died(60.0)
    assert not restarts.died(60.9)
