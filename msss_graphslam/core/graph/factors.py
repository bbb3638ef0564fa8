# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Constraints as gtsam's factors: the terms of equation 4."""

from collections import Counter
from collections.abc import Sequence

import gtsam
import numpy as np

from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.compounding import planar_rotation
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["LAUNCH_VARIANCE", "between_factor", "launch_prior", "shares", "turned"]

LAUNCH_VARIANCE = 1e-12
"""The first pose defines the map; its prior only holds the gauge [m^2, rad^2]."""


def launch_prior(pose: Array) -> gtsam.PriorFactorPose2:
    """Return what holds keyframe 0 at its ``pose`` (3,)."""
    noise = gtsam.noiseModel.Isotropic.Variance(3, LAUNCH_VARIANCE)
    return gtsam.PriorFactorPose2(0, gtsam.Pose2(*pose), noise)


def between_factor(
    constraint: Constraint, config: BackEndConfig, share: float = 1.0
) -> gtsam.BetweenFactorPose2:
    """Return a constraint as a factor of equation 4; it counts as a ``share`` of itself."""
    covariance = turned(constraint.covariance, -float(constraint.relative_pose[2])) / share
    noise: gtsam.noiseModel.Base = gtsam.noiseModel.Gaussian.Covariance(covariance)
    if constraint.kind is ConstraintKind.LOOP and config.robust_width > 0.0:
        kernel = gtsam.noiseModel.mEstimator.Cauchy.Create(config.robust_width)
        noise = gtsam.noiseModel.Robust.Create(kernel, noise)
    relative = gtsam.Pose2(*constraint.relative_pose)
    return gtsam.BetweenFactorPose2(constraint.first, constraint.second, relative, noise)


def shares(constraints: Sequence[Constraint]) -> list[float]:
    """Return what each constraint counts: matches of one scan have its errors in common.

    Above all that of the motion within it. A match errs by both its scans alike: of the variance
    of n matches' mean, the newest scan's half stays, and the others' half becomes one n-th.
    """
    matched = [edge.kind is not ConstraintKind.ODOMETRY for edge in constraints]
    often = Counter(
        edge.second for edge, matches in zip(constraints, matched, strict=True) if matches
    )
    return [
        2.0 / (1.0 + often[edge.second]) if matches else 1.0
        for edge, matches in zip(constraints, matched, strict=True)
    ]


def turned(covariance: Array, yaw: float) -> Array:
    """Return a pose's covariance in axes turned by -yaw; gtsam's are those of the pose itself."""
    turn = planar_rotation(yaw)
    return np.asarray(turn @ covariance @ turn.T)
