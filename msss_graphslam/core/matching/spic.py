# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scan matching by spIC, the probabilistic iterative correspondence for sonar (Section VI, [30]).

The method is pIC of L. Montesano, J. Minguez and L. Montano, Probabilistic scan matching for
motion estimation in unstructured environments, IROS 2005.
"""

from functools import cache

import numpy as np

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.matching.correspondence import Pairs, Points, correspondences
from msss_graphslam.core.matching.line_features import line_features
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.types import Array

__all__ = ["match"]

FEWEST_POINTS = 10
"""Points of a scan, and pairs of two scans, below which no displacement is sought."""

SECTORS = 24
"""Parts of a scan whose errors count as independent."""

LARGEST_VARIANCE = 1e4
"""Variance of a displacement [m^2, rad^2] above which the scans say nothing of it."""


def match(
    reference_points: Array,
    reference_covariances: Array,
    current_points: Array,
    current_covariances: Array,
    initial: Array,
    initial_covariance: Array,
    config: Matching,
) -> MatchResult:
    """Align the current scan with the reference scan; spIC() of Algorithm 4.

    Parameters
    ----------
    reference_points, reference_covariances, current_points, current_covariances
        (n, 2) [m] and (n, 2, 2) [m^2] of the two scans, each in its own frame.
    initial, initial_covariance
        First guess (3,) of the current scan's frame in the reference scan's, and its covariance.
    config
        Gates and limits.

    Returns
    -------
    MatchResult
        Refused as ``too_few_points``, ``too_few_pairs``, ``degenerate_geometry``,
        ``not_converged``, ``too_little_overlap`` or ``too_far_from_the_guess``. The overlap is
        the share of current points that agree with their partners within the noise of both.
    """
    reference = Points(reference_points, reference_covariances)
    current = Points(current_points, current_covariances)
    if min(len(reference_points), len(current_points)) < FEWEST_POINTS:
        return MatchResult(initial, initial_covariance, "too_few_points")
    try:
        return _iterate(reference, current, initial, initial_covariance, config)
    except np.linalg.LinAlgError:
        return MatchResult(initial, initial_covariance, "degenerate_geometry")


def _iterate(
    reference: Points,
    current: Points,
    initial: Array,
    initial_covariance: Array,
    config: Matching,
) -> MatchResult:
    gate = _quantile(config.compatibility)
    pose = np.array(initial, dtype=float)
    iteration, converged = 0, False
    while iteration < config.iterations and not converged:
        iteration += 1
        pairs = correspondences(reference, current, pose, initial_covariance, gate)
        if len(pairs.errors) < FEWEST_POINTS:
            return MatchResult(initial, initial_covariance, "too_few_pairs")
        step = _gauss_newton_step(pairs)
        pose = pose + step
        pose[2] = wrap(pose[2])
        converged = (
            np.hypot(step[0], step[1]) < config.smallest_step
            and abs(step[2]) < config.smallest_turn
        )
    covariance = _covariance(pairs, reference)
    squared = np.einsum("ni,nij,nj->n", pairs.errors, pairs.weights, pairs.errors)
    figures = {
        "iterations": float(iteration),
        "overlap": float(np.sum(squared <= gate) / len(current.places)),
        "residual": float(np.sqrt(np.median(squared) / _quantile(0.5))),
        "mean_error_m": float(np.hypot(*pairs.errors.T).mean()),
        "shift": _shift(pose, initial, covariance + initial_covariance),
    }
    refusal = _refusal(figures, converged, covariance, config)
    return MatchResult(pose, covariance, refusal, figures)


@cache
def _quantile(probability: float) -> float:
    """Return the quantile of the chi-square distribution with two degrees of freedom."""
    # Other estimators are spared the 25 MiB that it holds.
    from scipy.special import chdtri

    return float(chdtri(2, 1.0 - probability))


def _gauss_newton_step(pairs: Pairs) -> Array:
    """Return the step (3,) that minimises the weighted squared errors."""
    weighted = np.swapaxes(pairs.jacobians, 1, 2) @ pairs.weights
    information = (weighted @ pairs.jacobians).sum(axis=0)
    return np.linalg.solve(information, (weighted @ pairs.errors[..., None]).sum(axis=0)[:, 0])


def _covariance(pairs: Pairs, reference: Points) -> Array:
    """Return the covariance (3, 3) of the displacement where the steps have died out.

    Steps die out where s = sum J' W e is zero. Its covariance B is estimated from the parts that
    sectors of the scan have in the sum, since errors of neighbouring points are alike; and A, its
    derivative by the displacement, gives inv(A) B inv(A)': the robust covariance of an estimator
    (P. Huber, 1967; in clusters K.-Y. Liang and S. Zeger, 1986).
    """
    # Deviation: the inverse of the normal matrix takes pairs for the same point seen twice. They
    # are samples of one surface: moved along it, a point finds another partner and its error does
    # not change. A therefore counts errors along the normal only, which leaves the length of a
    # corridor uncertain, as it is.
    lines = line_features(reference.places, reference.covariances)
    normals = lines.normals[pairs.reference] if lines else np.zeros_like(pairs.errors)
    weighted = np.swapaxes(pairs.jacobians, 1, 2) @ pairs.weights
    terms = (weighted @ pairs.errors[..., None])[..., 0]
    across = normals[:, :, None] * (normals[:, None, :] @ pairs.jacobians)
    inverse = np.linalg.inv((weighted @ across).sum(axis=0))
    sectors = min(SECTORS, len(terms))
    parts = np.add.reduceat(terms, np.arange(sectors) * len(terms) // sectors, axis=0)
    covariance = inverse @ (parts.T @ parts) @ inverse.T * sectors / (sectors - 1)
    return np.asarray(0.5 * (covariance + covariance.T))


def _refusal(
    figures: dict[str, float], converged: bool, covariance: Array, config: Matching
) -> str:
    variances = np.linalg.eigvalsh(covariance)
    if not (variances[0] > 0.0 and variances[-1] < LARGEST_VARIANCE):
        return "degenerate_geometry"
    if not converged:
        return "not_converged"
    if figures["overlap"] < config.overlap:
        return "too_little_overlap"
    if not figures["shift"] <= config.shift:
        return "too_far_from_the_guess"
    return ""


def _shift(pose: Array, initial: Array, covariance: Array) -> float:
    difference = pose - initial
    difference[2] = wrap(difference[2])
    return float(difference @ np.linalg.solve(covariance, difference))
