# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Kinematics of roll, pitch, yaw: the blocks of the paper's J(X) and their derivatives.

T. I. Fossen, Guidance and Control of Ocean Vehicles, 1994, chapter 2; angles in rad, z-y-x order.
Dead reckoning asks for them with every sample of the IMU: they take and give plain numbers.
"""

from collections.abc import Sequence
from math import cos, sin, tan

import numpy as np

from msss_graphslam.core.types import Array

__all__ = [
    "Matrix",
    "Vector",
    "level",
    "rate_derivatives",
    "rate_matrix",
    "rotation_derivatives",
    "rotation_matrix",
    "times",
]

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
"""Three rows."""


def times(matrix: Matrix, vector: Sequence[float]) -> Vector:
    """Return the product of a matrix and a vector of three."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    x, y, z = vector
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def rotation_matrix(angles: Sequence[float]) -> Matrix:
    """Return the body-to-world rotation: the upper left block of J(X), equation 6."""
    roll, pitch, yaw = angles
    cr, sr = cos(roll), sin(roll)
    cp, sp = cos(pitch), sin(pitch)
    cy, sy = cos(yaw), sin(yaw)
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sr * sy * sp + cy * cr, sy * sp * cr - sr * cy),
        (-sp, cp * sr, cp * cr),
    )


def rotation_derivatives(rotation: Matrix, yaw: float, vector: Vector) -> Matrix:
    """Return d(rotation_matrix(angles) vector)/d(angles).

    Turning about an axis moves the turned vector by its cross product with that axis: roll's is
    the body's x, pitch's the y axis turned by ``yaw`` [rad], yaw's the world's z.
    """
    x, y, z = times(rotation, vector)
    _, sway, heave = vector
    about_roll = times(rotation, (0.0, -heave, sway))
    cy, sy = cos(yaw), sin(yaw)
    return (
        (about_roll[0], cy * z, -y),
        (about_roll[1], sy * z, x),
        (about_roll[2], -sy * y - cy * x, 0.0),
    )


def rate_matrix(angles: Sequence[float]) -> Matrix:
    """Return body rates to angle rates: the lower right block of J(X), equation 6."""
    roll, pitch, _ = angles
    cr, sr, tp, cp = cos(roll), sin(roll), tan(pitch), cos(pitch)
    return (1.0, sr * tp, cr * tp), (0.0, cr, -sr), (0.0, sr / cp, cr / cp)


def rate_derivatives(angles: Sequence[float], rates: Sequence[float]) -> Matrix:
    """Return d(rate_matrix(angles) rates)/d(angles)."""
    roll, pitch, _ = angles
    cr, sr, tp, cp = cos(roll), sin(roll), tan(pitch), cos(pitch)
    _, q, r = rates
    along, across = cr * q - sr * r, sr * q + cr * r
    return (
        (along * tp, across / cp**2, 0.0),
        (-across, 0.0, 0.0),
        (along / cp, across * tp / cp, 0.0),
    )


def level(roll: Array, pitch: Array, points: Array) -> Array:
    """Return body points (n, 3) in the levelled frame of the same yaw; one roll, pitch a point."""
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    lowered = sr * y + cr * z
    return np.column_stack([cp * x + sp * lowered, cr * y - sr * z, -sp * x + cp * lowered])
