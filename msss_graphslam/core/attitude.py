# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Kinematics of roll, pitch, yaw: the blocks of the paper's J(X) and their derivatives.

T. I. Fossen, Guidance and Control of Ocean Vehicles, 1994, chapter 2; angles in rad, z-y-x order.
"""

import math

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["level", "rate_derivatives", "rate_matrix", "rotation_derivatives", "rotation_matrix"]


def rotation_matrix(angles: Array) -> Array:
    """Return the body-to-world rotation (3, 3): the upper left block of J(X), equation 6."""
    roll, pitch, yaw = angles.tolist()
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sr * sy * sp + cy * cr, sy * sp * cr - sr * cy],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rotation_derivatives(rotation: Array, yaw: float, vector: Array) -> Array:
    """Return d(rotation_matrix(angles) @ vector)/d(angles), (3, 3).

    Turning about an axis moves the turned vector by its cross product with that axis: roll's is
    the body's x, pitch's the y axis turned by ``yaw`` [rad], yaw's the world's z.
    """
    x, y, z = (rotation @ vector).tolist()
    _, sway, heave = vector.tolist()
    about_roll = (rotation @ np.array([0.0, -heave, sway])).tolist()
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [about_roll[0], cy * z, -y],
            [about_roll[1], sy * z, x],
            [about_roll[2], -sy * y - cy * x, 0.0],
        ]
    )


def rate_matrix(angles: Array) -> Array:
    """Return body rates to angle rates (3, 3): the lower right block of J(X), equation 6."""
    roll, pitch, _ = angles.tolist()
    cr, sr, tp, cp = math.cos(roll), math.sin(roll), math.tan(pitch), math.cos(pitch)
    return np.array([[1.0, sr * tp, cr * tp], [0.0, cr, -sr], [0.0, sr / cp, cr / cp]])


def rate_derivatives(angles: Array, rates: Array) -> Array:
    """Return d(rate_matrix @ rates)/d(angles), (3, 3)."""
    roll, pitch, _ = angles.tolist()
    cr, sr, tp, cp = math.cos(roll), math.sin(roll), math.tan(pitch), math.cos(pitch)
    _, q, r = rates.tolist()
    along, across = cr * q - sr * r, sr * q + cr * r
    return np.array(
        [
            [along * tp, across / cp**2, 0.0],
            [-across, 0.0, 0.0],
            [along / cp, across * tp / cp, 0.0],
        ]
    )


def level(roll: Array, pitch: Array, points: Array) -> Array:
    """Return body points (n, 3) in the levelled frame of the same yaw; one roll, pitch a point."""
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    lowered = sr * y + cr * z
    return np.column_stack([cp * x + sp * lowered, cr * y - sr * z, -sp * x + cp * lowered])
