# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Point-to-line scan matching, forwards and backwards.

A. Censi, An ICP variant using a point-to-line metric, ICRA 2008; robust weights after Cauchy.
"""

# Deviation: takes the place of the paper's spIC in the estimator ``full``. A point of a slow scan
# has no twin in the next one; pairing points drags the result towards no motion, pairing a point
# with the line through its neighbours does not.

import math

import numpy as np

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import (
    inverse,
    inverse_jacobian,
    rotation,
    wrap,
    wrap_angle,
)
from msss_graphslam.core.matching.line_features import LineFeatures
from msss_graphslam.core.matching.match_covariance import WIDEST, MatchedPairs, match_covariance
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.types import Array

__all__ = ["match_lines"]

SAME_SIDE = 0.7
"""Smallest cosine between the normals of a pair: a wall has two sides and a corner two walls."""

CAUCHY = 2.0
"""Residual, in robust standard deviations, at which a pair's weight is halved."""

STEP, STEP_ANGLE = 5e-4, 1e-4
"""An iteration that moves less than this has converged [m], [rad]."""


def match_lines(
    reference: LineFeatures | None,
    current: LineFeatures | None,
    initial: Array,
    initial_covariance: Array,
    config: Matching,
    start: Array | None = None,
) -> MatchResult:
    """Align ``current`` with ``reference`` from the displacement ``initial`` (3,).

    Aligns both ways, each scan once being the lines: the two answers must agree, and their mean is
    the result. A direction in which the scans have no structure keeps ``initial`` and gets a wide
    covariance. ``initial_covariance`` (3, 3) sets how far off the pairs are looked for. The search
    begins at ``start`` (3,), where an earlier match of the same scans ended, if there is one.
    """
    if reference is None or current is None:
        return MatchResult(initial, initial_covariance, "too_few_points")
    start = initial if start is None else start
    forward = _Alignment(reference, current, initial, initial_covariance, config, start)
    turned = inverse_jacobian(initial)
    backward = _Alignment(
        current,
        reference,
        inverse(initial),
        turned @ initial_covariance @ turned.T,
        config,
        inverse(start),
    )
    backward_pose = inverse(backward.pose)
    difference = backward_pose - forward.pose
    difference[2] = wrap(difference[2])
    pose = forward.pose + 0.5 * difference
    covariance = _covariance(forward, backward)
    observed = _observed(difference, covariance, config)
    figures = {
        "overlap": min(forward.overlap, backward.overlap),
        "residual": max(forward.scale, backward.scale),
        "disagreement_m": float(np.hypot(*observed[:2])),
        "disagreement_rad": float(abs(observed[2])),
        "shift": _shift(initial, pose, initial_covariance),
    }
    return MatchResult(pose, covariance, _refusal(figures, config), figures)


