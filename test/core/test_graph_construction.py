# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from typing import Any

import numpy as np
from made_scans import standing_scan
from synthetic_scans import basin

from msss_graphslam.core.compounding import between, between_covariance
from msss_graphslam.core.graph.data_association import Candidate
from msss_graphslam.core.graph.graph_construction import (
    consecutive_constraint,
    loop_constraints,
    odometry_constraint,
)
from msss_graphslam.core.graph.keyframes import Node
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.types import Array, ConstraintKind, Scan

POSES = np.array([[0.0, 0.0, 0.0], [1.0, 0.2, 0.3], [2.0, -0.1, -0.4], [0.1, 0.1, 3.1]])
SPREAD = np.diag([0.1, 0.2, 0.03]) ** 2


class RecordingMatcher:
    """Notes what it is asked, and answers with the number of the question."""

    def __init__(self, refusal: str = "") -> None:
        self.asked: list[tuple[Any, Any, Array, Array]] = []
        self._refusal = refusal

    def prepare(self, scan: Scan) -> Scan:
        return scan

    def match(
        self,
        reference: Any,
        current: Any,
        initial: Array,
        spread: Array,
        start: Array | None = None,  # noqa: ARG002
    ) -> MatchResult:
        self.asked.append((reference, current, initial, spread))
        pose = np.full(3, float(len(self.asked)))
        return MatchResult(pose, 0.5 * np.eye(3), self._refusal, {"overlap": 0.8})


def nodes() -> list[Node]:
    rng = np.random.default_rng(0)
    walls = basin(rng)
    scans = [standing_scan(walls, pose, pose, k, rng) for k, pose in enumerate(POSES)]
    return [Node(scan, f"prepared {k}", scan, (k + 1) * SPREAD) for k, scan in enumerate(scans)]


def test_the_odometry_edge_joins_the_last_two() -> None:
    relative = np.array([1.0, 2.0, 3.0])
    edge = odometry_constraint(nodes(), relative, SPREAD)
    assert (edge.kind, edge.first, edge.second) == (ConstraintKind.ODOMETRY, 2, 3)
    assert edge.accepted
    np.testing.assert_array_equal(edge.relative_pose, relative)
    np.testing.assert_array_equal(edge.covariance, SPREAD)


def test_the_consecutive_edge_is_what_the_matcher_says() -> None:
    matcher, initial = RecordingMatcher("too_little_overlap"), np.array([0.1, 0.2, 0.3])
    edge = consecutive_constraint(nodes(), initial, SPREAD, matcher)
    ((reference, current, asked_initial, spread),) = matcher.asked
    assert (reference, current) == ("prepared 2", "prepared 3")
    np.testing.assert_array_equal(asked_initial, initial)
    np.testing.assert_array_equal(spread, SPREAD)
    assert (edge.kind, edge.first, edge.second) == (ConstraintKind.CONSECUTIVE, 2, 3)
    assert edge.refusal == "too_little_overlap"
    np.testing.assert_array_equal(edge.relative_pose, np.ones(3))
    assert edge.figures == {"overlap": 0.8}


def test_every_accepted_candidate_is_matched_from_its_place() -> None:
    known, matcher = nodes(), RecordingMatcher()
    edges = loop_constraints(
        known, POSES, [Candidate(0, 1.5, 0.2), Candidate(1, 2.5, 0.3)], matcher
    )
    assert [(edge.first, edge.second) for edge in edges] == [(0, 3), (1, 3)]
    assert all(edge.kind is ConstraintKind.LOOP and edge.accepted for edge in edges)
    for number, (reference, current, initial, spread) in enumerate(matcher.asked):
        assert (reference, current) == (f"prepared {number}", "prepared 3")
        np.testing.assert_allclose(initial, between(POSES[number], POSES[3]))
        expected = between_covariance(POSES[number], (number + 1) * SPREAD, POSES[3], 4.0 * SPREAD)
        np.testing.assert_allclose(spread, expected)
    assert edges[0].figures == {"mahalanobis": 1.5, "shape_distance": 0.2, "overlap": 0.8}


def test_a_figure_that_was_not_made_is_not_told() -> None:
    (edge,) = loop_constraints(nodes(), POSES, [Candidate(1, 2.5)], RecordingMatcher())
    assert edge.figures == {"mahalanobis": 2.5, "overlap": 0.8}


def test_a_refused_candidate_is_kept_and_not_matched() -> None:
    matcher = RecordingMatcher()
    (edge,) = loop_constraints(nodes(), POSES, [Candidate(1, 2.0, 0.9, "shape_differs")], matcher)
    assert edge.refusal == "shape_differs"
    assert matcher.asked == []
    np.testing.assert_allclose(edge.relative_pose, between(POSES[1], POSES[3]))
    assert edge.figures == {"mahalanobis": 2.0, "shape_distance": 0.9}


def test_no_candidates_no_loops() -> None:
    assert loop_constraints(nodes(), POSES, [], RecordingMatcher()) == []
