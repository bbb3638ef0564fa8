# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.core.smoothing.normal_equations import NormalEquations
from msss_graphslam.core.types import Array


def add(equations: NormalEquations, nodes: list[int], information: Array, gradient: Array) -> None:
    equations.add(np.array([nodes]), information[None], gradient[None])


def chain(count: int) -> tuple[NormalEquations, Array, Array]:
    """Random measurements of neighbours and of a loop, and the same as dense matrices."""
    rng = np.random.default_rng(3)
    equations = NormalEquations(count)
    whole, gradient = np.zeros((3 * count, 3 * count)), np.zeros(3 * count)
    edges = [[number, number + 1] for number in range(count - 1)] + [[0, 1, 1, count - 1]]
    for nodes in edges:
        jacobian = rng.normal(size=(3 * len(nodes) + 2, 3 * len(nodes)))
        error = rng.normal(size=len(jacobian))
        add(equations, nodes, jacobian.T @ jacobian, jacobian.T @ error)
        select = np.zeros((3 * len(nodes), 3 * count))
        for place, node in enumerate(nodes):
            select[3 * place : 3 * place + 3, 3 * node : 3 * node + 3] = np.eye(3)
        whole += select.T @ jacobian.T @ jacobian @ select
        gradient += select.T @ jacobian.T @ error
    return equations, whole[3:, 3:], gradient[3:]


@pytest.mark.parametrize("count", [2, 3, 30])
def test_solution_is_that_of_the_dense_equations(count: int) -> None:
    equations, whole, gradient = chain(count)
    expected = -np.linalg.solve(whole, gradient).reshape(-1, 3)
    np.testing.assert_allclose(equations.solution(), expected, rtol=1e-7, atol=1e-9)


def test_several_right_hand_sides_are_solved_at_once() -> None:
    equations, whole, _ = chain(7)
    sides = np.random.default_rng(2).normal(size=(21, 2))
    found = equations.solved(sides)
    np.testing.assert_array_equal(found[:3], 0.0)
    np.testing.assert_allclose(whole @ found[3:], sides[3:], atol=1e-9)


@pytest.mark.parametrize("count", [2, 64, 65, 66, 130])
def test_covariances_are_the_blocks_of_the_inverse(count: int) -> None:
    equations, whole, _ = chain(count)
    inverse = np.linalg.inv(whole)
    found = equations.covariances()
    np.testing.assert_array_equal(found[0], 0.0)
    for number in range(1, count):
        place = slice(3 * number - 3, 3 * number)
        np.testing.assert_allclose(found[number], inverse[place, place], rtol=1e-6, atol=1e-10)


def test_last_poses_together() -> None:
    equations, whole, _ = chain(5)
    np.testing.assert_allclose(equations.covariance_of_last(2), np.linalg.inv(whole)[-6:, -6:])
    equations, whole, _ = chain(2)
    both = equations.covariance_of_last(2)
    np.testing.assert_allclose(both[3:, 3:], np.linalg.inv(whole))
    np.testing.assert_array_equal(both[:3], 0.0)


def test_a_measurement_that_comes_later_counts() -> None:
    equations, _, _ = chain(3)
    before = np.linalg.det(equations.covariances()[2])
    add(equations, [2], 100.0 * np.eye(3), np.zeros(3))
    assert np.linalg.det(equations.covariances()[2]) < 0.5 * before


def test_a_pose_that_nothing_holds_is_refused() -> None:
    equations = NormalEquations(3)
    add(equations, [0, 1], np.eye(6), np.zeros(6))
    with pytest.raises(RuntimeError):
        equations.solution()
    with pytest.raises(RuntimeError):
        equations.covariances()


def test_measurements_added_together_are_the_sum_of_each() -> None:
    together, apart = NormalEquations(4), NormalEquations(4)
    rng = np.random.default_rng(6)
    nodes = np.array([[0, 1], [1, 2], [2, 3], [1, 2]])
    jacobians, gradients = rng.normal(size=(4, 8, 6)), rng.normal(size=(4, 6))
    information = np.swapaxes(jacobians, 1, 2) @ jacobians
    together.add(nodes, information, gradients)
    for number in (3, 0, 2, 1):
        add(apart, list(nodes[number]), information[number], gradients[number])
    np.testing.assert_allclose(together.solution(), apart.solution())
    np.testing.assert_allclose(together.covariances(), apart.covariances())


def test_one_pose_is_certain() -> None:
    equations = NormalEquations(1)
    add(equations, [0], np.eye(3), np.ones(3))
    np.testing.assert_array_equal(equations.covariances(), np.zeros((1, 3, 3)))
