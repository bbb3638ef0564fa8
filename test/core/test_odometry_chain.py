# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from msss_graphslam.core.compounding import (
    between,
    between_jacobians,
    compose,
    compose_jacobians,
)
from msss_graphslam.core.graph.odometry_chain import LAG, OdometryChain
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


def closure(first: int, second: int, relative: Array, spread: Array = NONE) -> Constraint:
    return Constraint(ConstraintKind.LOOP, first, second, relative, spread)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("first", "second"), [(0, 1), (0, 8), (3, 7), (7, 8)])
@pytest.mark.parametrize("far_off", [False, True])
def test_equals_compounding_edge_by_edge(
    seed: int, first: int, second: int, far_off: bool
) -> None:
    made = edges(seed, far_off)
    known = chain_of(made[:second]).displacement(first)
    assert known is not None
    pose, spread = compounded(made, first, second)
    np.testing.assert_allclose(between(pose, known[0]), 0.0, atol=1e-9)
    np.testing.assert_allclose(known[1], spread, rtol=1e-6, atol=1e-9)


def test_a_deviation_counts_both_covariances_once() -> None:
    made = edges(4)
    pose, spread = compounded(made, 2, 8)
    off, own = np.random.default_rng(5).normal(0.0, 0.3, 3), np.diag([0.1, 0.2, 0.1])
    deviation = chain_of(made).deviation(closure(2, 8, pose + off, own))
    np.testing.assert_allclose(deviation[0], off, atol=1e-9)
    np.testing.assert_allclose(deviation[1], spread + own, rtol=1e-6, atol=1e-9)


def test_headings_are_compared_round_the_circle() -> None:
    made = edges(6)
    pose, _ = compounded(made, 0, 8)
    turned = pose + np.array([0.0, 0.0, 2.0 * np.pi])
    off, _ = chain_of(made).deviation(closure(0, 8, turned))
    np.testing.assert_allclose(off, 0.0, atol=1e-9)


def test_nothing_is_known_across_a_break() -> None:
    made = edges(7)
    chain = OdometryChain()
    for edge in [*made[:3], None, *made[4:]]:
        chain.append(edge)
    assert chain.displacement(2) is None
    assert not chain.reaches(closure(3, 8, np.zeros(3)))
    far = closure(2, 8, np.full(3, 50.0), np.eye(3))
    off, spread = chain.deviation(far)
    np.testing.assert_array_equal(off, 0.0)
    np.testing.assert_array_equal(spread, np.eye(3))
    known = chain.displacement(4)
    assert known is not None
    pose, spread = compounded(made, 4, 8)
    np.testing.assert_allclose(between(pose, known[0]), 0.0, atol=1e-9)
    np.testing.assert_allclose(known[1], spread, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("dropped", [None, edges(9)[6]])
def test_a_keyframe_that_was_dropped_leaves_nothing_behind(dropped: Constraint | None) -> None:
    made = edges(8)
    chain = chain_of(made[:6])
    chain.append(dropped)
    if dropped:
        chain.take_in(closure(5, 7, np.full(3, 0.3), 0.01 * np.eye(3)))
    chain.drop_newest()
    assert len(chain) == 7
    for edge in made[6:]:
        chain.append(edge)
    for first in (0, 6):
        known, expected = chain.displacement(first), chain_of(made).displacement(first)
        assert known is not None
        assert expected is not None
        np.testing.assert_array_equal(known[0], expected[0])
        np.testing.assert_array_equal(known[1], expected[1])


@pytest.mark.parametrize(
    ("span", "reached"), [(0, False), (1, True), (LAG, True), (LAG + 1, False)]
)
def test_what_is_near_belongs_to_the_way(span: int, reached: bool) -> None:
    made = edges(10)
    chain = chain_of(made)
    before = chain.displacement(0)
    edge = closure(NODES - 1 - span, NODES - 1, np.zeros(3), 0.01 * np.eye(3))
    assert chain.reaches(edge) == reached
    assert not chain.reaches(closure(0, NODES - 2, np.zeros(3)))
    chain.take_in(edge)
    after = chain.displacement(0)
    assert before is not None
    assert after is not None
    assert np.array_equal(before[1], after[1]) != reached


def smoothed(made: list[Constraint], near: list[Constraint]) -> tuple[Array, Array]:
    """An oracle: least squares over all keyframes at once; poses (n, 3), covariance (3 n, 3 n)."""
    poses = np.array([compounded(made, 0, node)[0] for node in range(len(made) + 1)])
    for _ in range(5):
        information, gradient = 1e9 * np.eye(poses.size), np.zeros(poses.size)
        information[3:, 3:] = 0.0
        for edge in [*made, *near]:
            by_first, by_second = between_jacobians(poses[edge.first], poses[edge.second])
            jacobian = np.zeros((3, poses.size))
            jacobian[:, 3 * edge.first : 3 * edge.first + 3] = by_first
            jacobian[:, 3 * edge.second : 3 * edge.second + 3] = by_second
            off = between(poses[edge.first], poses[edge.second]) - edge.relative_pose
            weighted = jacobian.T @ np.linalg.inv(edge.covariance)
            information += weighted @ jacobian
            gradient += weighted @ off
        poses -= np.linalg.solve(information, gradient).reshape(-1, 3)
    return poses, np.linalg.inv(information)


@pytest.mark.parametrize("seed", range(3))
def test_with_near_matches_it_equals_least_squares_over_everything(seed: int) -> None:
    """Exactly within the window, and to a few per cent for what has left it."""
    rng, count = np.random.default_rng(seed), 40
    spread = np.diag([0.05, 0.03, 0.01]) ** 2
    step = np.array([1.0, 0.1, 0.15])
    noise = rng.multivariate_normal(np.zeros(3), 0.1 * spread, (2, count))
    made = [
        Constraint(ConstraintKind.CONSECUTIVE, node, node + 1, step + noise[0, node], spread)
        for node in range(count - 1)
    ]
    leap = compounded([replace(edge, relative_pose=step) for edge in made], 0, 4)[0]
    near = [closure(node - 4, node, leap + noise[1, node], spread) for node in range(4, count)]
    chain = OdometryChain()
    for edge in made:
        chain.append(edge)
        for match in near:
            if match.second == edge.second:
                chain.take_in(replace(match, covariance=0.5 * spread), 0.5)
    poses, covariance = smoothed(made, near)
    for first in (0, 7, 20, count - 1 - LAG, count - 2):
        known = chain.displacement(first)
        assert known is not None
        np.testing.assert_allclose(known[0], between(poses[first], poses[-1]), atol=0.01)
        jacobian = np.hstack(between_jacobians(poses[first], poses[-1]))
        numbers = [*range(3 * first, 3 * first + 3), *range(3 * count - 3, 3 * count)]
        expected = jacobian @ covariance[np.ix_(numbers, numbers)] @ jacobian.T
        deviations = np.sqrt(np.diag(known[1]) / np.diag(expected))
        np.testing.assert_allclose(deviations, 1.0, atol=0.05)
    _, alone = compounded(made, 0, count - 1)
    whole = chain.displacement(0)
    assert whole is not None
    assert whole[1][0, 0] < 0.3 * alone[0, 0]
