# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from moving_scans import BASIN, BLIND, moving_scans

from msss_graphslam.core.smoothing.joint_pairs import first_reach, pairs_of, weights_of
from msss_graphslam.core.types import Constraint, ConstraintKind

ODOMETRY, CONSECUTIVE, LOOP = ConstraintKind


def edge(kind: ConstraintKind, first: int, second: int, refusal: str = "") -> Constraint:
    return Constraint(kind, first, second, np.zeros(3), np.eye(3), refusal)


def test_odometry_aligns_nothing() -> None:
    assert pairs_of([edge(ODOMETRY, 0, 1)], 4) == []


def test_consecutive_scans_are_aligned_even_if_refused() -> None:
    tried = [edge(CONSECUTIVE, 1, 2, "too_little_overlap"), edge(CONSECUTIVE, 0, 1)]
    assert pairs_of(tried, 0) == [(0, 1), (1, 2)]


@pytest.mark.parametrize(("enough", "taken"), [(2, False), (3, True)])
def test_a_refused_loop_counts_where_partners_are_few(enough: int, taken: bool) -> None:
    """Scan 5 has two accepted partners, scan 0 none."""
    tried = [edge(LOOP, 3, 5), edge(LOOP, 4, 5), edge(LOOP, 0, 5, "shape_differs")]
    assert ((0, 5) in pairs_of(tried, enough)) is taken


def test_every_pair_comes_once() -> None:
    assert pairs_of([edge(LOOP, 0, 5), edge(LOOP, 0, 5, "shape_differs")], 9) == [(0, 5)]


def test_reach_is_what_dead_reckoning_doubts_where_nothing_matched() -> None:
    scans, _ = moving_scans(BASIN, count=4)
    expected = 3.0 * 10.0 * np.sqrt(BLIND[0, 0])
    assert first_reach(scans, [], 0.5) == pytest.approx(expected, rel=0.05)
    refused = [edge(CONSECUTIVE, number, number + 1, "too_little_overlap") for number in range(3)]
    assert first_reach(scans, refused, 0.5) == pytest.approx(expected, rel=0.05)
    assert first_reach(scans, [], 50.0) == 50.0


def test_reach_is_narrow_where_most_matched() -> None:
    scans, _ = moving_scans(BASIN, count=4)
    matched = [edge(CONSECUTIVE, 0, 1), edge(CONSECUTIVE, 1, 2)]
    assert first_reach(scans, matched, 0.5) == 0.5
    assert first_reach(scans, matched[:1], 0.5) > 1.0


def test_reach_of_one_scan() -> None:
    assert first_reach(moving_scans(BASIN, count=1)[0], [], 0.5) == 0.5


def test_a_pair_counts_the_less_the_more_others_its_scans_have() -> None:
    alone = np.array([[0, 1]])
    np.testing.assert_allclose(weights_of(alone, 2), [1.0])
    triangle = np.array([[0, 1], [0, 2], [1, 2]])
    np.testing.assert_allclose(weights_of(triangle, 3), 2.0 / 3.0)
    star = np.array([[0, 1], [0, 2], [0, 3]])
    np.testing.assert_allclose(weights_of(star, 5), 2.0 / 3.0)
    assert weights_of(np.empty((0, 2), dtype=np.intp), 3).shape == (0,)
