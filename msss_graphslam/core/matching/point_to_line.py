# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Point-to-line scan matching, forwards and backwards.

A. Censi, An ICP variant using a point-to-line metric, ICRA 2008; robust weights after Cauchy.
"""

# Deviation: takes the place of the paper's spIC in the estimator ``full``. A point of a slow scan
# has no twin in the next one; pairing points drags the result towards no motion, pairing a point
# with the line through its neighbours does not.

import numpy as np

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.matching.alignment import Alignment
from msss_graphslam.core.matching.line_features import LineFeatures
from msss_graphslam.core.matching.match_covariance import WIDEST, match_information
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.types import Array

__all__ = ["match_lines"]

DOUBT = 2.0
"""A guess's variances may be so many times what it says: a vehicle that turns into a current
changes its speed in steps, and a match refused for it leaves the pose to dead reckoning."""


def match_lines(
    reference: LineFeatures | None,
    current: LineFeatures | None,
    initial: Array,
    initial_covariance: Array,
    config: Matching,
    start: Array | None = None,
) -> MatchResult:
    """Align ``current`` with ``reference`` from the displacement ``initial`` (3,).

    Aligns both ways, each scan once being the lines: the two answers must agree, and the result is
    where all pairs of both ways fit best. A direction in which the scans have no structure keeps
    ``initial`` and gets a wide covariance. ``initial_covariance`` (3, 3) sets how far off the
    pairs are looked for. The search begins at ``start`` (3,), where an earlier match of the same
    scans ended, if there is one.
    """
    if reference is None or current is None:
        return MatchResult(initial, initial_covariance, "too_few_points")
    start = initial if start is None else start
    alignment = Alignment(reference, current, initial, initial_covariance, config, start)
    difference = alignment.apart[1] - alignment.apart[0]
    difference[2] = wrap(difference[2])
    pose = alignment.pose
    freed, covariance = _freed(alignment, initial)
    observed = _observed(difference, covariance, config)
    figures = {
        "overlap": float(alignment.overlaps.min()),
        "residual": float(alignment.scales.max()),
        "disagreement_m": float(np.hypot(*observed[:2])),
        "disagreement_rad": float(abs(observed[2])),
        "shift": _shift(initial, pose, DOUBT * initial_covariance),
    }
    return MatchResult(freed, covariance, _refusal(figures, config), figures)


def _freed(alignment: Alignment, initial: Array) -> tuple[Array, Array]:
    """Return what the scans say of the pose (3,) beside the first guess, and its covariance."""
    pairs = alignment.pairs()
    if pairs is None:
        return alignment.pose, WIDEST * np.eye(3)
    said = match_information(*pairs)
    shift = alignment.pose - initial
    shift[2] = wrap(shift[2])
    freed = initial + said.freed(shift)
    freed[2] = wrap(freed[2])
    return freed, said.covariance


def _observed(difference: Array, covariance: Array, config: Matching) -> Array:
    """Return the part of a difference that is not along directions the scans say nothing of."""
    limits = np.diag(
        [config.disagreement**2, config.disagreement**2, config.disagreement_angle**2]
    )
    return np.asarray(limits @ np.linalg.solve(limits + covariance, difference))


def _shift(initial: Array, pose: Array, covariance: Array) -> float:
    """Return the squared Mahalanobis distance of the result from the initial guess."""
    error = pose - initial
    error[2] = wrap(error[2])
    return float(error @ np.linalg.solve(covariance, error))


def _refusal(figures: dict[str, float], config: Matching) -> str:
    if figures["overlap"] < config.overlap:
        return "too_little_overlap"
    if (
        figures["disagreement_m"] > config.disagreement
        or figures["disagreement_rad"] > config.disagreement_angle
    ):
        return "forward_and_backward_disagree"
    if figures["shift"] > config.shift:
        return "too_far_from_the_guess"
    return ""
