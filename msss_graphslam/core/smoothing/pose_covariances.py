# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Covariances of single poses from the sparse information of all, without the whole inverse.

In a Bayes tree (M. Kaess et al., IJRR 31, 2012) a clique depends on the one above it alone: from
the root down, the covariance of each follows from that of its parent.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from msss_graphslam.core.smoothing.cliques import Clique, Numbers, cliques, top_down
from msss_graphslam.core.types import Array

__all__ = ["pose_covariances"]

# gtsam has such a tree, and marginals from it. But it wants the information as factors, and keeps
# them, the tree and what it has found until the end: for 3000 poses its peak is 168 MiB, this one
# takes 67 MiB. Here a clique is forgotten as soon as those below it are done.


@dataclass(frozen=True, slots=True)
class _Conditional:
    """A clique's own poses x given its shared ones y: R x + S y = 0 with unit noise.

    ``own`` is R, ``shared`` S; ``places`` (k,) are those of y in the clique above.
    """

    own: Array
    shared: Array
    places: Numbers


def pose_covariances(information: Any) -> Array:
    """Return the covariances (n, 3, 3) of n poses.

    ``information`` (3 n, 3 n) is a sparse matrix of SciPy's, symmetric. Raises RuntimeError where
    it leaves a pose undetermined.
    """
    blocks = information.tobsr((3, 3))
    tree = cliques(blocks)
    conditionals = _eliminated(blocks, tree)
    covariances = np.full((information.shape[0] // 3, 3, 3), np.nan)
    nothing = np.empty((0, 0))
    pending = [(number, nothing) for number, clique in enumerate(tree) if clique.above is None]
    while pending:
        number, above = pending.pop()
        joint = _joint(conditionals.pop(number), above)
        for place, pose in enumerate(tree[number].own):
            covariances[pose] = joint[3 * place : 3 * place + 3, 3 * place : 3 * place + 3]
        pending += [(child, joint) for child in tree[number].below]
    if not np.isfinite(covariances).all():
        raise RuntimeError("a pose is in no measurement")
    return covariances


def _eliminated(blocks: Any, tree: list[Clique]) -> dict[int, _Conditional]:
    """Return by number what each clique's poses depend on, found from the leaves to the root."""
    found: dict[int, _Conditional] = {}
    fronts: dict[int, Array] = {}
    place_of = np.empty(len(blocks.indptr) - 1, dtype=np.intp)
    for number in reversed(top_down(tree)):
        clique = tree[number]
        front = fronts.pop(number) if number in fronts else _empty(clique)
        _add_measured(front, blocks, clique)
        own, shared, left = _without_own(front, 3 * len(clique.own))
        places = clique.shared
        if clique.above is not None:
            above = tree[clique.above]
            place_of[above.poses] = np.arange(len(above.poses))
            places = place_of[clique.shared]
            if clique.above not in fronts:
                fronts[clique.above] = _empty(above)
            rows = _rows(places)
            fronts[clique.above][np.ix_(rows, rows)] += left
        found[number] = _Conditional(own, shared, places)
    return found


def _empty(clique: Clique) -> Array:
    size = 3 * len(clique.poses)
    return np.zeros((size, size))


def _add_measured(front: Array, blocks: Any, clique: Clique) -> None:
    """Add what was measured of a clique's own poses: their rows of the information."""
    place_of = {pose: place for place, pose in enumerate(clique.poses.tolist())}
    for place, pose in enumerate(clique.own):
        row = slice(blocks.indptr[pose], blocks.indptr[pose + 1])
        for other, block in zip(blocks.indices[row].tolist(), blocks.data[row], strict=True):
            if other in place_of:
                column = place_of[other]
                front[3 * place : 3 * place + 3, 3 * column : 3 * column + 3] += block


def _without_own(front: Array, count: int) -> tuple[Array, Array, Array]:
    """Eliminate the first ``count`` rows; return R and S of them and what is left."""
    try:
        lower = np.linalg.cholesky(front[:count, :count])
    except np.linalg.LinAlgError:
        raise RuntimeError("the measurements leave a pose undetermined") from None
    shared: Array = np.linalg.solve(lower, front[:count, count:])
    return np.asarray(lower.T), shared, front[count:, count:] - shared.T @ shared


def _joint(conditional: _Conditional, above: Array) -> Array:
    """Return the covariance of a clique's own poses and those that it shares with its parent.

    ``above`` is that of the parent.
    """
    shared = _chosen(above, conditional.places)
    inverse = np.linalg.inv(conditional.own)
    gain = -inverse @ conditional.shared
    count = len(conditional.own)
    joint = np.empty((count + len(shared), count + len(shared)))
    joint[count:, count:] = shared
    joint[:count, count:] = gain @ shared
    joint[count:, :count] = joint[:count, count:].T
    joint[:count, :count] = inverse @ inverse.T + joint[:count, count:] @ gain.T
    return joint


def _chosen(covariance: Array, poses: Numbers) -> Array:
    """Return the covariance of some of the poses."""
    rows = _rows(poses)
    return np.asarray(covariance[np.ix_(rows, rows)])


def _rows(poses: Numbers) -> Numbers:
    """Return the three rows of each pose."""
    return np.asarray((3 * poses[:, None] + np.arange(3)).ravel())
