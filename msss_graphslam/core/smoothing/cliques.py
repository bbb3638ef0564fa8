# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which poses are eliminated together from sparse information, and what they then depend on.

The tree of cliques is the Bayes tree of M. Kaess et al., IJRR 31, 2012; the order of elimination
is that of minimum degree.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Clique", "Numbers", "cliques", "top_down"]

Numbers = NDArray[np.intp]


@dataclass(slots=True)
class Clique:
    """Poses that are eliminated together.

    ``own`` are these poses, ``shared`` (k,) those that they then still depend on, all of which
    the clique ``above`` has; None where there is none. ``below`` are the cliques that have this
    one above, those with the most below them first.
    """

    own: list[int]
    shared: Numbers
    above: int | None
    below: list[int] = field(default_factory=list)

    @property
    def poses(self) -> Numbers:
        """Its own poses, then the shared ones."""
        return np.append(self.own, self.shared)


def cliques(blocks: Any) -> list[Clique]:
    """Return the cliques of n poses, each after the one above it.

    ``blocks`` is the information as a symmetric block matrix of SciPy's, (n, n) blocks.
    """
    order = _order(blocks)
    later, children = _eliminated(blocks, order)
    found: list[Clique] = []
    clique_of = np.zeros(len(order), dtype=np.intp)
    for place in range(len(order) - 1, -1, -1):
        pose, tied = int(order[place]), later[place]
        above = int(clique_of[tied[0]]) if len(tied) else None
        if above is not None and _alike(place, later, children):
            found[above].own.append(pose)
            clique_of[place] = above
            continue
        clique_of[place] = len(found)
        found.append(Clique([pose], order[tied], above))
    _hang(found)
    return found


def top_down(tree: list[Clique]) -> list[int]:
    """Return the numbers of all cliques, branch by branch and each after the one above it.

    The branches under a clique come with the longest last: whoever keeps something of a clique
    until all below it have had it then keeps that of few at a time.
    """
    found = []
    pending = [number for number, clique in enumerate(tree) if clique.above is None]
    while pending:
        found.append(pending.pop())
        pending += tree[found[-1]].below
    return found


def _hang(tree: list[Clique]) -> None:
    """Enter which cliques are below which."""
    sizes = [1] * len(tree)
    for number in range(len(tree) - 1, -1, -1):
        clique = tree[number]
        clique.below.sort(key=lambda child: -sizes[child])
        if clique.above is not None:
            tree[clique.above].below.append(number)
            sizes[clique.above] += sizes[number]


def _order(blocks: Any) -> Numbers:
    """Return the poses (n,) in the order of their elimination, by minimum degree."""
    # It holds memory that a node does without until the end.
    from scipy.sparse import csc_matrix, eye_array
    from scipy.sparse.linalg import splu

    count = len(blocks.indptr) - 1
    ones = np.ones(len(blocks.indices))
    pattern = csc_matrix((ones, blocks.indices, blocks.indptr), shape=(count, count))
    factors = splu(
        (pattern + count * eye_array(count, format="csc")).tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return np.argsort(factors.perm_c)


def _eliminated(blocks: Any, order: Numbers) -> tuple[list[Numbers], list[list[int]]]:
    """Return the later places that each place is tied to when its turn comes, and its children.

    Those are the places whose next later one it is.
    """
    place_of = np.argsort(order)
    later: list[Numbers] = []
    children: list[list[int]] = [[] for _ in order]
    for place, pose in enumerate(order):
        direct = place_of[blocks.indices[blocks.indptr[pose] : blocks.indptr[pose + 1]]]
        tied = np.unique(np.concatenate([direct, *(later[child] for child in children[place])]))
        tied = tied[tied > place]
        later.append(tied)
        if len(tied):
            children[tied[0]].append(place)
    return later, children


def _alike(place: int, later: list[Numbers], children: list[list[int]]) -> bool:
    """Whether a place depends on the next one and on what that depends on, as it alone does."""
    following = int(later[place][0])
    return len(children[following]) == 1 and len(later[place]) == len(later[following]) + 1
