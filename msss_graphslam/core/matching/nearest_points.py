# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The nearest of a scan's points: compiled searches among points that ascend in x.

From a place they go both ways along x until that alone is too far. Among the hundreds of points of
a scan this takes a tenth of a tree's time, its building not counted.
"""

import math

import numpy as np

from msss_graphslam.core.compiled import compiled
from msss_graphslam.core.matching.plane_vectors import Numbers, Vectors
from msss_graphslam.core.types import Array

__all__ = ["nearest", "nearest_of_each", "neighbours"]


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
