# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Compounding and inversion of planar poses, with Jacobians.

R. Smith, M. Self and P. Cheeseman, Estimating uncertain spatial relationships in robotics, 1990
(the paper's [26]). A pose is (x, y, yaw) in m and rad; every function takes (..., 3) arrays and
broadcasts over the leading axes. Angles come out in (-pi, pi].
"""

import math

import numpy as np

from msss_graphslam.core.types import Array

__all__ = [
    "between",
    "between_covariance",
    "between_jacobians",
    "carried_over",
    "compose",
    "compose_covariance",
    "compose_jacobians",
    "inverse",
    "inverse_jacobian",
    "planar_rotation",
    "rotation",
    "transform_points",
    "wrap",
    "wrap_angle",
]

_PLANAR = [0, 1, 5]


def wrap(angle: Array | float) -> Array:
    """Return the angle(s) [rad] in (-pi, pi]."""
    return np.pi - np.mod(np.pi - np.asarray(angle, dtype=float), 2.0 * np.pi)


def wrap_angle(angle: float) -> float:
    """Return one angle [rad] in (-pi, pi]: ``wrap`` without the cost of an array."""
    return math.pi - (math.pi - angle) % (2.0 * math.pi)


def rotation(yaw: Array | float) -> Array:
    """Return the rotation matrices (..., 2, 2) of the yaw angle(s) [rad]."""
    yaw = np.asarray(yaw, dtype=float)
    matrix = np.empty((*yaw.shape, 2, 2))
    matrix[..., 0, 0] = matrix[..., 1, 1] = np.cos(yaw)
    matrix[..., 1, 0] = np.sin(yaw)
    matrix[..., 0, 1] = -matrix[..., 1, 0]
    return matrix


def planar_rotation(yaw: float) -> Array:
    """Return the matrix (3, 3) that turns x and y by the yaw angle [rad] and leaves yaw alone."""
    turn = np.eye(3)
    turn[:2, :2] = rotation(yaw)
    return turn


def compose(first: Array, second: Array) -> Array:
    """Return first (+) second: ``second`` is given in the frame of ``first``."""
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    cosine, sine = np.cos(first[..., 2]), np.sin(first[..., 2])
    pose = np.empty(np.broadcast_shapes(first.shape, second.shape))
    pose[..., 0] = first[..., 0] + cosine * second[..., 0] - sine * second[..., 1]
    pose[..., 1] = first[..., 1] + sine * second[..., 0] + cosine * second[..., 1]
    pose[..., 2] = wrap(first[..., 2] + second[..., 2])
    return pose


def inverse(pose: Array) -> Array:
    """Return (-) pose: the origin's pose in the frame of ``pose``."""
    pose = np.asarray(pose, dtype=float)
    cosine, sine = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    inverted = np.empty(pose.shape)
    inverted[..., 0] = -cosine * pose[..., 0] - sine * pose[..., 1]
    inverted[..., 1] = sine * pose[..., 0] - cosine * pose[..., 1]
    inverted[..., 2] = wrap(-pose[..., 2])
    return inverted


def between(first: Array, second: Array) -> Array:
    """Return (-) first (+) second: the pose of ``second`` in the frame of ``first``."""
    return compose(inverse(first), second)


def compose_jacobians(first: Array, second: Array) -> tuple[Array, Array]:
    """Return J1(+) and J2(+) (..., 3, 3): the derivatives of compose by each argument."""
    first, second = np.broadcast_arrays(np.asarray(first, float), np.asarray(second, float))
    cosine, sine = np.cos(first[..., 2]), np.sin(first[..., 2])
    by_first = np.zeros((*first.shape[:-1], 3, 3))
    by_first[..., range(3), range(3)] = 1.0
    by_first[..., 0, 2] = -sine * second[..., 0] - cosine * second[..., 1]
    by_first[..., 1, 2] = cosine * second[..., 0] - sine * second[..., 1]
    by_second = np.zeros_like(by_first)
    by_second[..., :2, :2] = rotation(first[..., 2])
    by_second[..., 2, 2] = 1.0
    return by_first, by_second


def inverse_jacobian(pose: Array) -> Array:
    """Return J(-) (..., 3, 3): the derivative of inverse."""
    pose = np.asarray(pose, dtype=float)
    inverted = inverse(pose)
    jacobian = np.zeros((*pose.shape[:-1], 3, 3))
    jacobian[..., :2, :2] = -rotation(-pose[..., 2])
    jacobian[..., 0, 2] = inverted[..., 1]
    jacobian[..., 1, 2] = -inverted[..., 0]
    jacobian[..., 2, 2] = -1.0
    return jacobian


def between_jacobians(first: Array, second: Array) -> tuple[Array, Array]:
    """Return the derivatives (..., 3, 3) of ``between`` by each argument."""
    by_inverse, by_second = compose_jacobians(inverse(first), second)
    return by_inverse @ inverse_jacobian(first), by_second


def compose_covariance(
    first: Array, first_covariance: Array, second: Array, second_covariance: Array
) -> Array:
    """Return the covariance (..., 3, 3) of compose(first, second) for independent poses."""
    by_first, by_second = compose_jacobians(first, second)
    return _led_through(first_covariance, by_first) + _led_through(second_covariance, by_second)


def between_covariance(
    first: Array, first_covariance: Array, second: Array, second_covariance: Array
) -> Array:
    """Return the covariance (3, 3) of between(first, second) for independent poses.

    Algorithm 4, lines 4 and 10.
    """
    by_first, by_second = between_jacobians(first, second)
    return _led_through(first_covariance, by_first) + _led_through(second_covariance, by_second)


def carried_over(corrected: Array, reckoned: Array) -> Array:
    """Return the pose(s) (..., 6) of ``odom`` in ``map`` that carry ``reckoned`` to ``corrected``.

    Both are (..., 6) poses x, y, z, roll, pitch, yaw; dead reckoning's roll and pitch hold in
    either frame.
    """
    placed = np.zeros(corrected.shape)
    placed[..., _PLANAR] = compose(corrected[..., _PLANAR], inverse(reckoned[..., _PLANAR]))
    placed[..., 2] = corrected[..., 2] - reckoned[..., 2]
    return placed


def transform_points(pose: Array, points: Array) -> Array:
    """Return pose (+) points for points (n, 2) [m] and one pose (3,) or one a point (n, 3)."""
    pose = np.asarray(pose, dtype=float)
    cosine, sine = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    x = pose[..., 0] + cosine * points[..., 0] - sine * points[..., 1]
    y = pose[..., 1] + sine * points[..., 0] + cosine * points[..., 1]
    return np.stack([x, y], axis=-1)


def _led_through(covariance: Array, jacobian: Array) -> Array:
    return np.asarray(jacobian @ covariance @ np.swapaxes(jacobian, -1, -2))
