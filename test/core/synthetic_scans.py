# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scans of polygons as an ideal, instantaneous sonar would make them, with its noise."""

import numpy as np

from msss_graphslam.core.compounding import rotation
from msss_graphslam.core.types import Array

RANGE_NOISE = 0.05
BEARING_NOISE = 0.013


def basin(rng: np.random.Generator, radius: float = 9.0) -> list[Array]:
    """An irregular basin with an irregular island in its middle."""
    return [_ring(rng, 24, radius, 0.25), _ring(rng, 8, radius / 6.0, 0.3)]


def corridor() -> list[Array]:
    """Two walls 6 m apart, far longer than the sonar sees."""
    return [np.array([[-300.0, -3.0], [300.0, -3.0], [300.0, 3.0], [-300.0, 3.0]])]


def scan(
    walls: list[Array], pose: Array, rng: np.random.Generator, outliers: float = 0.03
) -> tuple[Array, Array]:
    """Points (n, 2) and covariances (n, 2, 2) of 240 beams from ``pose``; 30 m range."""
    bearings = np.linspace(-np.pi, np.pi, 240, endpoint=False)
    ranges = _cast(walls, pose, bearings + rng.normal(0.0, BEARING_NOISE, 240))
    ranges += rng.normal(0.0, RANGE_NOISE, 240)
    ranges = np.where(rng.random(240) < outliers, rng.uniform(1.0, 20.0, 240), ranges)
    seen = (ranges > 0.3) & (ranges < 30.0)
    bearings, ranges = bearings[seen], ranges[seen]
    points = ranges[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    return points, _covariances(bearings, ranges)


def _covariances(bearings: Array, ranges: Array) -> Array:
    variances = np.column_stack([np.full_like(ranges, RANGE_NOISE), BEARING_NOISE * ranges]) ** 2
    turn = rotation(bearings)
    return turn * variances[:, None, :] @ np.swapaxes(turn, 1, 2)


def _ring(rng: np.random.Generator, corners: int, radius: float, roughness: float) -> Array:
    angles = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
    angles = angles + rng.uniform(-0.08, 0.08, corners)
    radii = radius * (1.0 + roughness * rng.uniform(-1.0, 1.0, corners))
    return np.column_stack([1.5 * radii * np.cos(angles), radii * np.sin(angles)])


def _cast(walls: list[Array], pose: Array, bearings: Array) -> Array:
    """Distance (n,) along each bearing to the nearest wall."""
    starts = np.concatenate(walls) - pose[:2]
    sides = np.concatenate([np.roll(wall, -1, axis=0) for wall in walls]) - pose[:2] - starts
    directions = np.column_stack([np.cos(pose[2] + bearings), np.sin(pose[2] + bearings)])[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        denominator = _cross(directions, sides)
        along_ray = _cross(starts, sides) / denominator
        along_side = _cross(starts, directions) / denominator
    hit = (along_ray > 0.0) & (along_side >= 0.0) & (along_side <= 1.0)
    return np.where(hit, along_ray, np.inf).min(axis=1)


def _cross(first: Array, second: Array) -> Array:
    return first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
