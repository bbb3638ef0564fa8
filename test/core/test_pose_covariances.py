# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.sparse import csc_matrix

from msss_graphslam.core.smoothing.pose_covariances import pose_covariances
from msss_graphslam.core.types import Array


def information(count: int, edges: list[tuple[int, int]], own: float) -> Array:
    rng = np.random.default_rng(4)
    whole = own * np.eye(3 * count)
    for first, second in edges:
        jacobian = np.zeros((3, 3 * count))
        jacobian[:, 3 * first : 3 * first + 3] = rng.normal(size=(3, 3))
        jacobian[:, 3 * second : 3 * second + 3] = rng.normal(size=(3, 3))
        whole += jacobian.T @ jacobian
    return whole


def blocks(inverse: Array) -> Array:
    return np.array(
        [inverse[place : place + 3, place : place + 3] for place in range(0, len(inverse), 3)]
    )


CHAIN = [(number, number + 1) for number in range(39)]


@pytest.mark.parametrize(
    "edges",
    [
        CHAIN,
        [*CHAIN, (0, 39), (3, 20), (20, 35), (5, 31)],
        [(0, number) for number in range(1, 40)],
        [(first, second) for second in range(40) for first in range(second)],
        CHAIN[:15] + CHAIN[20:],
        [],
    ],
    ids=["chain", "loops", "star", "all", "two_parts", "apart"],
)
def test_they_are_the_blocks_of_the_inverse(edges: list[tuple[int, int]]) -> None:
    whole = information(40, edges, own=0.1)
    found = pose_covariances(csc_matrix(whole))
    np.testing.assert_allclose(found, blocks(np.linalg.inv(whole)), rtol=1e-7, atol=1e-10)


def test_entries_that_happen_to_be_zero_do_no_harm() -> None:
    rows = information(12, [], own=2.0)
    for number in range(0, 30, 3):
        for axis in range(3):
            rows[number + axis, number + 3 + axis] = rows[number + 3 + axis, number + axis] = -0.9
    found = pose_covariances(csc_matrix(rows))
    np.testing.assert_allclose(found, blocks(np.linalg.inv(rows)), atol=1e-12)


def test_a_pose_that_nothing_holds_is_refused() -> None:
    with pytest.raises(RuntimeError):
        pose_covariances(csc_matrix(information(5, [(0, 1), (1, 2)], own=0.0)))
