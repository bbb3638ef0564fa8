# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Covariances of single poses from the sparse information of all, without the whole inverse.

In a Bayes tree (M. Kaess et al., IJRR 31, 2012) a clique depends on the one above it alone: from
the root down, the covariance of each follows from that of its parent.
"""

from typing import Any

import gtsam
import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["pose_covariances"]


def pose_covariances(information: Any) -> Array:
    """Return the covariances (n, 3, 3) of n poses.

    ``information`` (3 n, 3 n) is a sparse matrix of SciPy's, symmetric. Raises RuntimeError where
    it leaves a pose undetermined.
    """
    covariances = np.full((information.shape[0] // 3, 3, 3), np.nan)
    nowhere: dict[int, int] = {}
    pending = [(root, nowhere, np.empty((0, 0))) for root in _bayes_tree(information).roots()]
    while pending:
        clique, places_above, above = pending.pop()
        conditional = clique.conditional()
        keys, own = conditional.keys(), len(conditional.R()) // 3
        shared = [places_above[key] for key in keys[own:]]
        joint = _joint(conditional.R(), conditional.S(), _chosen(above, shared))
        for place, key in enumerate(keys[:own]):
            covariances[key] = _chosen(joint, [place])
        places = {key: place for place, key in enumerate(keys)}
        pending += [(clique[child], places, joint) for child in range(clique.nrChildren())]
    if not np.isfinite(covariances).all():
        raise RuntimeError("a pose is in no measurement")
    return covariances


def _bayes_tree(information: Any) -> gtsam.GaussianBayesTree:
    blocks = information.tobsr((3, 3))
    graph, none, zero = gtsam.GaussianFactorGraph(), np.zeros((3, 3)), np.zeros(3)
    for row in range(len(blocks.indptr) - 1):
        for place in range(blocks.indptr[row], blocks.indptr[row + 1]):
            column, block = int(blocks.indices[place]), blocks.data[place]
            if column == row:
                graph.push_back(gtsam.HessianFactor(row, block, zero, 0.0))
            elif column > row:
                factor = gtsam.HessianFactor(row, column, none, block, zero, none, zero, 0.0)
                graph.push_back(factor)
    return graph.eliminateMultifrontal(gtsam.Ordering.ColamdGaussianFactorGraph(graph))


def _joint(own: Array, shared: Array, above: Array) -> Array:
    """Return the covariance of a clique's own poses and those that it shares with its parent.

    ``own`` R and ``shared`` S are those of R x + S y = 0 with unit noise, ``above`` that of y.
    """
    inverse = np.linalg.inv(own)
    gain = -inverse @ shared
    count = len(own)
    joint = np.empty((count + len(above), count + len(above)))
    joint[count:, count:] = above
    joint[:count, count:] = gain @ above
    joint[count:, :count] = joint[:count, count:].T
    joint[:count, :count] = inverse @ inverse.T + joint[:count, count:] @ gain.T
    return joint


def _chosen(covariance: Array, poses: list[int]) -> Array:
    """Return the covariance of some of the poses."""
    places = (3 * np.array(poses, dtype=np.intp)[:, None] + np.arange(3)).ravel()
    return np.asarray(covariance[np.ix_(places, places)])
