# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections.abc import Iterable
from copy import deepcopy

import numpy as np
import pytest

from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.graph.closure_gate import COMPANY, CONTRADICTS, STRETCH, ClosureGate
from msss_graphslam.core.graph.layout_slack import AT_MOST, LAYOUT, PRIOR, LayoutSlack
from msss_graphslam.core.types import Constraint, ConstraintKind

BOUND = 16.3
STEP = np.array([1.0, 0.0, 0.1])
MATCH = np.diag([0.1, 0.05, 0.01]) ** 2
COUNT = 60
SPANS = (2, 4, 6)


def edge(kind: ConstraintKind, first: int, second: int, off: Iterable[float] = ()) -> Constraint:
    pose = np.zeros(3)
    for _ in range(first, second):
        pose = compose(pose, STEP)
    off = np.array([*off] or [0.0, 0.0, 0.0])
    return Constraint(kind, first, second, pose + off, MATCH.copy())


def tried_at(second: int, spans: Iterable[int], off: Iterable[float] = ()) -> list[Constraint]:
    near = [second - span for span in spans if second >= span]
    step = edge(ConstraintKind.CONSECUTIVE, second - 1, second)
    return [step, *(edge(ConstraintKind.LOOP, first, second, off) for first in near)]


def gate_of(count: int, spans: Iterable[int], off: Iterable[float] = ()) -> ClosureGate:
    gate = ClosureGate(BOUND)
    for second in range(1, count):
        assert all(one.accepted for one in gate.pass_through(tried_at(second, spans, off)))
    return gate


@pytest.mark.parametrize(("spans", "refusal"), [((), ""), (SPANS, CONTRADICTS)])
def test_near_matches_tell_the_way_more_exactly_than_steps_alone(
    spans: tuple[int, ...], refusal: str
) -> None:
    gate = gate_of(COUNT, spans)
    false = edge(ConstraintKind.LOOP, 10, COUNT, [1.2, 0.0, 0.0])
    true = edge(ConstraintKind.LOOP, 12, COUNT, [0.1, 0.0, 0.0])
    judged = gate.pass_through([*tried_at(COUNT, spans), false, true])
    assert [one.refusal for one in judged[-2:]] == [refusal, ""]
    assert judged[-2].figures["contradiction"] > 4.0 * judged[-1].figures["contradiction"]


def test_far_closures_cannot_talk_the_way_over() -> None:
    """However many agree: the way knows nothing of them."""
    gate = gate_of(COUNT, SPANS)
    first = gate.pass_through(
        [*tried_at(COUNT, SPANS), edge(ConstraintKind.LOOP, 9, COUNT, [0.3, 0, 0])]
    )
    for second in range(COUNT + 1, COUNT + 9):
        crowd = [
            edge(ConstraintKind.LOOP, second - 50 + more, second, [0.3, 0, 0]) for more in range(4)
        ]
        last = gate.pass_through([*tried_at(second, SPANS), *crowd])
    assert last[-1].accepted
    expected = first[-1].figures["contradiction"]
    assert last[-1].figures["contradiction"] == pytest.approx(expected, rel=0.1)


def test_a_near_match_that_is_false_does_not_bend_the_way() -> None:
    gate, untouched = gate_of(20, SPANS), gate_of(20, SPANS)
    false = edge(ConstraintKind.LOOP, 14, 20, [3.0, 0.0, 0.0])
    assert gate.pass_through([*tried_at(20, (2, 4)), false])[-1].refusal == CONTRADICTS
    untouched.pass_through(tried_at(20, (2, 4)))
    ways = [one._chain.displacement(0) for one in (gate, untouched)]
    assert ways[0] is not None
    assert ways[1] is not None
    np.testing.assert_allclose(between(ways[0][0], ways[1][0]), 0.0, atol=1e-9)
    np.testing.assert_array_equal(gate.slack, untouched.slack)


def test_what_near_matches_agree_in_is_not_allowed_far_ones() -> None:
    agreeing, disagreeing = gate_of(COUNT, SPANS), gate_of(COUNT, SPANS, [0.1, -0.05, 0.0])
    assert agreeing.slack[0, 0] < 0.15 * LAYOUT[0, 0]
    assert agreeing.slack[0, 0] < disagreeing.slack[0, 0] < LAYOUT[0, 0]
    np.testing.assert_array_equal(ClosureGate(BOUND).slack, LAYOUT)


