# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from itertools import combinations

import numpy as np
import pytest
from scipy.sparse import csc_matrix

from msss_graphslam.core.smoothing.cliques import Clique, cliques, top_down

Edges = list[tuple[int, int]]

CHAIN = [(number, number + 1) for number in range(29)]
GRID = [(n, n + 1) for n in range(24) if n % 5 < 4] + [(n, n + 5) for n in range(20)]
CASES = pytest.mark.parametrize(
    ("count", "edges"),
    [
        (1, []),
        (4, []),
        (30, CHAIN),
        (30, [*CHAIN, (0, 29), (3, 20), (17, 25)]),
        (25, GRID),
        (30, [(0, number) for number in range(1, 30)]),
        (30, list(combinations(range(30), 2))),
        (30, CHAIN[:10] + CHAIN[14:]),
    ],
    ids=["one", "apart", "chain", "loops", "grid", "star", "all", "two_parts"],
)


def tree_of(count: int, edges: Edges) -> list[Clique]:
    pattern = np.eye(count)
    for first, second in edges:
        pattern[first, second] = pattern[second, first] = 1.0
    return cliques(csc_matrix(np.kron(pattern, np.ones((3, 3)))).tobsr((3, 3)))


@CASES
def test_every_pose_is_eliminated_once(count: int, edges: Edges) -> None:
    own = [pose for clique in tree_of(count, edges) for pose in clique.own]
    assert sorted(own) == list(range(count))


@CASES
def test_what_measured_together_is_in_one_clique(count: int, edges: Edges) -> None:
    together = [set(clique.poses.tolist()) for clique in tree_of(count, edges)]
    assert all(any({*edge} <= poses for poses in together) for edge in edges)


@CASES
def test_the_clique_above_has_all_that_is_shared(count: int, edges: Edges) -> None:
    tree = tree_of(count, edges)
    for number, clique in enumerate(tree):
        if clique.above is None:
            assert len(clique.shared) == 0
            continue
        assert clique.above < number
        assert number in tree[clique.above].below
        assert len(clique.shared) > 0
        assert set(clique.shared.tolist()) <= set(tree[clique.above].poses.tolist())
    assert sum(len(clique.below) + (clique.above is None) for clique in tree) == len(tree)


def test_poses_that_all_depend_on_each_other_are_one_clique() -> None:
    (whole,) = tree_of(6, list(combinations(range(6), 2)))
    assert sorted(whole.own) == list(range(6))


def test_the_ends_of_a_star_are_eliminated_before_its_middle() -> None:
    tree = tree_of(9, [(4, other) for other in range(9) if other != 4])
    assert 4 in tree[0].own
    assert all(clique.shared.tolist() == [4] for clique in tree[1:])


@CASES
def test_from_the_top_down_each_comes_once_after_the_one_above(count: int, edges: Edges) -> None:
    tree = tree_of(count, edges)
    order = top_down(tree)
    assert sorted(order) == list(range(len(tree)))
    for number, clique in enumerate(tree):
        if clique.above is not None:
            assert order.index(clique.above) < order.index(number)


def test_the_longest_branch_comes_last() -> None:
    """A comb: what hangs on the spine has been seen when the spine goes on."""
    nothing = np.empty(0, dtype=np.intp)
    tree = [
        Clique([0], nothing, None, [1, 2]),
        Clique([1], nothing, 0, [3]),
        Clique([2], nothing, 0),
        Clique([3], nothing, 1),
    ]
    assert top_down(tree) == [0, 2, 1, 3]
    tree = tree_of(25, GRID)

    def below(number: int) -> int:
        return 1 + sum(below(child) for child in tree[number].below)

    sizes = [[below(child) for child in clique.below] for clique in tree]
    assert any(len(set(few)) > 1 for few in sizes)
    assert all(few == sorted(few, reverse=True) for few in sizes)
