# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the back end's guard decides is what the mission shows and hands on."""

from collections import Counter

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.graph.guarded_back_end import CONTRADICTS, WITHDRAWN
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Constraint, ConstraintKind, KeyframeReport, TwistError
from msss_graphslam.nodes.mission import Mission

STEP = np.array([1.0, 0.0, 0.3])
DRIFTING = np.diag([0.3, 0.3, 0.05]) ** 2
SURE = np.diag([0.03, 0.03, 0.005]) ** 2
TRUTH = [np.zeros(3)]
for _ in range(41):
    TRUTH.append(compose(TRUTH[-1], STEP))


def closure(first: int, second: int, off: float = 0.0) -> Constraint:
    relative = between(TRUTH[first], TRUTH[second]) + np.array([off, 0.0, 0.0])
    return Constraint(ConstraintKind.LOOP, first, second, relative, SURE)


def reports() -> list[KeyframeReport]:
    """One closure that odometry excludes, one that later ones show to be wrong."""
    found = {10: [closure(1, 10, 90.0)], 21: [closure(1, 21, 3.0)]}
    found |= {second: [closure(second - 20, second)] for second in range(22, 41)}
    made = []
    for number, pose in enumerate(TRUTH[:41]):
        step = Constraint(ConstraintKind.CONSECUTIVE, number - 1, number, STEP, DRIFTING)
        edges = [step, *found.get(number, [])] if number else []
        error = TwistError(np.zeros(3), 1e-4 * np.eye(3))
        stamp_ns = 10**9 * (number + 1)
        made.append(KeyframeReport(number, stamp_ns, pose, pose, error, tuple(edges)))
    return made


def mission_of(estimator: str) -> Mission:
    mission = Mission(Configuration(), ESTIMATORS[estimator], Counter())
    for report in reports():
        assert mission.take(report)
    return mission


def refusals(mission: Mission) -> list[str]:
    return [edge.refusal for edge in mission.constraints if edge.kind is ConstraintKind.LOOP]


def test_a_withdrawn_closure_is_shown_refused_and_counted() -> None:
    mission = mission_of("full")
    assert refusals(mission) == [CONTRADICTS, WITHDRAWN, *[""] * 19]
    assert mission.withdrawals == 1
    assert mission.logbook().constraints == mission.constraints


def test_a_back_end_started_again_comes_to_the_same() -> None:
    one, other = mission_of("full"), mission_of("full")
    other._rebuild()
    np.testing.assert_array_equal(one.poses, other._back_end.take(np.zeros(3), [])[0])
    assert refusals(one) == refusals(other)


def test_the_paper_s_estimator_keeps_what_it_has_accepted() -> None:
    mission = mission_of("chen2015")
    assert set(refusals(mission)) == {""}
    assert mission.withdrawals == 0
