# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Consecutive scans are matched again and again, each time laid out by the match before."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from small_mission import estimated
from stub_matcher import StubMatcher

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Array, ConstraintKind

FULL = ESTIMATORS["full"]
ASTRAY = "too_little_overlap"


@dataclass
class Scripted(StubMatcher):
    """A matcher whose answers are (shift along x [m], overlap, refusal), one after another."""

    answers: Sequence[tuple[float, float, str]]
    starts: list[Array | None] = field(default_factory=list)

    def answer(self, initial: Array, _: Array, start: Array | None) -> MatchResult:
        shift, overlap, refusal = self.answers[min(len(self.starts), len(self.answers) - 1)]
        self.starts.append(start)
        pose = initial + np.array([shift, 0.0, 0.0])
        return MatchResult(pose, 1e-4 * np.eye(3), refusal, {"overlap": overlap})


def matched(*answers: tuple[float, float, str]) -> tuple[Scripted, FrontEnd, float, str]:
    """Return how far the second scan's match is from dead reckoning, and its refusal."""
    matcher = Scripted(answers)
    recipe = replace(FULL, matcher=lambda _: matcher, closes_loops=False)
    front_end = FrontEnd(Configuration(), recipe)
    scans = estimated("dead_reckoning").first_scans[:2]
    front_end.add_scan(scans[0])
    tried = front_end.add_scan(scans[1])
    edge = next(entry for entry in tried if entry.kind is ConstraintKind.CONSECUTIVE)
    reckoned = between(scans[0].odometry, scans[1].odometry)
    return matcher, front_end, float(edge.relative_pose[0] - reckoned[0]), edge.refusal


def test_a_round_starts_where_the_one_before_ended() -> None:
    matcher, _, _, _ = matched((0.3, 0.9, ""), (0.5, 0.9, ""), (0.5, 0.9, ""))
    assert matcher.starts[0] is None
    steps = np.diff([start[0] for start in matcher.starts[1:] if start is not None])
    np.testing.assert_allclose(steps, [0.2])
    assert len(matcher.starts) == 3


@pytest.mark.parametrize(
    ("answers", "shift"),
    [
        ([(0.3, 0.9, ""), (-2.0, 0.6, ""), (1.0, 0.2, ASTRAY)], 0.3),
        ([(0.3, 0.6, ""), (0.5, 0.9, ""), (1.0, 0.2, ASTRAY)], 0.5),
        ([(0.3, 0.6, ""), (1.0, 0.2, ASTRAY)], 0.3),
    ],
)
def test_rounds_that_go_astray_leave_the_best_match(
    answers: list[tuple[float, float, str]], shift: float
) -> None:
    _, front_end, found, refusal = matched(*answers)
    assert refusal == ""
    assert found == pytest.approx(shift, abs=1e-6)
    _, again, _, _ = matched((shift, 0.9, ""))
    np.testing.assert_allclose(front_end.offset, again.offset, atol=1e-9)
    np.testing.assert_allclose(front_end.nodes[0].scan.points, again.nodes[0].scan.points)


def test_a_match_refused_at_first_stays_refused() -> None:
    matcher, front_end, _, refusal = matched((0.3, 0.2, ASTRAY))
    assert refusal == ASTRAY
    assert len(matcher.starts) == 1
    np.testing.assert_array_equal(front_end.offset, np.zeros(3))
