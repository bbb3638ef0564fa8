# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When settled odometry goes out: by the sensors' time, and sooner where the wall's allows it."""

from collections import Counter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from msss_graphslam.core.types import Odometry
from msss_graphslam.messages import link_decoding
from msss_graphslam.nodes.settled_output import SettledOutput

MS = 1_000_000


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


class Sink:
    """A node whose outputs keep what is published."""

    def __init__(self) -> None:
        self.messages: list[Any] = []
        self.diagnostics = SimpleNamespace(refused=Counter())

    def offer(self, _topic: Any, _depth: int) -> Any:
        return SimpleNamespace(publish=self.messages.append)

    @property
    def sizes(self) -> list[int]:
        return [len(link_decoding.settled_odometry(one).entries) for one in self.messages]


def reckoned(stamp_ns: int, x: float = 0.0) -> Odometry:
    pose = np.array([x, 0.0, 0.0, 0.0, 0.0, 0.0])
    return Odometry(stamp_ns, pose, np.eye(6), np.zeros(6), np.eye(6))


def feed(output: SettledOutput, clock: Clock, pause: float, count: int) -> None:
    """One entry each 20 ms of the sensors, each ``pause`` s of the wall."""
    for number in range(count):
        stamp_ns = (number + 1) * 20 * MS
        output.add([reckoned(stamp_ns)])
        output.seen(stamp_ns)
        clock.now += pause


@pytest.mark.parametrize(("pause", "sizes"), [(0.0, [1, 5, 5]), (0.02, [1, 2, 2, 2, 2, 2])])
def test_a_fast_replay_gathers_more_in_a_message(pause: float, sizes: list[int]) -> None:
    sink, clock = Sink(), Clock()
    output = SettledOutput(sink, clock)  # type: ignore[arg-type]
    feed(output, clock, pause + 1e-9, 11)
    assert sink.sizes == sizes


def test_where_nothing_settles_a_tenth_of_a_second_is_told_of() -> None:
    sink, clock = Sink(), Clock()
    output = SettledOutput(sink, clock)  # type: ignore[arg-type]
    for number in range(11):
        output.seen(number * 20 * MS)
        clock.now += 0.05
    assert sink.sizes == [0, 0, 0]


def test_what_is_not_finite_is_left_out_and_counted() -> None:
    sink = Sink()
    output = SettledOutput(sink)  # type: ignore[arg-type]
    output.add([reckoned(1, np.nan), reckoned(2)])
    output.seen(2)
    assert sink.sizes == [1]
    assert sink.diagnostics.refused == Counter(not_finite_output=1)
