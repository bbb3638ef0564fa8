# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Robust Gauss-Newton steps of points onto lines, both ways of two scans side by side."""

import math

import numpy as np

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import wrap_angle
from msss_graphslam.core.matching.both_ways import (
    StackedLines,
    StackedPoints,
    Vectors,
    along,
    vectors,
)
from msss_graphslam.core.matching.line_features import LineFeatures
from msss_graphslam.core.matching.match_covariance import MatchedPairs
from msss_graphslam.core.types import Array

__all__ = ["CAUCHY", "SAME_SIDE", "Alignment"]

SAME_SIDE = 0.7
"""Smallest cosine between the normals of a pair: a wall has two sides and a corner two walls."""

CAUCHY = 2.0
"""Residual, in robust standard deviations, at which a pair's weight is halved."""

STEP, STEP_ANGLE = 5e-4, 1e-4
"""An iteration that moves less than this has converged [m], [rad]."""

FEWEST = 3
"""Pairs of points and lines that say something of a displacement."""


class Alignment:
    """Point-to-line ICP of two scans, each on the other's lines.

    Row 0 of what has two is the way forwards, the ``current`` scan's points on the lines of
    ``reference``; row 1 the way backwards. Neither way knows of the other: they share the calls.
    ``poses`` (2, 3) are what they come to, ``overlaps`` and ``scales`` (2,) the share of points
    with a pair and the robust size of the normalised residuals.
    """

    def __init__(
        self,
        reference: LineFeatures,
        current: LineFeatures,
        initial: Array,
        covariances: Array,
        config: Matching,
        start: Array,
    ) -> None:
        self._lines = StackedLines.of(reference, current)
        self._points = StackedPoints.of(current, reference)
        self._initial, self._prior = initial, np.linalg.inv(covariances)
        self.poses = start.copy()
        self.overlaps, self.scales = np.zeros(2), np.ones(2)
        narrow = config.pairing_distance
        reaches = 3.0 * np.sqrt(np.linalg.eigvalsh(covariances[:, :2, :2])[:, -1])
        gates = np.maximum(narrow, reaches)
        for _ in range(config.iterations):
            steps = self._iterate(gates)
            if gates.max() <= narrow and _settled(steps):
                break
            gates = np.maximum(narrow, 0.7 * gates)

    def _iterate(self, gates: Array) -> Array:
        """Pair anew and step; return the steps (2, 3)."""
        points, lines = self._points, self._lines
        turns = np.exp(1j * self.poses[:, 2])[points.way]
        levers = turns * points.places
        seen = levers + vectors(self.poses)[points.way]
        on = lines.nearest(seen, points.second, gates)
        across = lines.across[on]
        offsets = across * (seen - lines.centres[on])
        alike = (across * turns * points.normals).real > SAME_SIDE
        paired = np.flatnonzero(alike & (np.abs(offsets.imag) < lines.supported[on]))
        self._paired, self._on = paired, on[paired]
        across = across[paired]
        variances = points.variances(paired, across * turns[paired]) + lines.variances[self._on]
        self._inverse_deviations = 1.0 / np.sqrt(variances)
        jacobian = _by_pose(across, levers[paired]) * self._inverse_deviations
        return self._solve(jacobian, offsets.real[paired] * self._inverse_deviations)

    def _solve(self, jacobian: Array, residuals: Array) -> Array:
        """Take one robust step each way, with the initial guess as a weak prior."""
        middle = int(np.searchsorted(self._paired, self._points.second))
        self._ways = slice(0, middle), slice(middle, len(residuals))
        counts = np.array([middle, len(residuals) - middle])
        self.overlaps = counts / np.maximum(self._points.counts, 1)
        size = np.abs(residuals)
        self._enough = counts >= FEWEST
        self.scales = np.array([_robust_size(size[way]) for way in self._ways])
        widths = (CAUCHY * np.maximum(self.scales, 0.1))[self._points.way[self._paired]]
        weights = 1.0 / (1.0 + (residuals / widths) ** 2)
        self._last = jacobian, residuals, weights
        weighted = jacobian * weights
        error = self.poses - self._initial
        error[:, 2] = [wrap_angle(angle) for angle in error[:, 2].tolist()]
        gradient = (self._prior @ error[:, :, None])[:, :, 0]
        hessian = self._prior.copy()
        for number, way in enumerate(self._ways):
            gradient[number] += weighted[:, way] @ residuals[way]
            hessian[number] += weighted[:, way] @ jacobian[:, way].T
        steps = -np.linalg.solve(hessian, gradient[:, :, None])[:, :, 0]
        steps[~self._enough] = 0.0
        self.poses = self.poses + steps
        self.poses[:, 2] = [wrap_angle(angle) for angle in self.poses[:, 2].tolist()]
        return np.asarray(steps)

    def pairs(self) -> tuple[MatchedPairs, MatchedPairs] | None:
        """Return the last step's pairs, None where there were too few either way."""
        if not self._enough.all():
            return None
        jacobian, residuals, weights = self._last
        points, paired = self._points, self._paired
        turns = np.exp(1j * self.poses[:, 2])[points.way[paired]]
        own = np.conj(turns * points.normals[paired])
        twin = _by_pose(own, turns * points.places[paired])
        across = self._lines.across[self._on]
        slips = np.hstack(
            [
                along(across * turns, points.slips[paired]),
                -along(across, self._lines.slips[self._on]),
            ]
        )
        twin, slips = twin * self._inverse_deviations, slips * self._inverse_deviations[:, None]
        forward, backward = (
            MatchedPairs(
                jacobian[:, way].T, twin[:, way].T, residuals[way], weights[way], slips[way], prior
            )
            for way, prior in zip(self._ways, self._prior, strict=True)
        )
        return forward, backward


def _by_pose(across: Vectors, levers: Vectors) -> Array:
    """Return the derivatives (3, n) of distances by the pose; ``across`` conjugated normals."""
    return np.array([across.real, -across.imag, -(across * levers).imag])


def _robust_size(sizes: Array) -> float:
    """Return the standard deviation that sizes of residuals speak of, 1 without any."""
    middle = len(sizes) // 2
    return 1.4826 * float(np.partition(sizes, middle)[middle]) if len(sizes) else 1.0


def _settled(steps: Array) -> bool:
    return all(math.hypot(x, y) < STEP and abs(yaw) < STEP_ANGLE for x, y, yaw in steps.tolist())
