# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The points of one scan on the lines of another: a compiled loop."""

import math

import numpy as np

from msss_graphslam.core.compiled import compiled
from msss_graphslam.core.matching.line_features import FlatPoints, Lines
from msss_graphslam.core.matching.nearest_points import nearest
from msss_graphslam.core.matching.paired_lines import SAME_SIDE
from msss_graphslam.core.matching.plane_vectors import Numbers
from msss_graphslam.core.types import Array

__all__ = ["paired_points"]


@compiled
def paired_points(
    points: FlatPoints, lines: Lines, turn: complex, shift: complex, gate: float, backwards: bool
) -> tuple[Array, Numbers, Numbers]:
    """Pair points with the lines of the points nearest to them, nearer than ``gate`` [m].

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
        alike = (own * points.normals[number]).real > SAME_SIDE
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