class _Alignment:
    """Point-to-line ICP of one scan on the lines of another."""

    def __init__(
        self,
        lines: LineFeatures,
        moving: LineFeatures,
        initial: Array,
        initial_covariance: Array,
        config: Matching,
        start: Array,
    ) -> None:
        self._lines = lines
        self._supported = (2.0 * lines.reach) ** 2
        self._points = moving.points[moving.flat]
        self._normals = moving.normals[moving.flat]
        self._covariances = moving.covariances[moving.flat]
        self._initial = initial
        self._prior = np.asarray(np.linalg.inv(initial_covariance))
        self.pose = np.array(start, dtype=float)
        self.overlap = 0.0
        self.scale = 1.0
        self._slips = moving.slips[moving.flat]
        self._last: tuple[Array, Array, Array] | None = None
        reach = 3.0 * float(np.sqrt(np.linalg.eigvalsh(initial_covariance[:2, :2])[-1]))
        gate = max(config.pairing_distance, reach)
        for _ in range(config.iterations):
            step = self._iterate(gate)
            narrow = gate <= config.pairing_distance
            gate = max(config.pairing_distance, 0.7 * gate)
            if narrow and math.hypot(*step[:2]) < STEP and abs(step[2]) < STEP_ANGLE:
                break

    def _iterate(self, gate: float) -> Array:
        lines = self._lines
        turn = rotation(self.pose[2])
        levers = self._points @ turn.T
        points = levers + self.pose[:2]
        found = lines.tree.query(points)
        distances, nearest = np.asarray(found[0]), np.asarray(found[1])
        normals = lines.normals.take(nearest, axis=0)
        offsets = points - lines.centres.take(nearest, axis=0)
        residuals = _dot(normals, offsets)
        paired = np.flatnonzero(
            (distances < gate)
            & lines.flat.take(nearest)
            & (_dot(normals, self._normals @ turn.T) > SAME_SIDE)
            & (_dot(offsets, offsets) - residuals**2 < self._supported.take(nearest))
        )
        self.overlap = len(paired) / max(len(self._points), 1)
        if len(paired) < 3:
            return np.zeros(3)
        normals = normals.take(paired, axis=0)
        along = normals @ turn
        covariances = self._covariances.take(paired, axis=0)
        spread = np.einsum("ni,nij,nj->n", along, covariances, along)
        deviations = np.sqrt(spread + lines.variances[nearest[paired]])
        self._paired, self._on, self._deviations = paired, nearest[paired], deviations
        return self._solve(
            normals, levers.take(paired, axis=0), residuals.take(paired), deviations
        )

    def _solve(self, normals: Array, levers: Array, residuals: Array, deviations: Array) -> Array:
        """One robust Gauss-Newton step, with the initial guess as a weak prior."""
        normalised = residuals / deviations
        self.scale = 1.4826 * _median(np.abs(normalised))
        width = CAUCHY * max(self.scale, 0.1)
        weights = 1.0 / (1.0 + (normalised / width) ** 2)
        jacobian = _by_pose(normals, levers) / deviations[:, None]
        weighted = jacobian.T * weights
        self._last = jacobian, normalised, weights
        error = self.pose - self._initial
        error[2] = wrap_angle(error[2])
        gradient = weighted @ normalised + self._prior @ error
        step = -np.linalg.solve(weighted @ jacobian + self._prior, gradient)
        self.pose = self.pose + step
        self.pose[2] = wrap_angle(self.pose[2])
        return np.asarray(step)

    def pairs(self) -> MatchedPairs | None:
        """Return the last step's pairs, None where there were too few."""
        if self._last is None:
            return None
        jacobian, residuals, weights = self._last
        turn, normals = rotation(self.pose[2]), self._lines.normals[self._on]
        own = self._normals[self._paired] @ turn.T
        twin = _by_pose(own, self._points[self._paired] @ turn.T) / self._deviations[:, None]
        moved = np.einsum("ni,nij->nj", normals @ turn, self._slips[self._paired])
        slid = np.einsum("ni,nij->nj", normals, self._lines.slips[self._on])
        slips = np.hstack([moved, -slid]) / self._deviations[:, None]
        return MatchedPairs(jacobian, twin, residuals, weights, slips, self._prior)


def _covariance(forward: _Alignment, backward: _Alignment) -> Array:
    """Return the covariance (3, 3) of the mean of both ways."""
    there, back = forward.pairs(), backward.pairs()
    if there is None or back is None:
        return WIDEST * np.eye(3)
    return match_covariance(there, back, inverse_jacobian(backward.pose))


def _by_pose(normals: Array, levers: Array) -> Array:
    """Return the derivatives (n, 3) of distances along normals by the pose."""
    across = normals[:, 1] * levers[:, 0] - normals[:, 0] * levers[:, 1]
    return np.column_stack([normals, across])


def _dot(first: Array, second: Array) -> Array:
    return np.asarray(np.einsum("ni,ni->n", first, second))


def _median(values: Array) -> float:
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle])


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
