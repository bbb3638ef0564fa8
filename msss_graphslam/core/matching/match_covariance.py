# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The covariance of a point-to-line match.

Four things keep the inverse Hessian from being it: normals are noisy, which looks like structure
along a bare wall, and tilts the wall; neighbouring residuals have errors in common; the motion
within a scan is wrong for all its points together, which no number of points averages out; and the
first guess has a share in the answer, which is no measurement of it.
"""

# Deviation: not in the paper, whose spIC has the covariance of independent points.

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.matching.line_features import NEIGHBOURS
from msss_graphslam.core.matching.robust_weights import LEAST_SCALE, robust_size
from msss_graphslam.core.types import Array

__all__ = ["WIDEST", "MatchedPairs", "match_covariance", "match_information"]

WIDEST = 1e4
"""Variance [m^2, rad^2] that stands for a direction of which the scans say nothing."""

SURE = 3.0
"""Structure counts where it exceeds that of bare walls by so many standard deviations of it."""

LEAST_LEFT = 0.5
"""With fewer pairs than take half of what they have in common, the residuals say no more of it."""


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
    """Return the covariance (3, 3) of where both ways fit best; see ``match_information``."""
    return match_information(forward, backward).covariance


@dataclass(frozen=True, slots=True)
class MatchInformation:
    """What both scans say of the pose beside the first guess.

    ``hessian`` (3, 3) is what the alignment has weighed the pairs with, by their stated
    deviations; ``information`` (3, 3) what they say in truth; ``pull`` (3, 6) is what units of
    both twist errors add to the gradient; ``prior`` (3, 3) the information of the guess.
    """

    hessian: Array
    information: Array
    pull: Array
    prior: Array

    @property
    def covariance(self) -> Array:
        """The covariance (3, 3) of the pose as ``freed``."""
        noise = np.linalg.inv(self.information + np.eye(3) / WIDEST)
        drag = -self._answer() @ self.pull
        return np.asarray(0.5 * (noise + noise.T) + drag @ drag.T)

    def freed(self, shift: Array) -> Array:
        """Return how far (3,) the scans lie from the guess, aligned at ``shift`` (3,) from it.

        In the alignment the guess weighs what the points' stated deviations give it. The points of
        a whole wall are better than that, and would hand back the guess as if they had seen it;
        along a bare wall they seem to see what is their noise.
        """
        return np.asarray(self._answer() @ (self.hessian + self.prior) @ shift)

    def _answer(self) -> Array:
        """Return what turns a gradient into a shift: as the pairs ask, held as the guess is."""
        asked = np.linalg.inv(self.hessian + np.eye(3) / WIDEST)
        return np.asarray(np.linalg.solve(self.information + self.prior, self.information @ asked))


def match_information(forward: MatchedPairs, backward: MatchedPairs) -> MatchInformation:
    """Return what both ways say together.

    Both ways have the same noise, each scan being the points once: together they say what one
    says.
    """
    there, here = _summed(forward), _summed(backward)
    found = 0.5 * (there.found + here.found)
    pretended = 0.5 * (there.pretended + here.pretended)
    count = 0.5 * (len(forward.residuals) + len(backward.residuals))
    structure = _structure(found, pretended, count)
    variance = 0.5 * (there.variance + here.variance)
    # Along a bare wall noisy normals take for a distance to it what the guess leaves open.
    doubtful = np.linalg.inv(structure / variance + forward.prior)
    variance += NEIGHBOURS * float(np.trace(pretended @ doubtful)) / count
    return MatchInformation(
        hessian=0.5 * (there.hessian + here.hessian),
        information=structure / variance,
        # The scan that moves the one way is the lines of the other.
        pull=0.5 * (there.pull + here.pull[:, [3, 4, 5, 0, 1, 2]]),
        prior=forward.prior,
    )


@dataclass(frozen=True, slots=True)
class _Sums:
    """What the pairs of one way come to.

    ``hessian`` (3, 3) is the information of the lines' normals, ``found`` (3, 3) the mean of it
    and that of the points' normals, ``pretended`` (3, 3) the part that is noise: what both scans'
    normals differ by. ``pull`` (3, 6) is what units of both twist errors add to the gradient,
    ``variance`` that of a normalised residual times how many of them say the same.
    """

    hessian: Array
    found: Array
    pretended: Array
    pull: Array
    variance: float


def _summed(pairs: MatchedPairs) -> _Sums:
    rows = np.hstack([pairs.jacobian, pairs.twin, pairs.slips])
    products = (rows[:, :6].T * pairs.weights) @ rows
    hessian, twin, mixed = products[:3, :3], products[3:, 3:6], products[:3, 3:6]
    scale = max(robust_size(pairs.residuals), LEAST_SCALE)
    return _Sums(
        hessian=hessian,
        found=0.5 * (hessian + twin),
        pretended=0.5 * (hessian + twin - mixed - mixed.T),
        pull=products[:3, 6:],
        variance=scale**2 * _repetition(pairs, hessian + pairs.prior),
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


def _repetition(pairs: MatchedPairs, hessian: Array) -> float:
    """Return how many neighbouring errors say the same: the sum of their autocorrelation.

    A point is part of NEIGHBOURS lines, and lies in several beams' width. What errors have in
    common in the directions of the pose is what the fit has taken for motion: the residuals have
    lost the share ``taken`` of what they would say the same.
    """
    errors = pairs.weights * pairs.residuals
    rows = pairs.jacobian * np.sqrt(pairs.weights)[:, None]
    square = float(errors @ errors)
    if square == 0.0:
        return 1.0
    common = _common_to_neighbours(np.column_stack([errors, rows]))
    together = float(common[0, 0]) / square
    taken = float(np.trace(np.linalg.solve(hessian, common[1:, 1:]))) / len(errors)
    return max(together / max(1.0 - taken, LEAST_LEFT), 1.0)


def _common_to_neighbours(columns: Array) -> Array:
    """Return the products (k, k) of columns (n, k) at all lags up to NEIGHBOURS, summed.

    Bartlett's window weighs them: that of all sums over NEIGHBOURS + 1 rows with themselves.
    """
    window = np.ones(NEIGHBOURS + 1)
    sums = np.array([np.convolve(column, window) for column in columns.T])
    return np.asarray(sums @ sums.T) / len(window)
