# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.core.compounding import between, wrap
from msss_graphslam.core.graph.closure_review import LAYOUT, PATIENCE, ClosureReview, Verdict
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

BOUND = 9.0
POSES = np.array([[1.0, -2.0, 3.0], [4.0, 1.0, -3.0], [5.0, 7.0, 1.0]])
SPREAD = np.diag([0.2, 0.1, 0.05]) ** 2
NOTHING = Verdict((), ())


def closure(distance: float, first: int = 0, second: int = 1, yaw: float = 0.0) -> Constraint:
    """A closure at the squared Mahalanobis ``distance`` from POSES, its heading ``yaw`` more."""
    off = np.linalg.cholesky(SPREAD + LAYOUT) @ np.array([0.6, -0.64, 0.48]) * np.sqrt(distance)
    relative = between(POSES[first], POSES[second]) + off
    relative[2] += yaw
    return Constraint(ConstraintKind.LOOP, first, second, relative, SPREAD)


def reviewed(*edges: Constraint) -> ClosureReview:
    review = ClosureReview(BOUND)
    review.add(edges)
    return review


def moved(poses: Array, metres: float) -> Array:
    """The second keyframe somewhere else."""
    return poses + np.array([[0.0, 0.0, 0.0], [metres, 0.0, 0.0], [0.0, 0.0, 0.0]])


def test_without_closures_nothing_is_due() -> None:
    assert ClosureReview(BOUND).judge(POSES) == NOTHING
    assert reviewed().judge(np.empty((0, 3))) == NOTHING


@pytest.mark.parametrize(("factor", "withdrawn"), [(0.99, ()), (1.01, (0,))])
@pytest.mark.parametrize("ends", [(0, 1), (1, 2), (0, 2)])
def test_both_sides_of_the_bound(
    factor: float, withdrawn: tuple[int, ...], ends: tuple[int, int]
) -> None:
    review = reviewed(closure(BOUND * factor, *ends))
    for _ in range(PATIENCE - 1):
        assert review.judge(POSES) == NOTHING
    assert review.judge(POSES) == Verdict(withdrawn, ())


@pytest.mark.parametrize("turns", [-1.0, 1.0])
def test_headings_are_compared_round_the_circle(turns: float) -> None:
    review = reviewed(closure(0.5 * BOUND, yaw=2.0 * np.pi * turns))
    assert [review.judge(POSES) for _ in range(PATIENCE + 1)] == [NOTHING] * (PATIENCE + 1)


def test_a_single_agreement_begins_the_count_anew() -> None:
    review = reviewed(closure(0.0))
    away = moved(POSES, 5.0)
    for _ in range(PATIENCE - 1):
        assert review.judge(away) == NOTHING
    assert review.judge(POSES) == NOTHING
    for _ in range(PATIENCE - 1):
        assert review.judge(away) == NOTHING
    assert review.judge(away) == Verdict((0,), ())


def test_what_was_withdrawn_comes_back_when_it_agrees_as_long() -> None:
    review = reviewed(closure(0.0), closure(0.0, 0, 2))
    away = moved(POSES, 5.0)
    assert [review.judge(away) for _ in range(PATIENCE)][-1] == Verdict((0,), ())
    assert [review.judge(away) for _ in range(5)] == [NOTHING] * 5
    assert [review.judge(POSES) for _ in range(PATIENCE)][-1] == Verdict((), (0,))
    assert [review.judge(POSES) for _ in range(5)] == [NOTHING] * 5


def test_numbers_go_on_over_several_additions() -> None:
    review = reviewed(closure(0.0, 0, 2), closure(4.0 * BOUND, 0, 2))
    review.judge(POSES)
    review.add([closure(0.0), closure(4.0 * BOUND)])
    verdicts = [review.judge(POSES) for _ in range(PATIENCE)]
    assert verdicts[-2].withdrawn == (1,)
    assert verdicts[-1].withdrawn == (3,)


def test_the_oracle_of_these_tests_is_what_it_says() -> None:
    edge = closure(7.0, 1, 2)
    off = edge.relative_pose - between(POSES[1], POSES[2])
    off[2] = wrap(off[2])
    assert off @ np.linalg.inv(SPREAD + LAYOUT) @ off == pytest.approx(7.0)


def test_what_has_not_moved_is_judged_as_if_measured_again() -> None:
    """Closures come one by one while only some keyframes move."""
    review, edges, steps = ClosureReview(BOUND), list[Constraint](), [0.0, 5.0, 5.0, 5.0, 0.0]
    for number, metres in enumerate(steps):
        edges.append(closure(0.5 * BOUND, *((0, 1), (1, 2), (0, 2))[number % 3]))
        review.add(edges[-1:])
        verdict = review.judge(moved(POSES, metres))
        assert verdict.readmitted == ()
        assert verdict.withdrawn == ((0, 1) if number == PATIENCE else ())


def test_poses_changed_in_place_are_seen() -> None:
    review, poses = reviewed(closure(0.0)), POSES.copy()
    assert review.judge(poses) == NOTHING
    poses[1, 0] += 5.0
    verdicts = [review.judge(poses) for _ in range(PATIENCE)]
    assert verdicts[-1] == Verdict((0,), ())


def test_one_by_one_they_are_judged_as_all_at_once() -> None:
    """More than there is room for at first."""
    rng = np.random.default_rng(5)
    edges = [closure(distance) for distance in rng.uniform(0.5 * BOUND, 1.5 * BOUND, 300)]
    one_by_one = ClosureReview(BOUND)
    for edge in edges:
        one_by_one.add([edge])
    at_once = reviewed(*edges)
    metres = [0.0] * PATIENCE + [0.1, 0.2] + [0.0] * PATIENCE
    verdicts = [at_once.judge(moved(POSES, away)) for away in metres]
    assert [one_by_one.judge(moved(POSES, away)) for away in metres] == verdicts
    assert 100 < len(verdicts[PATIENCE - 1].withdrawn) < 200


def test_streaks_go_on_while_more_closures_come() -> None:
    review = reviewed(closure(2.0 * BOUND))
    for _ in range(PATIENCE - 1):
        assert review.judge(POSES) == NOTHING
        review.add([closure(0.0)] * 100)
    assert review.judge(POSES) == Verdict((0,), ())


@pytest.mark.parametrize(("factor", "withdrawn"), [(0.85, ()), (0.95, (0,))])
def test_a_graph_that_comes_nearer_is_being_convinced(
    factor: float, withdrawn: tuple[int, ...]
) -> None:
    """Of the squared distance to a closure that it contradicts it takes off a share every time."""
    review = reviewed(closure(0.0))
    squares = 40.0 * BOUND * factor ** np.arange(PATIENCE + 2)
    verdicts = [review.judge(moved(POSES, np.sqrt(square) * 0.1)) for square in squares]
    assert max(verdict.withdrawn for verdict in verdicts) == withdrawn


def test_what_is_allowed_beside_the_covariances_counts() -> None:
    for slack, withdrawn in ((LAYOUT, ()), (0.1 * LAYOUT, (0,))):
        review = ClosureReview(BOUND)
        review.add([closure(0.9 * BOUND)], slack)
        assert [review.judge(POSES) for _ in range(PATIENCE)][-1].withdrawn == withdrawn
