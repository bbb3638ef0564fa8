# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The keyframes that a back end has, beside those of a front end."""

import numpy as np

from msss_graphslam.core.types import GraphPoses, Stamps

__all__ = ["first_of", "same_beginning"]


def first_of(known: GraphPoses, count: int) -> GraphPoses:
    """Return the first ``count`` keyframes."""
    return GraphPoses(
        known.stamps_ns[:count],
        known.poses[:count],
        known.odometry[:count],
        known.covariances[:count],
    )


def same_beginning(own: Stamps, known: Stamps) -> bool:
    """Return whether two graphs begin with the same keyframes, as far as both go."""
    both = min(len(own), len(known))
    return bool(np.array_equal(own[:both], known[:both]))
