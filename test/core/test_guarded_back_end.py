# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from msss_graphslam.config.groups import BackEnd as Config
from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.graph.closure_gate import STRETCH
from msss_graphslam.core.graph.closure_review import PATIENCE, ClosureReview, Verdict
from msss_graphslam.core.graph.guarded_back_end import CONTRADICTS, WITHDRAWN, GuardedBackEnd
from msss_graphslam.core.graph.known_places import KNOWN_BETTER
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

START = np.array([1.0, -2.0, 0.4])
STEP = np.array([1.0, 0.0, 0.3])
SURE = np.diag([0.03, 0.03, 0.005]) ** 2
DRIFTING = np.diag([0.3, 0.3, 0.05]) ** 2
NODES = 21
"""A round of keyframes ends near where it began."""


def truth() -> Array:
    poses = [START]
    for _ in range(2 * NODES):
        poses.append(compose(poses[-1], STEP))
    return np.array(poses)


def step(second: int, covariance: Array = DRIFTING) -> Constraint:
    return Constraint(ConstraintKind.CONSECUTIVE, second - 1, second, STEP, covariance)


def closure(first: int, second: int, off: tuple[float, float, float] = (0, 0, 0)) -> Constraint:
    poses = truth()
    relative = between(poses[first], poses[second]) + np.array(off)
    return Constraint(ConstraintKind.LOOP, first, second, relative, SURE)


def fed(
    closures: dict[int, list[Constraint]],
    count: int = NODES,
    covariance: Array = DRIFTING,
    back_end: GuardedBackEnd | None = None,
) -> GuardedBackEnd:
    back_end = back_end or GuardedBackEnd(Config(), guards=True)
    back_end.take(START, [])
    for second in range(1, count):
        back_end.take(START, [step(second, covariance), *closures.get(second, [])])
    return back_end


def refusals(back_end: GuardedBackEnd) -> list[str]:
    return [edge.refusal for edge in back_end.tried if edge.kind is ConstraintKind.LOOP]


def test_without_closures_it_is_the_back_end() -> None:
    plain, guarded = BackEnd(Config(), divides=True), GuardedBackEnd(Config(), guards=True)
    for second in range(NODES):
        new = [step(second)] if second else []
        for answer, expected in zip(guarded.take(START, new), plain.take(START, new), strict=True):
            np.testing.assert_array_equal(answer, expected)
    assert guarded.tried == plain.constraints


@pytest.mark.parametrize(
    ("covariance", "off", "refusal"),
    [
        (SURE, (3.0, 0.0, 0.0), CONTRADICTS),
        (SURE, (0.0, 0.0, 1.0), CONTRADICTS),
        (SURE, (0.1, 0.1, 0.0), ""),
        (DRIFTING, (3.0, 0.0, 0.0), ""),
        (DRIFTING, (40.0, 0.0, 0.0), CONTRADICTS),
    ],
)
def test_what_the_way_excludes_stays_outside(
    covariance: Array, off: tuple[float, float, float], refusal: str
) -> None:
    """Three metres are much for a way that is known to decimetres, and little for a vague one."""
    wrong = closure(2, 20, off)
    back_end = fed({20: [wrong]}, covariance=covariance)
    assert refusals(back_end) == [refusal]
    assert back_end.tried[-1].figures["contradiction"] > 0.0
    if refusal:
        alone, _ = fed({}, covariance=covariance).take(START, [])
        np.testing.assert_array_equal(back_end.take(START, [])[0], alone)


def test_a_crowd_of_wrong_closures_that_agree_does_nothing() -> None:
    """A corner taken for another: each scan of a stretch says the same, four times."""
    off = (4.0, 0.0, 0.0)
    crowd = {
        second: [closure(second - 14 + more, second, off) for more in range(4)]
        for second in range(15, 21)
    }
    away = []
    for guards in (True, False):
        back_end = GuardedBackEnd(Config(robust_width=0.0), guards=guards)
        poses, _ = fed(crowd, covariance=SURE, back_end=back_end).take(START, [])
        away.append(np.linalg.norm((poses - truth()[:NODES])[:, :2], axis=1).max())
    assert away[0] < 1e-6
    assert away[1] > 1.0


def unguarded() -> GuardedBackEnd:
    return GuardedBackEnd(Config(), guards=False)


def later(wrong: Constraint) -> GuardedBackEnd:
    """A wrong closure that odometry allows, then right ones about it, scan after scan."""
    right = {second: [closure(second - 20, second)] for second in range(22, 2 * NODES)}
    return fed({wrong.second: [wrong], **right}, 2 * NODES)


