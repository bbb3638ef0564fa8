# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.messages.link_decoding import StampedPose
from msss_graphslam.nodes.predecessor import Predecessor

SECOND = 1_000_000_000


def begins(
    age: float, *, told: bool = True, ends: float | None = None, known: bool = True
) -> bool:
    """Whether it begins at that age [s], with a first measurement at 100 s."""
    now = [50.0]
    predecessor = Predecessor(lambda: told, lambda: now[0])
    if known:
        pose = [] if ends is None else [StampedPose(round(ends * SECOND), np.zeros(6))]
        predecessor.tell(pose)
    now[0] += age
    return predecessor.may_begin(100 * SECOND)


@pytest.mark.parametrize(("age", "begun"), [(0.9, False), (1.1, True)])
@pytest.mark.parametrize("ends", [None, 95.1, 101.0])
def test_a_way_that_ends_just_before_or_none_is_begun_with(
    age: float, begun: bool, ends: float | None
) -> None:
    assert begins(age, ends=ends) == begun


@pytest.mark.parametrize(("age", "begun"), [(5.9, False), (6.1, True)])
def test_a_way_that_ends_long_before_may_not_be_told_to_its_end(age: float, begun: bool) -> None:
    assert begins(age, ends=94.9) == begun


@pytest.mark.parametrize(
    ("told", "age", "begun"),
    [(True, 5.9, False), (True, 6.1, True), (False, 2.9, False), (False, 3.1, True)],
)
def test_what_nobody_tells_is_not_waited_for_for_ever(told: bool, age: float, begun: bool) -> None:
    assert begins(age, told=told, known=False) == begun


def test_the_way_as_it_is_told_last_counts() -> None:
    predecessor = Predecessor(lambda: True)
    for end in (5, 7):
        predecessor.tell([StampedPose(end, np.zeros(6))])
    assert [pose.stamp_ns for pose in predecessor.poses] == [7]
