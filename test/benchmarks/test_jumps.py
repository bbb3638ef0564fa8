# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Jumps of the pose known online."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic_run import BEAMS_A_TURN, synthetic_run

from benchmarks.jumps import FAR, Jumps, first_far_closures, largest_jumps
from msss_graphslam.core.types import Constraint, ConstraintKind, Estimate, Trajectory

TURNS = 50


def closure(first: int, second: int, refusal: str = "") -> Constraint:
    return Constraint(ConstraintKind.LOOP, first, second, np.zeros(3), np.eye(3), refusal)


def jumping(after: dict[int, float], *closures: Constraint) -> Estimate:
    """Return a run whose online pose is dead reckoning, but for jumps after some keyframes."""
    estimate = synthetic_run(turns=TURNS).estimate
    poses = estimate.dead_reckoning.poses.copy()
    for keyframe, length in after.items():
        poses[(keyframe + 1) * BEAMS_A_TURN + 1 :, 1] += length
    online = Trajectory(estimate.dead_reckoning.stamps_ns, poses)
    return replace(estimate, online=online, constraints=tuple(closures))


def test_without_a_jump_there_is_none() -> None:
    assert largest_jumps(jumping({})).largest == pytest.approx(0.0, abs=1e-12)


def test_dead_reckoning_that_is_turned_does_not_jump() -> None:
    estimate = jumping({})
    poses = estimate.online.poses.copy()
    poses[:, :2] = poses[:, 1::-1] * [-1.0, 1.0]
    poses[:, 5] += 0.5 * np.pi
    turned = replace(estimate, online=Trajectory(estimate.online.stamps_ns, poses))
    assert largest_jumps(turned).largest == pytest.approx(0.0, abs=1e-12)


def test_the_largest_jump_counts() -> None:
    found = largest_jumps(jumping({4: 0.3, 9: -0.7}))
    assert (found.largest, found.plain) == pytest.approx((0.7, 0.7))
    assert found.turns == 10


def test_a_jump_at_a_first_far_closure_is_excused() -> None:
    estimate = jumping({25: 3.0, 30: 0.4}, closure(2, 25))
    found = largest_jumps(estimate)
    assert (found.largest, found.plain) == pytest.approx((3.0, 0.4))
    assert found.turns == 31


@pytest.mark.parametrize("keyframe", [24, 26])
def test_a_jump_beside_it_is_not(keyframe: int) -> None:
    estimate = jumping({keyframe: 3.0}, closure(2, 25))
    found = largest_jumps(estimate)
    assert (found.largest, found.plain) == pytest.approx((3.0, 3.0))


@pytest.mark.parametrize(
    ("closures", "expected"),
    [
        ([closure(0, FAR + 1)], [FAR + 1]),
        ([closure(0, FAR)], []),
        ([closure(0, 30, "shape_differs")], []),
        ([closure(1, 25), closure(0, 25), closure(2, 26), closure(3, 45)], [25]),
        ([closure(1, 25), closure(3, 25 + FAR)], [25]),
        ([closure(1, 25), closure(3, 26 + FAR)], [25, 26 + FAR]),
    ],
)
def test_which_far_closures_are_first(closures: list[Constraint], expected: list[int]) -> None:
    assert first_far_closures(jumping({}, *closures)).tolist() == expected


def test_a_run_of_one_beam_cannot_jump() -> None:
    estimate = jumping({})
    one = Trajectory(estimate.online.stamps_ns[:1], estimate.online.poses[:1])
    assert largest_jumps(replace(estimate, online=one)) == Jumps()
