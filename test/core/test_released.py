# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Keyframes that leave the smoother, and what becomes of those around them."""

import numpy as np
from noisy_graphs import START, assert_same_poses, edge, fed, loop, random_covariance

from msss_graphslam.core.compounding import between, compose, compose_covariance
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.graph.released import Released
from msss_graphslam.core.types import Array, Constraint

STEP = np.array([1.0, 0.1, 0.5])
VAGUE = np.diag([0.1, 0.1, 0.02]) ** 2
SURE = np.diag([0.01, 0.01, 0.002]) ** 2
LEAF = 7
LINEAR = 0.01
"""What moves less is not linearised again, and may be off by half of it."""


def hanging(number: int = LEAF) -> list[Constraint]:
    """The constraints of a keyframe that hangs on two of the chain, which say it differently."""
    return [
        loop(2, number, np.array([0.3, 0.1, 0.2]), VAGUE),
        loop(4, number, np.array([-1.2, -0.9, -0.7]), SURE),
    ]


def with_leaf() -> tuple[BackEnd, list[Constraint]]:
    leaf = hanging()
    back_end = without_leaf()
    back_end.update(leaf)
    return back_end, leaf


def without_leaf() -> BackEnd:
    return fed([[edge(k, k + 1, STEP, VAGUE)] for k in range(LEAF - 1)])


def assert_stands(poses: Array, other: Array, node: int) -> None:
    """Both have the node at the same place beside keyframe 4."""
    stands = [between(each[4], each[node])[None] for each in (poses, other)]
    assert_same_poses(*stands, 1e-9)


def test_what_leaves_keeps_its_place_and_leaves_no_trace_on_the_others() -> None:
    back_end, leaf = with_leaf()
    before = back_end.poses()
    poses = back_end.update([], leaf)
    assert_stands(poses, before, LEAF)
    assert_same_poses(poses[:LEAF], without_leaf().poses(), LINEAR)
    assert len(back_end.constraints) == LEAF - 1
    assert not {id(entry) for entry in leaf} & {id(entry) for entry in back_end.constraints}


def test_it_goes_with_the_surest_that_it_hung_on() -> None:
    back_end, leaf = with_leaf()
    poses = back_end.update([], leaf)
    moved = back_end.update([loop(0, 4, np.array([3.0, 3.0, 1.0]), SURE)])
    assert np.hypot(*(moved[4] - poses[4])[:2]) > 0.1
    assert_stands(moved, poses, LEAF)


def test_what_begins_at_one_that_has_left_begins_at_its_hold() -> None:
    back_end, leaf = with_leaf()
    back_end.update([], leaf)
    poses = back_end.update([edge(LEAF, LEAF + 1, STEP, SURE)])
    np.testing.assert_allclose(poses[-1], compose(poses[LEAF], STEP), atol=1e-6)
    hold = between(poses[4], poses[LEAF])
    relative = compose_covariance(hold, leaf[1].covariance, STEP, SURE)
    expected = compose_covariance(poses[4], back_end.covariance(4), compose(hold, STEP), relative)
    np.testing.assert_allclose(back_end.covariance(LEAF + 1), expected, rtol=1e-3, atol=1e-9)


def test_an_exchange_leaves_one_that_has_left_alone() -> None:
    back_end, leaf = with_leaf()
    poses = back_end.update([], leaf)
    again = back_end.exchange(leaf[:1], hanging()[:1])
    assert_same_poses(again, poses, LINEAR)
    assert_stands(again, poses, LEAF)
    assert len(back_end.constraints) == LEAF - 1


def test_a_smoother_made_anew_is_without_it() -> None:
    back_end, leaf = with_leaf()
    poses = back_end.update([], leaf)
    back_end._rebuild()
    assert_same_poses(back_end.poses(), poses, LINEAR)
    back_end.update([edge(LEAF, LEAF + 1, STEP, SURE)])
    assert len(back_end.poses()) == LEAF + 2


def test_many_leave_and_the_others_stay_in_order() -> None:
    rng = np.random.default_rng(0)
    back_end, at = without_leaf(), LEAF
    expected = list(back_end.poses())
    for number in range(at, at + 30):
        relative = rng.normal(0.0, 0.3, 3)
        first = int(rng.integers(LEAF))
        leaf = [loop(first, number, relative, random_covariance(rng))]
        back_end.update(leaf)
        expected.append(compose(expected[first], relative))
        if number % 3:
            back_end.update([], leaf)
    assert_same_poses(back_end.poses(), np.array(expected), 1e-6)
    assert len(back_end.constraints) == LEAF - 1 + 10


def test_nothing_is_held_at_first() -> None:
    released = Released()
    entry = edge(0, 1, STEP)
    assert 0 not in released
    assert released.from_inside(entry) is entry
    inside: Array = np.array([START])
    assert released.completed(inside) is inside


def test_a_chain_of_holds_ends_in_the_smoother() -> None:
    """The second hangs on the first, which is out already."""
    back_end, leaf = with_leaf()
    back_end.update([], leaf)
    second = [loop(LEAF, LEAF + 1, STEP, SURE)]
    back_end.update(second)
    poses = back_end.update([], second)
    np.testing.assert_allclose(poses[LEAF + 1], compose(poses[LEAF], STEP), atol=1e-6)
