# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Trajectory correction, Section VII: the poses between two optimised keyframes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.compounding import between, wrap
from msss_graphslam.core.types import Array

__all__ = [
    "Correction",
    "Solver",
    "closed_form",
    "compose_corrected",
    "correct",
    "correct_motion",
    "nelder_mead",
]

Solver = Callable[[Array, Array], Array]

SMALLEST_MEAN_RESULTANT = 0.1


@dataclass(frozen=True, slots=True)
class Correction:
    """The corrected poses (n, 3) in the frame of the reference keyframe, and delta X (3,)."""

    poses: Array
    delta: Array


def correct(relative_odometry: Array, target: Array, solver: Solver) -> Correction:
    """Make the dead reckoning of one scan end where the optimised keyframes say.

    Parameters
    ----------
    relative_odometry
        X_O (n, 3): the motion from each beam to the next, the last one to the first beam of the
        next scan [m, m, rad]; n > 0.
    target
        X_ref^cur (3,): the next keyframe in the frame of the reference keyframe.
    solver
        ``nelder_mead`` as in the paper, or ``closed_form``.
    """
    delta = solver(relative_odometry, target)
    poses = compose_corrected(relative_odometry, delta)
    # Deviation: what a solver leaves open (its tolerance, or a motion that (14) cannot meet with
    # small corrections) is spread evenly, so that the trajectory has no step at the keyframe.
    rest = target - poses[-1]
    rest[2] = wrap(rest[2])
    poses += np.linspace(0.0, 1.0, len(poses) + 1)[1:, None] * rest
    poses[:, 2] = wrap(poses[:, 2])
    return Correction(poses, delta)


def correct_motion(motion: Array, end: Array, target: Array, solver: Solver) -> Correction:
    """Correct the poses of a scan's beams so that the next keyframe is met.

    ``motion`` (b, 3) are the dead-reckoned poses in the frame of the first, ``end`` (3,) that of
    the next keyframe; ``target`` (3,) is where the optimised graph has it. Returns the corrected
    motion (b, 3), the first pose being the origin as before.
    """
    reckoned = np.vstack([motion, end])
    correction = correct(between(reckoned[:-1], reckoned[1:]), target, solver)
    return Correction(np.vstack([np.zeros(3), correction.poses[:-1]]), correction.delta)


def compose_corrected(relative_odometry: Array, delta: Array) -> Array:
    """Return every partial composition (n, 3) of f(delta X) in equation 14; the last is f."""
    yaw = np.cumsum(relative_odometry[:, 2] + delta[2])
    steps = _complex(relative_odometry) + np.exp(1j * relative_odometry[:, 2]) * _complex(delta)
    position = np.cumsum(np.exp(1j * _before(yaw)) * steps)
    return np.stack([position.real, position.imag, wrap(yaw)], axis=-1)


def nelder_mead(relative_odometry: Array, target: Array) -> Array:
    """Return the delta X (3,) that minimises g, equation 15, by the method of Nelder and Mead."""
    # It holds 45 MiB that the other solver does without.
    from scipy.optimize import minimize

    def cost(delta: Array) -> float:
        error = compose_corrected(relative_odometry, delta)[-1] - target
        error[2] = wrap(error[2])
        return float(error @ error)

    count = len(relative_odometry)
    simplex = np.vstack([np.zeros(3), np.eye(3) / count])
    found = minimize(
        cost,
        simplex[0],
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "xatol": 1e-6 / count, "fatol": 1e-12},
    )
    return np.asarray(found.x)


def closed_form(relative_odometry: Array, target: Array) -> Array:
    """Return the delta X (3,) that solves equation 14 exactly.

    The headings add up, so each takes an equal share of the misclosure; the positions are then
    linear in the translation of delta X. With x + i y as one complex number that is one division.
    The translation is 0 where the headings turn so far that equal shares would cancel out.
    """
    count = len(relative_odometry)
    turn = float(wrap(target[2] - np.sum(relative_odometry[:, 2]))) / count
    end = compose_corrected(relative_odometry, np.array([0.0, 0.0, turn]))[-1]
    yaw = np.cumsum(relative_odometry[:, 2] + turn)
    resultant = np.sum(np.exp(1j * (_before(yaw) + relative_odometry[:, 2])))
    if abs(resultant) < SMALLEST_MEAN_RESULTANT * count:
        return np.array([0.0, 0.0, turn])
    share = _complex(target - end) / resultant
    return np.array([share.real, share.imag, turn])


def _complex(poses: Array) -> NDArray[np.complex128]:
    return np.asarray(poses[..., 0] + 1j * poses[..., 1])


def _before(yaw: Array) -> Array:
    return np.concatenate([[0.0], yaw[:-1]])