def test_a_closure_found_wrong_later_is_withdrawn() -> None:
    back_end = later(closure(1, 21, (3.0, 1.0, 0.0)))
    assert refusals(back_end)[0] == WITHDRAWN
    assert set(refusals(back_end)[1:]) == {""}
    assert (back_end.withdrawals, back_end.readmissions) == (1, 0)
    right = {second: [closure(second - 20, second)] for second in range(22, 2 * NODES)}
    without, _ = fed(right, 2 * NODES).take(START, [])
    np.testing.assert_allclose(back_end.take(START, [])[0], without, atol=0.02)


def test_a_right_closure_is_not_withdrawn() -> None:
    back_end = later(closure(1, 21))
    assert set(refusals(back_end)) == {""}
    assert back_end.withdrawals == 0


def test_what_comes_back_is_as_if_it_had_never_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    closures = {20: [closure(1, 20, (0.2, 0.0, 0.0)), closure(3, 20)]}
    kept, without = fed(closures), fed({20: closures[20][1:]})
    back_end = fed(closures)
    verdicts = [Verdict((0,), ()), Verdict((), (0,))]
    monkeypatch.setattr(back_end._review, "judge", lambda _: verdicts.pop(0))
    for second, expected, refusal in ((21, without, WITHDRAWN), (22, kept, "")):
        poses, covariance = back_end.take(START, [step(second)])
        if expected is kept:
            expected.take(START, [step(21)])
        wanted, its_covariance = expected.take(START, [step(second)])
        np.testing.assert_allclose(poses, wanted, atol=0.01)
        np.testing.assert_allclose(covariance, its_covariance, rtol=0.05, atol=1e-4)
        assert refusals(back_end) == [refusal, ""]
    assert (back_end.withdrawals, back_end.readmissions) == (1, 1)


def test_a_smoother_made_anew_has_what_was_not_withdrawn() -> None:
    back_end = later(closure(1, 21, (3.0, 1.0, 0.0)))
    before, _ = back_end.take(START, [step(2 * NODES)])
    back_end._back_end._rebuild()
    np.testing.assert_allclose(back_end._back_end.poses(), before, atol=0.01)


def test_withdrawing_takes_some_updates() -> None:
    wrong = closure(1, 21, (3.0, 1.0, 0.0))
    right = [closure(second - 20, 21) for second in range(22, 28)]
    for count, refusal in ((PATIENCE - 1, ""), (PATIENCE, WITHDRAWN)):
        assert refusals(fed({21: [wrong, *right]}, 21 + count))[0] == refusal


def test_the_same_constraints_make_the_same_graph() -> None:
    wrong = closure(1, 21, (3.0, 1.0, 0.0))
    one, other = later(wrong), later(wrong)
    np.testing.assert_array_equal(one.take(START, [])[0], other.take(START, [])[0])
    assert refusals(one) == refusals(other)


def test_without_guards_everything_stays() -> None:
    wrong = [closure(2, 20, (90.0, 0.0, 0.0)), closure(3, 20, (0.0, 0.0, 2.0))]
    for back_end in (unguarded(), GuardedBackEnd(Config(contradiction=0.0), guards=True)):
        assert refusals(fed({20: wrong}, covariance=SURE, back_end=back_end)) == ["", ""]


@pytest.mark.parametrize(
    "bad",
    [
        closure(2, 20, (np.nan, 0.0, 0.0)),
        replace(closure(2, 20), first=25),
        replace(closure(2, 20), first=20),
        replace(closure(2, 20), covariance=np.zeros((3, 3))),
        replace(step(20), relative_pose=np.full(3, np.inf)),
    ],
)
def test_what_no_graph_can_take_changes_nothing(bad: Constraint) -> None:
    back_end, expected = fed({}, 20), fed({}, 20)
    with pytest.raises(ValueError, match="20"):
        back_end.take(START, [step(20), bad])
    assert len(back_end.tried) == 19
    good = [step(20), closure(0, 20, (1.0, 0.0, 0.0)), closure(5, 20, (70.0, 0.0, 0.0))]
    for answer, wanted in zip(back_end.take(START, good), expected.take(START, good), strict=True):
        np.testing.assert_array_equal(answer, wanted)
    assert refusals(back_end) == refusals(expected)


def test_what_was_refused_before_keeps_its_reason() -> None:
    refused = replace(closure(2, 20, (90.0, 0.0, 0.0)), refusal="too_little_overlap")
    back_end = fed({20: [refused]}, covariance=SURE)
    assert back_end.tried[-1] is refused


def test_a_keyframe_that_hangs_on_a_closure_alone_is_taken() -> None:
    """There is no way that could contradict it."""
    back_end = fed({}, covariance=SURE)
    poses, _ = back_end.take(START, [closure(0, NODES, (60.0, 0.0, 0.0))])
    assert len(poses) == NODES + 1
    assert back_end.tried[-1].accepted
    back_end.take(START, [step(NODES + 1, SURE), closure(0, NODES + 1, (-60.0, 0.0, 0.0))])
    assert back_end.tried[-1].accepted


