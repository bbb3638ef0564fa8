# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a constraint weighs: wrong loop closures, and matches of one scan."""

import numpy as np
import pytest
from noisy_graphs import LEAST_SQUARES, NODES, START, assert_same_poses, edge, fed, loop, ring

from msss_graphslam.config.groups import BackEnd as Config
from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.graph.back_end import BackEnd


def wrong_loop(config: Config) -> float:
    """The farthest that one wrong loop closure moves a keyframe of a good graph [m]."""
    truth, steps = ring(8)
    good, spoilt = fed(steps, config), fed(steps, config)
    wrong = between(truth[1], truth[9]) + np.array([3.0, -2.0, 0.5])
    spoilt.update([loop(1, 9, wrong, np.diag([0.05, 0.05, 0.01]) ** 2)])
    return float(np.linalg.norm((spoilt.poses() - good.poses())[:, :2], axis=1).max())


def test_one_wrong_loop_does_little() -> None:
    assert wrong_loop(Config()) < 0.1
    assert wrong_loop(LEAST_SQUARES) > 0.5


def test_the_kernel_spares_the_odometry() -> None:
    """Only loop closures are doubted: two contradicting odometry edges meet in the middle."""
    apart = [edge(0, 1, np.array([x, 0.0, 0.0])) for x in (1.0, 3.0)]
    back_end = fed([apart], Config())
    distance = np.linalg.norm(back_end.poses()[1, :2] - START[:2])
    assert distance == pytest.approx(2.0, abs=1e-3)


def test_matches_of_one_scan_have_its_own_error_in_common() -> None:
    """Of the mean of three matches, the other scans' half of the variance is a third of it."""
    step, spread = np.array([1.0, 0.1, 0.2]), np.diag([1e-2, 2e-2, 1e-3])
    found = []
    for count in (1, 3):
        back_end = BackEnd(LEAST_SQUARES, divides=True)
        back_end.add_keyframe(START)
        back_end.update([])
        for number in range(3):
            back_end.update([edge(number, number + 1, np.zeros(3), 1e-9 * np.eye(3))])
        back_end.update([loop(number, 4, step, spread) for number in range(count)])
        found.append(back_end.covariance(4))
        assert_same_poses(back_end.poses()[4:], compose(START, step)[None], 1e-3)
    shrunk = 0.5 + 0.5 / 3.0
    np.testing.assert_allclose(shrunk * found[0], found[1], rtol=1e-3, atol=1e-7)


def test_odometry_keeps_its_own_weight_beside_matches() -> None:
    step, spread = np.array([1.0, 0.1, 0.2]), np.diag([1e-2, 2e-2, 1e-3])
    edges = [edge(0, 1, step, spread), loop(0, 1, step, spread)]
    found = []
    for new in (edges, edges[1:]):
        back_end = BackEnd(LEAST_SQUARES, divides=True)
        back_end.add_keyframe(START)
        back_end.update([])
        back_end.update(new)
        found.append(back_end.covariance(1))
    np.testing.assert_allclose(2.0 * found[0], found[1], rtol=1e-3, atol=1e-9)


def test_a_rebuilt_smoother_has_the_same_shares() -> None:
    _, steps = ring(3)
    back_end = BackEnd(LEAST_SQUARES, divides=True)
    back_end.add_keyframe(START)
    back_end.update([])
    for new in steps:
        back_end.update(new)
    before = back_end.poses(), back_end.covariance(NODES - 1)
    back_end._rebuild()
    back_end.update([])
    np.testing.assert_allclose(back_end.poses(), before[0], atol=5e-3)
    np.testing.assert_allclose(back_end.covariance(NODES - 1), before[1], rtol=0.1, atol=1e-6)