def test_the_slack_is_the_mean_square_and_at_most_what_is_known_of_scans() -> None:
    known = LayoutSlack()
    for _ in range(3 * PRIOR):
        known = known.with_match(np.array([0.06, 0.08, 1.0]))
    expected = (PRIOR + 3 * PRIOR * 0.01 / AT_MOST) / (4 * PRIOR)
    np.testing.assert_allclose(known.covariance, expected * LAYOUT)
    for _ in range(PRIOR):
        known = known.with_match(np.array([1.0, 0.0, 0.0]))
    np.testing.assert_array_equal(known.covariance, LAYOUT)


def test_a_keyframe_that_was_dropped_leaves_nothing_behind() -> None:
    gate, untouched = gate_of(20, SPANS), gate_of(20, SPANS)
    gate.pass_through(tried_at(20, SPANS, [0.2, 0.0, 0.0]))
    gate.drop_newest()
    assert len(gate) == len(untouched) == 20
    np.testing.assert_array_equal(gate.slack, untouched.slack)
    far = [*tried_at(20, SPANS), edge(ConstraintKind.LOOP, 3, 20, [0.3, 0.0, 0.0])]
    judged = [one.pass_through(far)[-1].figures["contradiction"] for one in (gate, untouched)]
    assert judged[0] == judged[1]


def far_at(share: float, first: int, gate: ClosureGate, bearing: float = 0.0) -> Constraint:
    """A closure with the next keyframe, at a share of the bound from the way.

    It is off towards ``bearing`` [rad] in the axes that the way begins with.
    """
    second, heading = len(gate), gate._chain._poses[first][2]
    off = np.array([np.cos(bearing - heading), np.sin(bearing - heading), 0.0])
    probe = edge(ConstraintKind.LOOP, first, second, off)
    judged = deepcopy(gate).pass_through([*tried_at(second, SPANS), probe])
    distance = judged[-1].figures["contradiction"]
    return edge(ConstraintKind.LOOP, first, second, np.sqrt(share * BOUND / distance) * off)


@pytest.mark.parametrize(("bearing", "refusal"), [(0.0, CONTRADICTS), (2.0, ""), (np.pi, "")])
def test_an_excluded_closure_that_is_off_elsewhere_casts_no_doubt(
    bearing: float, refusal: str
) -> None:
    gate = gate_of(COUNT, SPANS)
    gate.pass_through([*tried_at(COUNT, SPANS), far_at(1.2, 10, gate)])
    far = far_at(0.9, 11, gate, bearing)
    assert gate.pass_through([*tried_at(COUNT + 1, SPANS), far])[-1].refusal == refusal


@pytest.mark.parametrize(
    ("excluded", "share", "refusal"),
    [
        (None, 0.95, ""),
        (1.05, 1.05 * COMPANY, CONTRADICTS),
        (1.05, 0.95 * COMPANY, ""),
        (0.95, 0.95, ""),
    ],
)
def test_an_excluded_closure_makes_those_of_its_stretch_doubtful(
    excluded: float | None, share: float, refusal: str
) -> None:
    gate = gate_of(COUNT, SPANS)
    if excluded:
        gate.pass_through([*tried_at(COUNT, SPANS), far_at(excluded, 10, gate)])
    else:
        gate.pass_through(tried_at(COUNT, SPANS))
    far = far_at(share, 11, gate)
    assert gate.pass_through([*tried_at(COUNT + 1, SPANS), far])[-1].refusal == refusal


@pytest.mark.parametrize(("since", "apart"), [(STRETCH, 1), (1, STRETCH)])
@pytest.mark.parametrize(("more", "refusal"), [(0, CONTRADICTS), (1, "")])
def test_a_stretch_ends(since: int, apart: int, more: int, refusal: str) -> None:
    gate = gate_of(COUNT, SPANS)
    gate.pass_through([*tried_at(COUNT, SPANS), far_at(2.0, 10, gate)])
    longer = (since + more, apart) if since > apart else (since, apart + more)
    for second in range(COUNT + 1, COUNT + longer[0]):
        gate.pass_through(tried_at(second, SPANS))
    far = far_at(0.9, 10 + longer[1], gate)
    assert gate.pass_through([*tried_at(COUNT + longer[0], SPANS), far])[-1].refusal == refusal


def test_an_excluded_closure_of_a_dropped_keyframe_is_forgotten() -> None:
    gate = gate_of(COUNT, SPANS)
    gate.pass_through([*tried_at(COUNT, SPANS), far_at(2.0, 10, gate)])
    gate.drop_newest()
    far = far_at(0.9, 11, gate)
    assert gate.pass_through([*tried_at(COUNT, SPANS), far])[-1].accepted
