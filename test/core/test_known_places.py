# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.core.graph.known_places import (
    CLOSURES,
    KEYFRAMES,
    KNOWN_BETTER,
    is_known,
    located_alone,
)
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

POSE = np.array([3.0, -2.0, 1.0])
NARROW = np.diag([0.02**2, 0.02**2, 0.003**2])


def edge(
    kind: ConstraintKind, first: int, covariance: Array = NARROW, refusal: str = ""
) -> Constraint:
    return Constraint(kind, first, 99, np.array([0.1, 0.2, 0.7 * first]), covariance, refusal)


def loops(count: int, covariance: Array = NARROW) -> list[Constraint]:
    return [edge(ConstraintKind.LOOP, number, covariance) for number in range(count)]


def chain(covariance: Array = NARROW) -> list[Constraint]:
    odometry = edge(ConstraintKind.ODOMETRY, 98, 100.0 * NARROW)
    return [odometry, edge(ConstraintKind.CONSECUTIVE, 98, covariance)]


def places(count: int, away: float) -> Array:
    return np.tile(POSE + np.array([0.0, away, 2.0]), (count, 1))


@pytest.mark.parametrize(
    ("count", "away", "closures", "known"),
    [
        (KEYFRAMES, 1.49, CLOSURES, True),
        (KEYFRAMES - 1, 1.49, CLOSURES, False),
        (KEYFRAMES, 1.51, CLOSURES, False),
        (KEYFRAMES, 1.49, CLOSURES - 1, False),
        (0, 0.0, CLOSURES, False),
    ],
)
def test_a_place_is_known_with_enough_keyframes_where_the_scan_was_found_again(
    count: int, away: float, closures: int, known: bool
) -> None:
    tried = [*chain(), *loops(closures), edge(ConstraintKind.LOOP, 9, refusal="shape_differs")]
    assert is_known(POSE, places(count, away), 1.5, tried) is known


def test_the_chain_is_left_out_where_loops_say_more() -> None:
    tried = [*chain(), *loops(3), edge(ConstraintKind.LOOP, 9, refusal="shape_differs")]
    found = located_alone(tried)
    assert [entry.refusal for entry in found] == [
        KNOWN_BETTER,
        KNOWN_BETTER,
        "",
        "",
        "",
        "shape_differs",
    ]
    assert all(
        new.relative_pose is old.relative_pose for new, old in zip(found, tried, strict=True)
    )


@pytest.mark.parametrize("count", [0, 1])
def test_the_chain_stays_where_loops_do_not_say_more(count: int) -> None:
    tried = [*chain(), *loops(count)]
    assert located_alone(tried) == tried


def test_the_chain_stays_where_loops_leave_one_direction_open() -> None:
    """Along a corridor only dead reckoning tells how far the vehicle has come."""
    blind = np.diag([1e4, 0.001**2, 0.0001**2])
    same_axes = [
        Constraint(ConstraintKind.LOOP, number, 99, np.zeros(3), blind) for number in range(4)
    ]
    tried = [*chain(), *same_axes]
    assert located_alone(tried) == tried


def test_loops_are_compared_in_the_axes_of_the_newest_keyframe() -> None:
    """Two loops from keyframes that head across each other are blind in different directions."""
    blind = np.diag([1e4, 0.001**2, 0.0001**2])
    across = [
        Constraint(ConstraintKind.LOOP, number, 99, np.array([0.0, 0.0, yaw]), blind)
        for number, yaw in enumerate([0.0, 0.5 * np.pi])
    ]
    found = located_alone([*chain(), *across])
    assert [entry.refusal for entry in found] == [KNOWN_BETTER, KNOWN_BETTER, "", ""]


def test_what_was_refused_before_keeps_its_reason() -> None:
    refused = edge(ConstraintKind.CONSECUTIVE, 98, refusal="too_little_overlap")
    found = located_alone([chain()[0], refused, *loops(3)])
    assert [entry.refusal for entry in found[:2]] == [KNOWN_BETTER, "too_little_overlap"]
