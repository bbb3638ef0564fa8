# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The compiled loops of matching: nearest points, lines through them, points on lines.

Points ascend in x here: from a place a search goes both ways along x until that alone is too far.
Among the hundreds of points of a scan this takes a tenth of a tree's time, even without the time
that the tree is built in.
"""

import math

import numpy as np

from msss_graphslam.core.compiled import compiled
from msss_graphslam.core.matching.line_features import FlatPoints, Lines
from msss_graphslam.core.matching.plane_vectors import Numbers, Vectors
from msss_graphslam.core.types import Array

__all__ = ["local_lines", "nearest", "nearest_of_each", "neighbours", "paired_points"]


@compiled
def nearest(points: Vectors, place: complex, gate: float) -> int:
    """Return the number of the point nearest to a place, -1 if it is not nearer than ``gate``."""
    low, high = 0, len(points)
    while low < high:
        middle = (low + high) // 2
        if points[middle].real < place.real:
            low = middle + 1
        else:
            high = middle
    found, least = -1, gate * gate
    for direction in (1, -1):
        number = low if direction == 1 else low - 1
        while 0 <= number < len(points):
            off = points[number] - place
            if off.real * off.real >= least:
                break
            square = off.real * off.real + off.imag * off.imag
            if square < least:
                found, least = number, square
            number += direction
    return found


@compiled
def nearest_of_each(points: Vectors, places: Vectors, gate: float) -> Numbers:
    """Return ``nearest`` for each of the places (k,)."""
    found = np.empty(len(places), np.int64)
    for number in range(len(places)):
        found[number] = nearest(points, places[number], gate)
    return found


@compiled
def neighbours(points: Vectors, own: int, numbers: Numbers, squares: Array) -> None:
    """Write the numbers (k,) of the points nearest to one of them, itself first.

    ``squares`` (k,) become the squares of their distances, ascending.
    """
    last = len(numbers) - 1
    for place in range(last + 1):
        squares[place] = math.inf
    for direction in (1, -1):
        number = own if direction == 1 else own - 1
        while 0 <= number < len(points):
            off = points[number] - points[own]
            if off.real * off.real >= squares[last]:
                break
            square = off.real * off.real + off.imag * off.imag
            if square < squares[last]:
                place = last
                while place > 0 and squares[place - 1] > square:
                    squares[place], numbers[place] = squares[place - 1], numbers[place - 1]
                    place -= 1
                squares[place], numbers[place] = square, number
            number += direction


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


@compiled
def paired_points(
    points: FlatPoints,
    lines: Lines,
    turn: complex,
    shift: complex,
    gate: float,
    same_side: float,
    backwards: bool,
) -> tuple[Array, Numbers, Numbers]:
    """Pair points with the lines of the points nearest to them, nearer than ``gate`` [m].

    The cosine between their normals is more than ``same_side``.

    ``turn`` and ``shift`` take the points into the lines' frame. Forwards they are the sought
    displacement; ``backwards``, where the points are the reference scan's, they undo it. Of k
    pairs, in the order of the points: (5, k) of the derivatives of the normalised residuals by the
    displacement, of these themselves and of what normalises them; then the numbers of points and
    of lines.
    """
    rows = np.empty((5, len(points.places)))
    chosen, on = np.empty(len(points.places), np.int64), np.empty(len(points.places), np.int64)
    count = 0
    for number in range(len(points.places)):
        seen = turn * points.places[number] + shift
        line = nearest(lines.places, seen, gate)
        if line < 0:
            continue
        across = lines.across[line]
        own = across * turn
        offset = across * (seen - lines.centres[line])
        alike = (own * points.normals[number]).real > same_side
        if not alike or abs(offset.imag) >= lines.supported[line]:
            continue
        variance = points.mean[number] + (points.deviator[number] * own * own).real
        inverse = 1.0 / math.sqrt(variance + lines.variances[line])
        # Backwards a step moves the points the other way, in a turned frame.
        moved, lever = (-own, -seen) if backwards else (across, seen - shift)
        rows[0, count] = inverse * moved.real
        rows[1, count] = -inverse * moved.imag
        rows[2, count] = -inverse * (across * lever).imag
        rows[3, count] = inverse * offset.real
        rows[4, count] = inverse
        chosen[count], on[count] = number, line
        count += 1
    return rows[:, :count], chosen[:count], on[:count]
