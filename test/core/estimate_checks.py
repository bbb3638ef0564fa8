# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What every estimate has to be, and when two of them are the same."""

import numpy as np

from msss_graphslam.core.types import (
    Constraint,
    Estimate,
)


def assert_sound(estimate: Estimate, beams: int) -> None:
    """Every number is finite, every trajectory has its beams in order."""
    for trajectory in (estimate.trajectory, estimate.online, estimate.dead_reckoning):
        assert np.isfinite(trajectory.poses).all()
        assert trajectory.poses.shape == (len(trajectory.stamps_ns), 6)
        assert (np.diff(trajectory.stamps_ns) >= 0).all()
        assert (np.abs(trajectory.poses[:, 3:]) <= np.pi).all()
    assert len(estimate.trajectory.stamps_ns) == len(estimate.dead_reckoning.stamps_ns) == beams
    assert len(estimate.keyframes) == len(estimate.first_scans)
    for keyframe in estimate.keyframes:
        scan = keyframe.scan
        for values in (keyframe.pose, scan.motion, scan.points, scan.covariances):
            assert np.isfinite(values).all()
        assert np.linalg.eigvalsh(keyframe.covariance)[0] > 0.0
    for constraint in estimate.constraints:
        assert np.isfinite(constraint.relative_pose).all()
        assert np.isfinite(constraint.covariance).all()


def same_constraint(first: Constraint, second: Constraint) -> bool:
    return (
        (first.kind, first.first, first.second, first.refusal, first.figures)
        == (second.kind, second.first, second.second, second.refusal, second.figures)
        and first.relative_pose.tobytes() == second.relative_pose.tobytes()
        and first.covariance.tobytes() == second.covariance.tobytes()
    )


def assert_same_bytes(first: Estimate, second: Estimate) -> None:
    for name in ("trajectory", "online", "dead_reckoning"):
        one, other = getattr(first, name), getattr(second, name)
        assert one.stamps_ns.tobytes() == other.stamps_ns.tobytes()
        assert one.poses.tobytes() == other.poses.tobytes()
    assert len(first.constraints) == len(second.constraints)
    assert all(map(same_constraint, first.constraints, second.constraints))
