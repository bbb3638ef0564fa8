# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The rectangle that fits the first returns of a head in a tank, whose heading may swing.

The timhw vehicle floats: the picture that its head sees repeats after 190 to 208 beams instead of
200, so it yaws by up to 20 degrees within a turn. The heading is a polygon with one knot a second.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from msss_graphslam.core.types import Array

_WIDTH = 0.05
_YAW_STEP = 0.05


@dataclass(frozen=True)
class RectangleFit:
    """Expected ranges (n,) [m], and the cosines (n,) of the incidence; ``walls`` (4,) [m]."""

    walls: Array
    expected: Array
    cosines: Array

    def on_wall(self, ranges: Array, tolerance: float) -> Array:
        return np.abs(ranges - self.expected) < tolerance

    def along_normal(self, ranges: Array) -> Array:
        return (ranges - self.expected) * self.cosines


def expected_ranges(walls: Array, azimuths: Array) -> tuple[Array, Array]:
    """Ranges and incidence cosines to walls at +x, -x, +y, -y of the head."""
    directions = np.stack([np.cos(azimuths), -np.cos(azimuths)])
    directions = np.concatenate([directions, np.stack([np.sin(azimuths), -np.sin(azimuths)])])
    with np.errstate(divide="ignore"):
        ranges = np.where(directions > 0.0, np.abs(walls)[:, None] / directions, np.inf)
    nearest = ranges.argmin(axis=0)
    columns = np.arange(azimuths.size)
    return ranges[nearest, columns], directions[nearest, columns]


def fit_rectangle(bearings: Array, ranges: Array, knots: int) -> RectangleFit:
    """Fit four walls and a swinging heading to the ranges; NaN where there is no return."""
    seen = np.isfinite(ranges)
    beams = np.arange(bearings.size)
    places = np.linspace(0.0, bearings.size - 1.0, knots)

    def model(parameters: Array) -> tuple[Array, Array]:
        yaw = np.interp(beams, places, parameters[4:])
        return expected_ranges(parameters[:4], bearings - yaw)

    def residuals(parameters: Array) -> Array:
        expected, cosines = model(parameters)
        across = ((ranges - expected) * cosines)[seen] / _WIDTH
        swing = np.diff(parameters[4:]) / _YAW_STEP
        return np.concatenate([np.sqrt(np.log1p(across**2)), 0.4 * swing])

    rough = np.array([2.2, 1.0, 4.0, 0.2])
    starts = [
        np.concatenate([walls, np.full(knots, yaw)])
        for walls in (rough, rough[[0, 1, 3, 2]])
        for yaw in np.linspace(-np.pi, np.pi, 8, endpoint=False)
    ]
    start = min(starts, key=lambda parameters: np.sum(residuals(parameters) ** 2))
    best = least_squares(residuals, start).x
    return RectangleFit(best[:4], *model(best))
