# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections.abc import Sequence
from itertools import combinations

import numpy as np
import pytest
from moving_scans import BASIN, moving_scans

from msss_graphslam.core.compounding import compose
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.smoothing import bent_scans, joint_problem
from msss_graphslam.core.smoothing.bent_pair import Pairing, pairings
from msss_graphslam.core.smoothing.bent_scan import BentScan, bend
from msss_graphslam.core.smoothing.joint_problem import SLACK, JointProblem
from msss_graphslam.core.types import Array, Scan

COUNT = 5
SCANS, TRUTH = moving_scans(BASIN, COUNT)
PAIRS = list(combinations(range(COUNT), 2))
PERSISTENCE = Persistence(100.0, np.zeros(3))
REACH = 0.5


def problem(slack: float = SLACK, pairs: Sequence[tuple[int, int]] = PAIRS) -> JointProblem:
    return JointProblem(SCANS, pairs, PERSISTENCE, slack)


def rough() -> Array:
    off = np.random.default_rng(3).normal(0.0, [0.1, 0.1, 0.02], (COUNT + 1, 3))
    off[0] = 0.0
    return TRUTH + off


def solved(posed: JointProblem, steps: int = 12) -> tuple[Array, Array]:
    states = rough()
    for _ in range(steps):
        states[1:] += posed.linearised(states, REACH).solution()
    return states, posed.linearised(states, REACH).covariances()


