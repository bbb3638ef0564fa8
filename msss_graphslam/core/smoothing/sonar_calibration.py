# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the sonar and the velocity sensor measure the same motion: heading and scale."""

# Deviation: not in the paper. A head that is mounted askew turns the whole map, a wrong speed of
# sound scales it, and all scans still agree. Only a measured velocity says otherwise. Which of
# the two sensors is wrong it does not say: so the result is told, and nothing is changed by it.

import numpy as np

from msss_graphslam.core.compounding import between
from msss_graphslam.core.smoothing.normal_equations import NormalEquations
from msss_graphslam.core.smoothing.twist_chain import TwistChain
from msss_graphslam.core.types import Array, SonarCalibration

__all__ = ["OBSERVED", "sonar_calibration", "velocities_of"]

OBSERVED = np.array([0.02, np.radians(1.0)])
"""Scale and heading [rad] that are less well known than this are not observed: so well one knows
the speed of sound and mounts a head anyway. What is assumed of the motion never says as much."""


def sonar_calibration(
    chain: TwistChain,
    equations: NormalEquations,
    twists: Array,
    by_keyframes: Array,
    velocities: Array,
) -> SonarCalibration | None:
    """Return by what the sonar's motion differs from dead reckoning's, where that is observable.

    ``equations`` are those of the solution, ``twists`` (n, 3) and ``by_keyframes`` (n, 3, 6) the
    scans' twist errors there, ``velocities`` (n, 2) the bodies' mean velocities [m/s]. To first
    order the twist error of a scan is minus the velocity, scaled and turned.
    """
    common = chain.common(twists, by_keyframes, _basis(velocities))
    solved = equations.solved(common.cross)
    information = common.information - common.cross.T @ solved
    gradient = common.gradient - solved.T @ equations.gradient
    covariance = np.linalg.pinv(information, hermitian=True)
    variances = np.diag(covariance)
    if not ((variances > 0.0) & (variances < OBSERVED**2)).all():
        return None
    scale, yaw = (-covariance @ gradient).tolist()
    return SonarCalibration(yaw, 1.0 + scale, np.asarray(covariance[::-1, ::-1]))


def velocities_of(states: Array, durations: Array) -> Array:
    """Return the mean velocities (n, 2) of the body on arcs between the states (n + 1, 3).

    ``durations`` (n,) [s].
    """
    motion = between(states[:-1], states[1:])
    half = 0.5 * motion[:, 2]
    chord = np.exp(-1j * half) * (motion[:, 0] + 1j * motion[:, 1])
    velocity = chord / (np.sinc(half / np.pi) * durations)
    return np.column_stack([velocity.real, velocity.imag])


def _basis(velocities: Array) -> Array:
    """Return what scale and yaw add (n, 3, 2) to a twist that is free of the sonar's errors."""
    along, across = velocities.T
    basis = np.zeros((len(velocities), 3, 2))
    basis[:, :2, 0] = velocities
    basis[:, 0, 1], basis[:, 1, 1] = -across, along
    return basis
