# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Lines of least squares through the points about each point: a compiled loop."""

import math

import numpy as np

from msss_graphslam.core.compiled import compiled
from msss_graphslam.core.matching.nearest_points import neighbours
from msss_graphslam.core.matching.plane_vectors import Numbers, Vectors
from msss_graphslam.core.types import Array

__all__ = ["local_lines"]


@compiled
def local_lines(points: Vectors, count: int) -> Array:
    """Return the line through the ``count`` points nearest to each of n that ascend in x.

    In columns (8, n): the centre, the normal towards the origin, the standard deviations along the
    normal and along the line, the distances of the nearest other point and of the farthest of them
    [m].
    """
    found = np.empty((8, len(points)))
    near, squares = np.empty(count, np.int64), np.empty(count)
    for own in range(len(points)):
        neighbours(points, own, near, squares)
        centre = _mean(points, near)
        thickness, length, normal = _axes(points, near, centre)
        if (normal.conjugate() * centre).real > 0.0:
            normal = -normal
        found[0, own], found[1, own] = centre.real, centre.imag
        found[2, own], found[3, own] = normal.real, normal.imag
        found[4, own], found[5, own] = thickness, length
        found[6, own], found[7, own] = math.sqrt(squares[1]), math.sqrt(squares[count - 1])
    return found


@compiled
def _mean(points: Vectors, numbers: Numbers) -> complex:
    total = 0j
    for number in numbers:
        total += points[number]
    return total / len(numbers)


@compiled
def _axes(points: Vectors, numbers: Numbers, centre: complex) -> tuple[float, float, complex]:
    """Return the standard deviations across and along the line, and its normal."""
    xx = yy = xy = 0.0
    for number in numbers:
        off = points[number] - centre
        xx += off.real * off.real
        yy += off.imag * off.imag
        xy += off.real * off.imag
    middle, half, mixed = 0.5 * (xx + yy), 0.5 * (xx - yy), xy
    angle, radius = 0.5 * math.atan2(mixed, half), math.hypot(half, mixed)
    thickness = math.sqrt(max(middle - radius, 0.0) / len(numbers))
    length = math.sqrt((middle + radius) / len(numbers))
    return thickness, length, complex(-math.sin(angle), math.cos(angle))
