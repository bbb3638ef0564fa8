# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that wait in their queues are taken along, once, and not without end."""

from collections import deque
from types import SimpleNamespace
from typing import Any

import pytest

from msss_graphslam.nodes.arrived import Gathering, take_arrived


class Waiting:
    """An input whose subscription holds messages; each is handed to ``take``."""

    raw = False
    msg_type = None

    def __init__(self, *messages: Any) -> None:
        self.waiting = deque(messages)
        self.taken: list[Any] = []
        self.subscription = self.handle = self
        self.take = self.taken.append

    def take_message(self, _kind: Any, _raw: bool) -> tuple[Any, Any] | None:
        return (self.waiting.popleft(), SimpleNamespace()) if self.waiting else None

    def callback(self, message: Any, _info: Any) -> None:
        self.take(message)


def gathering_of(*inputs: Any) -> Gathering:
    gathering = Gathering()
    gathering.inputs = inputs
    return gathering


def test_all_that_wait_are_taken_in_their_order() -> None:
    first, second = Waiting(1, 2, 3), Waiting(4)
    take_arrived([first, second])  # type: ignore[list-item]
    assert (first.taken, second.taken) == ([1, 2, 3], [4])


def test_not_more_are_taken_than_wanted() -> None:
    one = Waiting(1, 2, 3)
    take_arrived([one], 2)  # type: ignore[list-item]
    assert one.taken == [1, 2]


def test_gathering_does_not_begin_again_for_what_it_takes() -> None:
    one, begun = Waiting(1, 2, 3), []
    gathering = gathering_of(one)
    one.take = lambda message: (one.taken.append(message), begun.append(gathering.take()))
    assert gathering.take()
    assert one.taken == [1, 2, 3]
    assert begun == [False] * 3
    assert gathering.take()


def test_a_topic_that_never_ends_leaves_others_their_turn() -> None:
    endless = Waiting(*range(10_000))
    gathering_of(endless).take()
    assert 0 < len(endless.taken) < 1000


def test_gathering_goes_on_after_an_exception() -> None:
    one = Waiting(1, 2)
    gathering = gathering_of(one)

    def fail(_message: Any) -> None:
        raise RuntimeError("taken badly")

    one.take = fail
    with pytest.raises(RuntimeError, match="badly"):
        gathering.take()
    one.take = one.taken.append
    assert gathering.take()
    assert one.taken == [2]
