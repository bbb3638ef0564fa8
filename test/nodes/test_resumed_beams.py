# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Kept beams and the sonar's own: each once, in order, none missing."""

from itertools import pairwise

import numpy as np
import pytest

from msss_graphslam.core.types import Beam
from msss_graphslam.nodes.resumed_beams import ResumedBeams


class Case:
    """The beams with what they are given to; stamps are small numbers."""

    def __init__(self, *, kept: bool = True, told: bool = True) -> None:
        self.now = 100.0
        self.taken: list[int] = []
        self.learned: list[int] = []
        self.kept, self.told = kept, told
        self.beams = ResumedBeams(
            lambda beam: self.taken.append(beam.stamp_ns),
            lambda beam: self.learned.append(beam.stamp_ns),
            lambda: self.kept,
            lambda: self.told,
            lambda: self.now,
        )

    def hear(self, *stamps: int) -> None:
        for stamp in stamps:
            self.beams.hear(beam(stamp))

    def recall(self, *stamps: int) -> None:
        for stamp in stamps:
            self.beams.recall(beam(stamp))

    def wait(self, seconds: float) -> None:
        self.now += seconds
        self.beams.look()


def beam(stamp_ns: int) -> Beam:
    return Beam(stamp_ns, 0.0, np.arange(2.0), np.zeros(2))


def test_kept_beams_are_learned_from_up_to_the_last_scan_and_taken_from_there_on() -> None:
    case = Case()
    case.recall(1, 2, 3, 4)
    assert not case.taken
    case.beams.begin_at(3)
    assert (case.learned, case.taken) == ([1, 2], [3, 4])
    case.recall(5)
    assert case.taken == [3, 4, 5]
    assert not case.beams.joined


def test_the_sonars_beams_wait_until_the_kept_ones_reach_them() -> None:
    case = Case()
    case.beams.begin_at(0)
    case.hear(7, 8)
    case.recall(4, 5, 6)
    assert case.taken == [4, 5, 6]
    case.recall(7)
    assert case.beams.joined
    case.recall(8, 9)
    case.hear(9, 10)
    assert case.taken == [4, 5, 6, 7, 8, 9, 10]


def test_what_was_kept_beyond_the_first_of_the_sonar_is_not_taken_twice() -> None:
    case = Case()
    case.hear(6)
    case.recall(5, 6, 7, 8)
    case.beams.begin_at(5)
    case.hear(7, 8, 9)
    assert case.taken == [5, 6, 7, 8, 9]


@pytest.mark.parametrize("order", range(24))
def test_each_beam_once_and_in_order_however_they_come(order: int) -> None:
    generator = np.random.default_rng(order)
    case = Case()
    kept, own = list(range(1, 30)), list(range(int(generator.integers(2, 29)), 40))
    begin = int(generator.integers(1, 29))
    while kept or own:
        which = generator.integers(3)
        if which == 0 and kept:
            case.recall(kept.pop(0))
        elif which == 1 and own:
            case.hear(own.pop(0))
        elif generator.random() < 0.1:
            case.beams.begin_at(begin)
    case.beams.begin_at(begin)
    case.wait(11.0)
    assert case.beams.joined
    assert all(later > earlier for earlier, later in pairwise(case.taken))
    assert case.learned + case.taken == list(range(1, 40))
    assert set(case.taken) >= set(range(begin, 40))


@pytest.mark.parametrize(("seconds", "begun"), [(2.9, False), (3.1, True)])
def test_without_a_front_end_it_begins_after_the_discovery(seconds: float, begun: bool) -> None:
    case = Case(told=False)
    case.recall(1, 2)
    case.wait(seconds)
    assert case.taken == ([1, 2] if begun else [])


@pytest.mark.parametrize(("seconds", "begun"), [(9.9, False), (10.1, True)])
def test_a_front_end_that_tells_nothing_is_not_waited_for_for_ever(
    seconds: float, begun: bool
) -> None:
    case = Case()
    case.recall(1, 2)
    case.wait(seconds)
    assert case.taken == ([1, 2] if begun else [])


@pytest.mark.parametrize(("kept", "seconds", "joined"), [
    (False, 2.9, False), (False, 3.1, True), (True, 9.9, False), (True, 10.1, True)
])  # fmt: skip
def test_kept_beams_that_never_come_are_not_waited_for_for_ever(
    kept: bool, seconds: float, joined: bool
) -> None:
    case = Case(kept=kept)
    case.beams.begin_at(5)
    case.hear(4, 5)
    case.wait(seconds)
    assert case.taken == ([4, 5] if joined else [])
    assert case.beams.joined == joined


def test_more_is_expected_at_first_and_until_they_are_joined() -> None:
    case = Case()
    assert case.beams.expects_more
    case.now += 6.1
    assert not case.beams.expects_more
    other = Case()
    other.beams.join()
    assert not other.beams.expects_more


def test_joined_by_force_it_takes_all_that_there_is() -> None:
    case = Case()
    case.recall(1, 2)
    case.hear(2, 3)
    case.beams.join()
    assert case.taken == [1, 2, 3]
    case.recall(4)
    case.beams.begin_at(9)
    case.hear(5)
    assert case.taken == [1, 2, 3, 5]