def left_out(second: int, covariance: Array = DRIFTING) -> Constraint:
    return replace(step(second, covariance), refusal=KNOWN_BETTER)


def test_a_scan_of_a_known_place_may_hang_on_closures_alone() -> None:
    back_end = fed({}, count=20)
    back_end.take(START, [left_out(20), closure(2, 20), closure(4, 20)])
    poses, _ = back_end.take(START, [step(21)])
    assert len(poses) == 22
    assert [edge.refusal for edge in back_end.tried[-4:-1]] == [KNOWN_BETTER, "", ""]


def test_the_way_is_known_although_the_graph_leaves_it_out() -> None:
    """So a closure that it excludes is refused, and the keyframe hangs on its predecessor."""
    back_end = fed({}, count=20, covariance=SURE)
    poses, _ = back_end.take(START, [left_out(20, SURE), closure(2, 20, (40.0, 0.0, 0.0))])
    assert len(poses) == 21
    assert [edge.refusal for edge in back_end.tried[-2:]] == ["", CONTRADICTS]
    np.testing.assert_allclose(between(poses[19], poses[20]), STEP, atol=1e-6)


def test_a_keyframe_whose_closures_are_withdrawn_hangs_on_its_predecessor(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    back_end = fed({}, count=20)
    monkeypatch.setattr(ClosureReview, "judge", lambda *_: Verdict((0,), ()))
    poses, covariance = back_end.take(START, [left_out(20), closure(2, 20, (1.5, 0.0, 0.0))])
    assert [edge.refusal for edge in back_end.tried[-2:]] == ["", WITHDRAWN]
    np.testing.assert_allclose(between(poses[19], poses[20]), STEP, atol=1e-6)
    assert np.linalg.eigvalsh(covariance)[0] > 0.0


def lap(back_end: GuardedBackEnd, hangers: tuple[int, ...] = ()) -> list[Array]:
    """Go round once more at known places; return the poses after each scan.

    Each scan hangs on two closures, but some hang on their predecessor.
    """
    seen = []
    for second in range(NODES, 2 * NODES):
        first = second - NODES
        tried = [left_out(second), closure(first, second), closure(max(first - 2, 0), second)]
        seen.append(back_end.take(START, [step(second)] if second in hangers else tried)[0])
    return seen


def test_scans_of_known_places_leave_the_smoother_and_stay_where_they_are() -> None:
    back_end = fed({})
    poses = lap(back_end)[-1]
    inside = {edge.second for edge in back_end._back_end.constraints}
    assert inside == {*range(1, NODES), *range(2 * NODES - STRETCH, 2 * NODES)}
    assert all(edge.refusal in {"", KNOWN_BETTER} for edge in back_end.tried)
    np.testing.assert_allclose(poses[:, :2], truth()[: 2 * NODES, :2], atol=0.02)


def test_what_another_scan_hangs_on_stays_in_the_smoother() -> None:
    back_end = fed({})
    lap(back_end, hangers=(NODES + 3,))
    inside = {edge.second for edge in back_end._back_end.constraints}
    assert {NODES + 2, NODES + 3} <= inside
    assert not {NODES + 1, NODES + 4} & inside


def test_a_closure_of_one_that_has_left_may_be_withdrawn_and_come_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    back_end = fed({})
    poses = lap(back_end)[-1]
    verdicts = [Verdict((0, 1), ()), Verdict((), (0, 1))]
    monkeypatch.setattr(back_end._review, "judge", lambda _: verdicts.pop(0))
    for second, refusal in ((2 * NODES, WITHDRAWN), (2 * NODES + 1, "")):
        again, _ = back_end.take(START, [step(second)])
        assert refusals(back_end)[:2] == [refusal] * 2
        np.testing.assert_allclose(again[: 2 * NODES], poses, atol=0.01)


def test_a_false_closure_to_one_that_has_left_is_withdrawn() -> None:
    back_end = fed({})
    lap(back_end)
    wrong = closure(NODES + 1, 2 * NODES, (1.5, 1.0, 0.0))
    right = [closure(number, 2 * NODES) for number in range(4)]
    back_end.take(START, [step(2 * NODES), wrong, *right])
    for second in range(2 * NODES + 1, 2 * NODES + 1 + PATIENCE):
        back_end.take(START, [step(second)])
    assert back_end.withdrawals == 1
    assert {edge.refusal for edge in back_end.tried if edge.first == wrong.first} >= {WITHDRAWN}
