# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.core.compounding import between, compose, compose_jacobians
from msss_graphslam.core.graph.odometry_chain import OdometryChain
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

NONE = np.zeros((3, 3))
NODES = 9


def edges(seed: int, far_off: bool = False) -> list[Constraint]:
    """A winding chain with covariances that are not diagonal; perhaps begun far from the rest."""
    rng = np.random.default_rng(seed)
    made = []
    for second in range(1, NODES):
        root = np.diag([0.1, 0.04, 0.02]) @ rng.normal(size=(3, 3))
        step = rng.normal([1.2, 0.1, 0.4], 0.3)
        if far_off and second == 1:
            step = np.array([900.0, -700.0, 2.0])
        spread = root @ root.T + 1e-6 * np.eye(3)
        made.append(Constraint(ConstraintKind.CONSECUTIVE, second - 1, second, step, spread))
    return made


def chain_of(made: list[Constraint]) -> OdometryChain:
    chain = OdometryChain()
    for edge in made:
        chain.append(edge)
    return chain


def compounded(made: list[Constraint], first: int, second: int) -> tuple[Array, Array]:
    """An oracle: the edges one after the other, as equations 5 to 7 have it."""
    pose, spread = np.zeros(3), np.zeros((3, 3))
    for edge in made[first:second]:
        by_first, by_second = compose_jacobians(pose, edge.relative_pose)
        spread = by_first @ spread @ by_first.T + by_second @ edge.covariance @ by_second.T
        pose = compose(pose, edge.relative_pose)
    return pose, spread


def assert_compounded(
    chain: OdometryChain, made: list[Constraint], first: int, second: int
) -> None:
    known = chain.displacement(first, second)
    assert known is not None
    pose, spread = compounded(made, first, second)
    np.testing.assert_allclose(between(pose, known[0]), 0.0, atol=1e-9)
    np.testing.assert_allclose(known[1], spread, rtol=1e-6, atol=1e-9)


def closure(first: int, second: int, relative: Array, spread: Array = NONE) -> Constraint:
    return Constraint(ConstraintKind.LOOP, first, second, relative, spread)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("first", "second"), [(0, 1), (0, 8), (3, 7), (7, 8)])
@pytest.mark.parametrize("far_off", [False, True])
def test_equals_compounding_edge_by_edge(
    seed: int, first: int, second: int, far_off: bool
) -> None:
    made = edges(seed, far_off)
    assert_compounded(chain_of(made), made, first, second)


def test_the_distance_counts_every_covariance_once() -> None:
    made = edges(4)
    pose, spread = compounded(made, 2, 6)
    rng = np.random.default_rng(5)
    off, own, slack = rng.normal(0.0, 0.3, 3), np.diag([0.1, 0.2, 0.1]), np.diag([0.3, 0.1, 0.2])
    distance = chain_of(made).squared_distance(closure(2, 6, pose + off, own), slack)
    expected = off @ np.linalg.inv(spread + own + slack) @ off
    assert distance == pytest.approx(expected, rel=1e-6)


def test_headings_are_compared_round_the_circle() -> None:
    made = edges(6)
    pose, _ = compounded(made, 0, 8)
    turned = pose + np.array([0.0, 0.0, 2.0 * np.pi])
    assert chain_of(made).squared_distance(closure(0, 8, turned), NONE) == pytest.approx(0.0)


def test_nothing_is_known_across_a_break() -> None:
    made = edges(7)
    chain = OdometryChain()
    for edge in [*made[:3], None, *made[4:]]:
        chain.append(edge)
    assert chain.displacement(2, 5) is None
    assert chain.squared_distance(closure(2, 5, np.full(3, 50.0)), np.eye(3)) == 0.0
    for first, second in ((0, 3), (4, 8)):
        assert_compounded(chain, made, first, second)


def test_a_chain_that_was_cut_goes_on_as_if_it_had_ended_there() -> None:
    made = edges(8)
    chain = chain_of(made[:6])
    chain.append(None)
    chain.cut(5)
    assert len(chain) == 5
    for edge in made[4:]:
        chain.append(edge)
    known, expected = chain.displacement(0, 8), chain_of(made).displacement(0, 8)
    assert known is not None
    assert expected is not None
    np.testing.assert_array_equal(known[0], expected[0])
    np.testing.assert_array_equal(known[1], expected[1])
