# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The poses that an update returns in a long mission, when not all are read every time."""

import numpy as np
import pytest

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between
from msss_graphslam.core.graph import back_end
from msss_graphslam.core.graph.back_end import READ_AGAIN, READ_EVERY, BackEnd
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

SPREAD = np.diag([0.02**2, 0.02**2, 0.003**2])


@pytest.fixture(autouse=True)
def long_already(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(back_end, "READ_ALWAYS", 5)


def truth(number: int) -> Array:
    turn = 0.2 * number
    return np.array([5.0 * np.cos(turn), 5.0 * np.sin(turn), 0.0])


def edge(first: int, second: int, off: float = 0.0) -> Constraint:
    relative = between(truth(first), truth(second)) + np.array([off, 0.0, 0.0])
    return Constraint(ConstraintKind.CONSECUTIVE, first, second, relative, SPREAD)


def grown(count: int, off: float = 0.0) -> tuple[BackEnd, list[Array]]:
    graph, answers = BackEnd(Configuration().back_end), []
    graph.take(truth(0), [])
    for number in range(1, count):
        edges = [edge(number - 1, number, off)]
        edges += [edge(number - 4, number, -off)] if number > 4 else []
        answers.append(graph.take(truth(0), edges)[0])
    return graph, answers


def test_what_stays_is_the_same_as_read_anew() -> None:
    graph, answers = grown(60)
    np.testing.assert_allclose(answers[-1], graph.poses(), atol=1e-9)
    assert [len(poses) for poses in answers] == list(range(2, 61))


def test_poses_are_never_far_behind() -> None:
    graph, answers = grown(59, off=0.005)
    assert 59 % READ_EVERY
    assert np.abs(answers[-1] - graph.poses()).max() < READ_EVERY * READ_AGAIN


def test_the_keyframes_of_an_update_are_read_always() -> None:
    graph, answers = grown(59, off=0.005)
    np.testing.assert_array_equal(answers[-1][[54, 57, 58]], graph.poses()[[54, 57, 58]])


def test_a_closure_that_moves_much_moves_all_at_once() -> None:
    graph, answers = grown(41)
    assert 41 % READ_EVERY
    moved = graph.update([edge(0, 40, off=0.5)])
    assert np.abs(moved[:41] - answers[-1]).max() > 10.0 * READ_AGAIN
    np.testing.assert_array_equal(moved, graph.poses())


def test_a_caller_may_change_what_it_was_given() -> None:
    graph, answers = grown(20)
    answers[-1][:] = np.nan
    poses, _ = graph.take(truth(0), [edge(19, 20)])
    assert np.isfinite(poses).all()
