# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The covariance of a point-to-line match.

Three things keep the inverse Hessian from being it: normals are noisy, and their scatter looks
like structure along a bare wall; neighbouring residuals have errors in common; and the motion
within a scan is wrong for all its points together, which no number of points averages out.
"""

# Deviation: not in the paper, whose spIC has the covariance of independent points.

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.matching.line_features import NEIGHBOURS
from msss_graphslam.core.types import Array

__all__ = ["WIDEST", "MatchedPairs", "match_covariance"]

WIDEST = 1e4
"""Variance [m^2, rad^2] that stands for a direction of which the scans say nothing."""

LEAST_SCALE = 0.1
"""Residuals smaller than this share of their stated deviations are luck."""

SURE = 2.0
"""Structure counts where it exceeds that of bare walls by so many standard deviations of it."""


@dataclass(frozen=True, slots=True)
class MatchedPairs:
    """Pairs of points and lines in the order of the points' beams, at the match.

    ``jacobian`` (n, 3) of the normalised ``residuals`` (n,) by the pose, with the lines' normals;
    ``twin`` (n, 3) the same with the points' own normals. ``weights`` (n,) are the robust ones;
    ``slips`` (n, 6) what the residuals change by a unit of the twist error of the points' scan
    (3) and of the lines' (3). ``prior`` (3, 3) is the information of the first guess.
    """

    jacobian: Array
    twin: Array
    residuals: Array
    weights: Array
    slips: Array
    prior: Array


def match_covariance(forward: MatchedPairs, backward: MatchedPairs) -> Array:
    """Return the covariance (3, 3) of the displacement that serves both ways.

    Both ways have the same noise, each scan being the points once: together they say what one
    says.
    """
    there, here = _summed(forward), _summed(backward)
    found = 0.5 * (there.found + here.found)
    pretended = 0.5 * (there.pretended + here.pretended)
    count = 0.5 * (len(forward.residuals) + len(backward.residuals))
    structure = _structure(found, pretended, count)
    variance = 0.5 * (there.variance + here.variance)
    noise = np.linalg.inv(structure / variance + np.eye(3) / WIDEST)
    # The scan that moves the one way is the lines of the other.
    drag = 0.5 * (there.drag + here.drag[:, [3, 4, 5, 0, 1, 2]])
    return np.asarray(0.5 * (noise + noise.T) + drag @ drag.T)


@dataclass(frozen=True, slots=True)
class _Sums:
    """What the pairs of one way come to.

    ``found`` (3, 3) is the mean information of the lines' and the points' normals, ``pretended``
    (3, 3) the part of it that is noise: what both scans' normals differ by. ``drag`` (3, 6) is how
    far units of both twist errors draw the pose along, ``variance`` that of a normalised residual
    times how many of them say the same.
    """

    found: Array
    pretended: Array
    drag: Array
    variance: float


def _summed(pairs: MatchedPairs) -> _Sums:
    rows = np.hstack([pairs.jacobian, pairs.twin, pairs.slips])
    products = (rows[:, :6].T * pairs.weights) @ rows
    hessian, twin, mixed = products[:3, :3], products[3:, 3:6], products[:3, 3:6]
    size = np.abs(pairs.residuals)
    scale = 1.4826 * float(np.partition(size, len(size) // 2)[len(size) // 2])
    return _Sums(
        found=0.5 * (hessian + twin),
        pretended=0.5 * (hessian + twin - mixed - mixed.T),
        drag=np.asarray(-np.linalg.solve(hessian + pairs.prior, products[:3, 6:])),
        variance=max(scale, LEAST_SCALE) ** 2 * _repetition(pairs.weights * pairs.residuals),
    )


def _structure(found: Array, pretended: Array, count: float) -> Array:
    """Return the information (3, 3) of the walls' true directions.

    Both scans' normals of a wall are noisy independently. What they differ by is noise, as much
    as it pretends to be structure; taken away, a bare wall has none along itself.
    """
    doubt = 1.0 + SURE * np.sqrt(2.0 * NEIGHBOURS / count)
    root = np.linalg.cholesky(found + np.eye(3) / WIDEST)
    share = np.linalg.solve(root, np.linalg.solve(root, found - doubt * pretended).T)
    values, vectors = np.linalg.eigh(0.5 * (share + share.T))
    kept = root @ vectors
    return np.asarray(kept * np.maximum(values, 0.0) @ kept.T)


def _repetition(errors: Array) -> float:
    """Return how many neighbouring errors (n,) say the same: the sum of their autocorrelation.

    A point is part of NEIGHBOURS lines, and lies in several beams' width.
    """
    square = float(errors @ errors)
    if square == 0.0:
        return 1.0
    together = 0.0
    for lag in range(1, min(NEIGHBOURS, len(errors) - 1) + 1):
        together += (1.0 - lag / (NEIGHBOURS + 1.0)) * float(errors[lag:] @ errors[:-lag])
    return max(1.0 + 2.0 * together / square, 1.0)
