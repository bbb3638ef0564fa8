# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The back end beside batch least squares, and how it takes keyframes."""

import numpy as np
import pytest
from noisy_graphs import (
    LEAST_SQUARES,
    NODES,
    START,
    assert_same_poses,
    edge,
    fed,
    loop,
    random_covariance,
    ring,
)
from scipy.optimize import least_squares

from msss_graphslam.config.groups import BackEnd as Config
from msss_graphslam.core.compounding import between, compose, compose_jacobians, wrap
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.types import Array, Constraint


def batch(constraints: list[Constraint], start: Array) -> tuple[Array, Array]:
    """An oracle: equation 4 by scipy; the poses (n, 3) and the last one's covariance.

    The smoother may differ by half its threshold of linearisation, 0.01.
    """
    roots = [np.linalg.cholesky(np.linalg.inv(c.covariance)).T for c in constraints]

    def residuals(flat: Array) -> Array:
        poses = np.vstack([START, flat.reshape(-1, 3)])
        parts = []
        for constraint, root in zip(constraints, roots, strict=True):
            error = between(poses[constraint.first], poses[constraint.second])
            error = error - constraint.relative_pose
            error[2] = wrap(error[2])
            parts.append(root @ error)
        return np.concatenate(parts)

    found = least_squares(residuals, start[1:].ravel(), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    covariance = np.linalg.inv(found.jac.T @ found.jac)
    return np.vstack([START, found.x.reshape(-1, 3)]), covariance[-3:, -3:]


@pytest.mark.parametrize("seed", range(4))
def test_equals_batch_least_squares(seed: int) -> None:
    truth, steps = ring(seed)
    back_end = fed(steps)
    expected, covariance = batch(back_end.constraints, truth)
    assert_same_poses(back_end.poses(), expected, 0.005)
    computed = back_end.covariance(NODES - 1)
    ratios = np.linalg.eigvals(np.linalg.solve(covariance, computed)).real
    np.testing.assert_allclose(ratios, 1.0, atol=0.1)


def test_the_covariance_is_in_the_axes_of_the_map() -> None:
    relative, covariance = np.array([2.0, -1.0, 0.8]), random_covariance(np.random.default_rng(0))
    back_end = fed([[edge(0, 1, relative, covariance)]])
    _, by_second = compose_jacobians(START, relative)
    expected = by_second @ covariance @ by_second.T
    np.testing.assert_allclose(back_end.covariance(1), expected, rtol=1e-6, atol=1e-9)


def test_covariances_are_compounded_along_a_chain() -> None:
    rng = np.random.default_rng(1)
    relatives = rng.normal([1.0, 0.0, 0.5], 0.2, (5, 3))
    covariances = [random_covariance(rng) for _ in range(5)]
    back_end = fed(
        [[edge(k, k + 1, relatives[k], covariances[k])] for k in range(5)],
    )
    pose, expected = START, np.zeros((3, 3))
    for relative, covariance in zip(relatives, covariances, strict=True):
        by_first, by_second = compose_jacobians(pose, relative)
        expected = by_first @ expected @ by_first.T + by_second @ covariance @ by_second.T
        pose = compose(pose, relative)
    np.testing.assert_allclose(back_end.poses()[-1], pose, atol=1e-9)
    np.testing.assert_allclose(back_end.covariance(5), expected, rtol=1e-5, atol=1e-9)


def test_the_first_keyframe_stays_where_it_was_launched() -> None:
    _, steps = ring(5)
    back_end = fed(steps)
    np.testing.assert_allclose(back_end.poses()[0], START, atol=1e-6)
    assert np.abs(back_end.covariance(0)).max() < 1e-9


def test_a_loop_makes_the_last_pose_surer() -> None:
    chain = [[edge(k, k + 1, np.array([1.0, 0.0, 0.5]))] for k in range(8)]
    back_end = fed(chain)
    before = np.linalg.eigvalsh(back_end.covariance(8))
    poses = back_end.poses()
    back_end.update([loop(0, 8, between(poses[0], poses[8]))])
    assert (np.linalg.eigvalsh(back_end.covariance(8)) < before).all()


def test_a_loop_that_closes_far_off_is_closed_at_once() -> None:
    """The robust kernel lets a closure pull harder the nearer the graph has come to it."""
    vague = np.diag([0.3, 0.3, 0.05]) ** 2
    chain = [[edge(k, k + 1, np.array([1.0, 0.0, 0.3]), vague)] for k in range(20)]
    back_end = fed(chain, Config(robust_width=1.0))
    seen = between(*back_end.poses()[[0, 20]]) + np.array([1.0, -0.5, 0.05])
    sure = np.diag([0.05, 0.05, 0.01]) ** 2
    poses = back_end.update([loop(0, 20, seen, sure)])
    np.testing.assert_allclose(between(*poses[[0, 20]]), seen, atol=0.02)
    assert_same_poses(back_end.update([]), poses, 0.005)


def test_without_keyframes_there_are_no_poses() -> None:
    assert BackEnd(LEAST_SQUARES).poses().shape == (0, 3)


def test_the_same_graph_gives_the_same_bits() -> None:
    _, steps = ring(6)
    np.testing.assert_array_equal(fed(steps).poses(), fed(steps).poses())


def test_a_keyframe_may_be_given_before_its_constraint() -> None:
    back_end = fed([])
    assert back_end.add_keyframe(np.array([2.1, -1.6, 0.4])) == 1
    poses = back_end.update([edge(0, 1, np.array([1.0, 0.0, 0.1]))])
    np.testing.assert_allclose(poses[1], compose(START, np.array([1.0, 0.0, 0.1])), atol=1e-6)


def test_one_update_may_bring_several_keyframes() -> None:
    chain = [edge(k, k + 1, np.array([1.0, 0.2, 0.3])) for k in range(6)]
    at_once = fed([chain])
    one_by_one = fed([[entry] for entry in chain])
    assert_same_poses(at_once.poses(), one_by_one.poses(), 1e-9)


def test_the_first_keyframe_taken_lies_where_it_says() -> None:
    back_end = BackEnd(LEAST_SQUARES)
    poses, covariance = back_end.take(START, [])
    np.testing.assert_allclose(poses, START[None], atol=1e-9)
    assert np.abs(covariance).max() < 1e-9


@pytest.mark.parametrize("seed", range(2))
def test_taking_keyframe_by_keyframe_is_updating(seed: int) -> None:
    _, steps = ring(seed)
    back_end, expected = BackEnd(LEAST_SQUARES), fed(steps)
    back_end.take(START, [])
    for new in steps:
        poses, covariance = back_end.take(np.full(3, 99.0), new)
    np.testing.assert_array_equal(poses, expected.poses())
    np.testing.assert_array_equal(covariance, expected.covariance(NODES - 1))


def test_only_the_first_keyframe_s_own_pose_counts() -> None:
    back_end = BackEnd(LEAST_SQUARES)
    back_end.take(START, [])
    relative = np.array([1.0, 0.0, 0.1])
    poses, _ = back_end.take(np.array([50.0, 50.0, 1.0]), [edge(0, 1, relative)])
    assert_same_poses(poses, np.vstack([START, compose(START, relative)]), 1e-9)
