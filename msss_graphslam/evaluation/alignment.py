# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The rigid motion that fits one set of positions best to another."""

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["align"]


def align(positions: Array, reference: Array) -> Array:
    """Return the positions (n, 2) [m] rotated and shifted to the least squared distance.

    S. Umeyama, Least-squares estimation of transformation parameters between two point patterns,
    1991, without scale: scale is an error that the sonar can make and that must stay visible.
    """
    centre, target = positions.mean(axis=0), reference.mean(axis=0)
    left, _, right = np.linalg.svd((reference - target).T @ (positions - centre))
    mirrored = np.linalg.det(left) * np.linalg.det(right) < 0.0
    rotation = left @ np.diag([1.0, -1.0 if mirrored else 1.0]) @ right
    return np.asarray((positions - centre) @ rotation.T + target)
