# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What makes a constraint unfit for any pose graph."""

# The smoother takes such constraints without a word, or with them breaks what it has.

import numpy as np

from msss_graphslam.core.types import Constraint

__all__ = ["defect"]

ROUNDED, ROUNDING = 1e-15, 1e-6
"""Entries of a covariance that differ by so much, or by such a share, are the same but rounded."""


def defect(constraint: Constraint, keyframes: int) -> str:
    """Say why a constraint may not enter a graph of so many keyframes, or return ''."""
    if not 0 <= constraint.first < keyframes or not 0 <= constraint.second < keyframes:
        return "unknown_keyframe"
    if constraint.first == constraint.second:
        return "joins_a_keyframe_to_itself"
    covariance = constraint.covariance
    if not (np.isfinite(constraint.relative_pose).all() and np.isfinite(covariance).all()):
        return "not_finite"
    if (np.abs(covariance - covariance.T) > ROUNDED + ROUNDING * np.abs(covariance)).any():
        return "covariance_not_symmetric"
    if np.linalg.eigvalsh(covariance)[0] <= 0.0:
        return "covariance_not_positive_definite"
    return ""
