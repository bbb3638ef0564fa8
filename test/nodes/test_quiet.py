# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When a caller is told that all has come in."""

import pytest

from msss_graphslam.nodes.quiet import Quiet


class Clock:
    """A clock that goes as far as it is told."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.mark.parametrize(("silent", "reached"), [(0.09, False), (0.11, True)])
def test_a_pause_is_enough_at_the_first_question(silent: float, *, reached: bool) -> None:
    clock = Clock()
    quiet = Quiet(clock=clock)
    quiet.note()
    clock.now += silent
    assert quiet.lasting == pytest.approx(silent)
    assert quiet.is_reached() is reached


@pytest.mark.parametrize(("asking", "reached"), [(0.19, False), (0.21, True)])
def test_sensors_that_go_on_are_not_waited_for(asking: float, *, reached: bool) -> None:
    clock = Clock()
    quiet = Quiet(clock=clock)
    assert not quiet.is_reached()
    clock.now += asking
    quiet.note()
    assert quiet.is_reached() is reached


@pytest.mark.parametrize("pause", [1.0, 60.0])
def test_another_caller_is_put_off_anew(pause: float) -> None:
    clock = Clock()
    quiet = Quiet(clock=clock)
    assert not quiet.is_reached()
    clock.now += 0.3
    assert quiet.is_reached()
    clock.now += pause
    quiet.note()
    assert not quiet.is_reached()


def test_what_other_nodes_have_sent_is_waited_for_from_the_first_question_on() -> None:
    clock = Clock()
    quiet = Quiet.between_nodes(clock)
    clock.now += 60.0
    assert not quiet.is_reached()
    clock.now += 0.99
    assert not quiet.is_reached()
    clock.now += 0.02
    assert quiet.is_reached()


def test_what_comes_from_other_nodes_begins_the_wait_anew() -> None:
    clock = Clock()
    quiet = Quiet.between_nodes(clock)
    for _ in range(10):
        assert not quiet.is_reached()
        clock.now += 0.8
        quiet.note()
    clock.now += 1.01
    assert quiet.is_reached()


def test_another_caller_waits_again_for_other_nodes() -> None:
    clock = Clock()
    quiet = Quiet.between_nodes(clock)
    assert not quiet.is_reached()
    clock.now += 60.0
    assert not quiet.is_reached()
