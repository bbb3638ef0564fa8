# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How the points of a scan move together when its motion is not what it was laid out by."""

import numpy as np

from msss_graphslam.core.scans.scan_generation import motion_derivatives
from msss_graphslam.core.types import Array, Scan

__all__ = ["point_slips"]

SHORTEST = 1e-6
"""A scan that takes no longer than this [s] has no motion in it."""


def point_slips(scan: Scan) -> Array:
    """Return the displacements (n, 2, 3) [m] of the points for each unit of the twist's error.

    The three units are independent standard deviations of the error that the scan's layout
    states: slips times their transpose are what the motion adds to the points' covariances, and
    what it adds to two points in common.
    """
    elapsed = scan.beam_times[:-1]
    if not len(scan.points) or elapsed[-1] <= SHORTEST:
        return np.zeros((len(scan.points), 2, 3))
    derivatives = motion_derivatives(scan.motion, elapsed)
    # A vehicle that spins round once comes back to where it was, whatever its speed.
    units = np.linalg.pinv(derivatives[-1]) @ _root(scan.motion_covariances[-1])
    slips = derivatives[scan.beam_index] @ units
    lever = scan.points - scan.motion[scan.beam_index, :2]
    turned = slips[:, 2, :]
    moved = slips[:, :2, :].copy()
    moved[:, 0] -= lever[:, 1, None] * turned
    moved[:, 1] += lever[:, 0, None] * turned
    return np.asarray(moved)


def _root(covariance: Array) -> Array:
    """Return a matrix (3, 3) whose square is the covariance, which may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
