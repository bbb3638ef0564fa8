# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Constraints and poses that the back end refuses, and what is left of the graph then."""

from dataclasses import replace

import numpy as np
import pytest
from noisy_graphs import LEAST_SQUARES, START, assert_same_poses, edge, fed, loop, ring

from msss_graphslam.core.compounding import compose
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.graph.constraint_defects import defect
from msss_graphslam.core.types import Constraint

VALID = edge(0, 1, np.array([1.0, 0.0, 0.0]))
ASYMMETRIC = np.diag([1e-3, 1e-3, 1e-3])
ASYMMETRIC[0, 1] = 1e-4


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({}, ""),
        ({"first": -1}, "unknown_keyframe"),
        ({"second": 2}, "unknown_keyframe"),
        ({"first": 1}, "joins_a_keyframe_to_itself"),
        ({"relative_pose": np.array([np.nan, 0.0, 0.0])}, "not_finite"),
        ({"relative_pose": np.array([0.0, np.inf, 0.0])}, "not_finite"),
        ({"covariance": np.diag([np.nan, 1.0, 1.0])}, "not_finite"),
        ({"covariance": ASYMMETRIC}, "covariance_not_symmetric"),
        ({"covariance": np.diag([1.0, 1.0, 0.0])}, "covariance_not_positive_definite"),
        ({"covariance": np.diag([1.0, 1.0, -1e-9])}, "covariance_not_positive_definite"),
        ({"covariance": np.diag([1.0, 1.0, 1e-9])}, ""),
        ({"covariance": np.diag([1e-3] * 3) + 1e-12 * ASYMMETRIC}, ""),
    ],
)
def test_every_defect_has_its_reason(changes: dict[str, object], reason: str) -> None:
    assert defect(replace(VALID, **changes), keyframes=2) == reason


@pytest.mark.parametrize(
    "bad",
    [
        edge(0, 1, np.array([np.nan, 0.0, 0.0])),
        edge(0, 0, np.zeros(3)),
        edge(0, 4, np.zeros(3)),
        edge(3, 1, np.zeros(3)),
        edge(3, 3, np.zeros(3)),
        edge(0, 2, np.zeros(3), np.zeros((3, 3))),
    ],
)
@pytest.mark.parametrize("good_before", [False, True])
def test_a_refused_update_leaves_the_graph_as_it_was(bad: Constraint, good_before: bool) -> None:
    """Three keyframes; a constraint to keyframe 3 would bring it, 4 would leave a hole."""
    steps = [[edge(k, k + 1, np.array([1.0, 0.0, 0.5]))] for k in range(2)]
    back_end = fed(steps)
    poses, constraints = back_end.poses(), list(back_end.constraints)
    good = [loop(0, 2, np.array([2.5, 0.4, 1.2]))] if good_before else []
    with pytest.raises(ValueError, match=f"{bad.first} -> {bad.second}: "):
        back_end.update([*good, bad])
    assert back_end.constraints == constraints
    np.testing.assert_array_equal(back_end.poses(), poses)
    new = edge(2, 3, np.array([1.0, 0.0, 0.5]))
    after = back_end.update([new])
    np.testing.assert_allclose(after[3], compose(poses[2], new.relative_pose), atol=1e-6)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_pose_that_is_not_finite_is_refused(value: float) -> None:
    back_end = fed([])
    with pytest.raises(ValueError, match="keyframe 1 is not finite"):
        back_end.add_keyframe(np.array([0.0, value, 0.0]))
    assert len(back_end.poses()) == 1


def test_the_smoother_is_made_anew_after_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    truth, steps = ring(7)
    undisturbed, back_end = fed(steps), fed(steps[:6])

    class Broken:
        def update(self, *_: object) -> None:
            raise RuntimeError("indeterminate linear system")

        def calculateEstimatePose2(self, node: int) -> object:  # noqa: N802
            return healthy.calculateEstimatePose2(node)

    healthy = back_end._isam
    monkeypatch.setattr(back_end, "_isam", Broken())
    for new in steps[6:]:
        back_end.update(new)
    assert_same_poses(back_end.poses(), undisturbed.poses(), 1e-3)
    assert len(truth) == len(back_end.poses())


def test_what_was_refused_is_not_taken() -> None:
    back_end, relative = BackEnd(LEAST_SQUARES), np.array([1.0, 0.0, 0.1])
    back_end.take(START, [])
    wrong = replace(loop(0, 1, np.array([9.0, 9.0, 1.0])), refusal="too_little_overlap")
    accepted = edge(0, 1, relative)
    poses, _ = back_end.take(START, [wrong, accepted])
    assert_same_poses(poses, np.vstack([START, compose(START, relative)]), 1e-9)
    assert back_end.constraints == [accepted]
