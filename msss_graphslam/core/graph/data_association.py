# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Algorithm 3: which earlier scans the current one may close a loop with."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.config.groups import Association
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.matching.shape_matching import shape_distance
from msss_graphslam.core.types import Array

__all__ = ["Candidate", "associate", "squared_mahalanobis"]

SMALLEST_EIGENVALUE = 1e-9


@dataclass(frozen=True, slots=True)
class Candidate:
    """An earlier keyframe near enough to be the same place, and why it is not matched, if so.

    ``mahalanobis`` is D_M of (11), ``shape_distance`` D_S of (13), None where it does not count.
    """

    index: int
    mahalanobis: float
    shape_distance: float | None = None
    refusal: str = ""

    @property
    def accepted(self) -> bool:
        """Whether the pair goes on to scan matching."""
        return not self.refusal


def associate(
    poses: Array,
    covariances: Array,
    descriptors: Sequence[Array],
    current_pose: Array,
    current_covariance: Array,
    current_descriptor: Array,
    config: Association,
) -> list[Candidate]:
    """Return the keyframes inside the Mahalanobis gate, in order; Algorithm 3.

    Those whose shape differs are among them, refused as ``shape_differs``. The newest keyframe
    has its own, consecutive constraint and is left out.

    The Mahalanobis distance costs next to nothing and shape matching grows with every candidate,
    so shapes are compared inside the gate only: the accepted ones are the same as when both are
    computed for all.

    Parameters
    ----------
    poses, covariances, descriptors
        (n, 3), (n, 3, 3) and n shape descriptors of all earlier keyframes, oldest first.
    current_pose, current_covariance, current_descriptor
        (3,), (3, 3) and the shape descriptor of the current scan.
    config
        The thresholds Mt and St; both distances must lie below them.
    """
    distances = squared_mahalanobis(poses[:-1], covariances[:-1], current_pose, current_covariance)
    candidates: list[Candidate] = []
    for index in map(int, np.flatnonzero(distances < config.mahalanobis_threshold)):
        shape = shape_distance(descriptors[index], current_descriptor)
        refusal = "" if shape < config.shape_threshold else "shape_differs"
        candidates.append(Candidate(index, float(distances[index]), shape, refusal))
    return candidates


def squared_mahalanobis(poses: Array, covariances: Array, pose: Array, covariance: Array) -> Array:
    """Return D_M of (11), without a root, between each of (n, 3) poses and one pose; (n,).

    The covariances (n, 3, 3) and (3, 3) are averaged, the difference of headings is wrapped.
    Where the average is not positive definite or anything is not finite the distance is infinite.
    """
    difference = poses - pose
    difference[:, 2] = wrap(difference[:, 2])
    average = 0.5 * (covariances + covariance)
    usable = np.isfinite(difference).all(axis=1) & _positive_definite(average)
    distances = np.full(len(poses), np.inf)
    solved = np.linalg.solve(average[usable], difference[usable, :, None])[..., 0]
    distances[usable] = np.sum(difference[usable] * solved, axis=1)
    return distances


def _positive_definite(covariances: Array) -> NDArray[np.bool_]:
    """Tell which (n, 3, 3) can be inverted, judged on correlations so that units do not matter."""
    variances = np.diagonal(covariances, axis1=1, axis2=2)
    finite = np.isfinite(covariances).all(axis=(1, 2))
    usable = np.asarray(finite & (variances > 0.0).all(axis=1))
    deviations = np.sqrt(variances[usable])
    correlations = covariances[usable] / (deviations[:, :, None] * deviations[:, None, :])
    usable[usable] = np.linalg.eigvalsh(correlations)[:, 0] > SMALLEST_EIGENVALUE
    return usable