class Work:
    """Counts what is linearised."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.bent, self.paired = 0, 0
        monkeypatch.setattr(bent_scans, "bend", self.bend)
        monkeypatch.setattr(joint_problem, "pairings", self.pairings)

    def bend(self, scan: Scan, end: Array, relative: Array, duration: float) -> BentScan:
        self.bent += 1
        return bend(scan, end, relative, duration)

    def pairings(
        self, moving: Sequence[BentScan], displacements: Array, lines: BentScan, reach: float
    ) -> list[Pairing | None]:
        self.paired += len(moving)
        return pairings(moving, displacements, lines, reach)

    def of(self, posed: JointProblem, states: Array, reach: float = REACH) -> tuple[int, int]:
        self.bent, self.paired = 0, 0
        posed.linearised(states, reach)
        return self.bent, self.paired


@pytest.fixture
def work(monkeypatch: pytest.MonkeyPatch) -> Work:
    return Work(monkeypatch)


def test_what_is_linearised_only_when_it_moves_has_the_same_solution() -> None:
    lazy, lazy_covariances = solved(problem())
    eager, eager_covariances = solved(problem(slack=0.0))
    deviations = np.sqrt(eager_covariances[1:].diagonal(axis1=1, axis2=2))
    assert (np.abs(lazy - eager)[1:] < 0.1 * deviations).all()
    np.testing.assert_allclose(lazy, eager, atol=2e-3)
    np.testing.assert_allclose(
        lazy_covariances[1:].diagonal(axis1=1, axis2=2), deviations**2, rtol=0.1
    )


def test_the_solution_is_the_truth() -> None:
    states, _ = solved(problem())
    assert np.hypot(*(states - TRUTH)[:, :2].T).max() < 0.1


def test_at_first_everything_is_linearised_and_then_nothing(work: Work) -> None:
    posed = problem()
    assert work.of(posed, rough()) == (COUNT, 2 * len(PAIRS))
    assert work.of(posed, rough()) == (0, 0)


def test_a_map_that_moves_as_a_whole_is_not_linearised_again(work: Work) -> None:
    posed = problem()
    step = posed.linearised(rough(), REACH).solution()
    origin = np.array([100.0, -40.0, 2.5])
    moved = compose(origin, rough())
    assert work.of(posed, moved) == (0, 0)
    turn = np.exp(1j * origin[2]) * (step[:, 0] + 1j * step[:, 1])
    found = posed.linearised(moved, REACH).solution()
    np.testing.assert_allclose(found[:, 0] + 1j * found[:, 1], turn, atol=1e-6)
    np.testing.assert_allclose(found[:, 2], step[:, 2], atol=1e-7)


def test_only_pairs_of_what_has_moved_are_linearised_again(work: Work) -> None:
    posed = problem()
    states = rough()
    posed.linearised(states, REACH)
    states[COUNT] += [0.1, 0.0, 0.0]
    assert work.of(posed, states) == (1, 2 * (COUNT - 1))


@pytest.mark.parametrize(("share", "again"), [(0.9, 0), (1.1, 1)])
@pytest.mark.parametrize("turned", [False, True])
def test_how_far_a_point_may_move(work: Work, share: float, again: int, turned: bool) -> None:
    posed = problem()
    states = rough()
    posed.linearised(states, REACH)
    scan = SCANS[COUNT - 1]
    tolerated = SLACK * np.sqrt(np.median(np.linalg.eigvalsh(scan.body_covariances)[:, 0]))
    away = np.median(np.linalg.norm(scan.body_points, axis=1)) if turned else 1.0
    states[COUNT, 2 if turned else 0] += share * tolerated / away
    assert work.of(posed, states)[0] == again


def test_a_narrower_reach_pairs_anew(work: Work) -> None:
    posed = problem()
    posed.linearised(rough(), 2.0)
    assert work.of(posed, rough(), 1.9) == (0, 2 * len(PAIRS))


def test_what_moved_since_counts_in_the_next_step() -> None:
    """Without slack or with it, a step away is answered by a step back."""
    lazy = problem(slack=1e9)
    states, _ = solved(problem())
    lazy.linearised(states, REACH)
    off = np.zeros_like(states)
    off[2:] = [0.02, -0.01, 0.002]
    step = lazy.linearised(states + off, REACH).solution()
    np.testing.assert_allclose(step, -off[1:], atol=5e-3)


def test_the_twists_are_those_of_the_bent_scans() -> None:
    states = rough()
    for slack in (0.0, 1e9):
        posed = problem(slack)
        posed.linearised(rough(), REACH)
        states[2] += [0.01, 0.0, 0.001]
        exact = problem(0.0)
        exact.linearised(states, REACH)
        if slack == 0.0:
            posed.linearised(states, REACH)
        np.testing.assert_allclose(posed.twists(states)[0], exact.twists(states)[0], atol=1e-4)


def test_scans_that_are_not_kept_at_hand_are_bent_as_they_were(
    work: Work, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual = solved(problem())[0]
    monkeypatch.setattr(bent_scans, "KEPT", 2)
    posed = problem()
    assert work.of(posed, rough())[0] > 2 * COUNT
    np.testing.assert_array_equal(solved(problem())[0], usual)


def test_pairs_added_in_parts_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = problem().linearised(rough(), REACH).solution()
    monkeypatch.setattr(joint_problem, "AT_ONCE", 3)
    found = problem().linearised(rough(), REACH).solution()
    np.testing.assert_allclose(found, usual, rtol=1e-9)


def test_which_scan_of_a_pair_comes_first_makes_no_difference() -> None:
    swapped = [(second, first) for first, second in PAIRS]
    usual = problem().linearised(rough(), REACH).solution()
    found = problem(pairs=swapped).linearised(rough(), REACH).solution()
    np.testing.assert_allclose(found, usual, atol=1e-9)


def test_without_pairs_dead_reckoning_stands() -> None:
    posed = problem(pairs=[])
    states = rough()
    for _ in range(5):
        states[1:] += posed.linearised(states, REACH).solution()
    np.testing.assert_allclose(posed.twists(states)[0], 0.0, atol=1e-6)


@pytest.mark.parametrize("together", [1, 2, COUNT])
def test_parts_change_what_is_made_when_and_nothing_else(
    together: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = problem().linearised(rough(), REACH).solution()
    monkeypatch.setattr(joint_problem, "TOGETHER", together)
    np.testing.assert_allclose(problem().linearised(rough(), REACH).solution(), whole, atol=1e-12)


def test_what_is_let_go_is_had_again(monkeypatch: pytest.MonkeyPatch) -> None:
    posed, work = problem(), Work(monkeypatch)
    before = posed.linearised(rough(), REACH).solution()
    bent = work.bent
    posed.forget()
    moved = rough()
    moved[2, 0] += 1.0
    posed.linearised(moved, REACH)
    assert work.bent > bent + 2
    np.testing.assert_allclose(posed.linearised(rough(), REACH).solution(), before, atol=1e-9)
