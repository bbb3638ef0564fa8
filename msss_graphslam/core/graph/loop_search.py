# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which keyframes the newest one is tried to close a loop with."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msss_graphslam.config.groups import Association
from msss_graphslam.core.graph.data_association import (
    Candidate,
    associate,
    squared_mahalanobis,
)
from msss_graphslam.core.graph.keyframes import Node, places
from msss_graphslam.core.types import Array

__all__ = ["as_in_the_paper", "by_overlap", "reach"]


def as_in_the_paper(nodes: Sequence[Node], poses: Array, config: Association) -> list[Candidate]:
    """Return what Algorithm 3 associates with the newest node; ``poses`` (n, 3) are all nodes'."""
    numbers, covariances = _earlier(nodes)
    current = nodes[-1]
    found = associate(
        poses[numbers],
        covariances,
        [nodes[number].descriptor for number in numbers],
        poses[-1],
        current.covariance,
        current.descriptor,
        config,
    )
    return [replace(candidate, index=numbers[candidate.index]) for candidate in found]


def by_overlap(nodes: Sequence[Node], poses: Array, config: Association) -> list[Candidate]:
    """Return the nearest nodes whose scans overlap with the newest one's, oldest first.

    At most ``config.most``, and of neighbours in time one: they say much the same, and the work
    for a scan stays the same however many have been there before.
    """
    # Deviation: scans overlap although their poses differ. Where the poses are well known
    # equation 11 would refuse every revisit that is a metre off. Shapes are not compared: from a
    # few metres off the same walls are other shapes, and a false match is refused by its overlap.
    numbers, covariances = _earlier(nodes)
    distance = reach(nodes[-1], config)
    overlap = np.diag([distance**2, distance**2, np.pi**2])
    distances = squared_mahalanobis(
        poses[numbers[:-1]],
        covariances[:-1] + overlap,
        poses[-1],
        nodes[-1].covariance + overlap,
    )
    inside = np.flatnonzero(distances < config.mahalanobis_threshold)
    taken: list[Candidate] = []
    for place in map(int, inside[np.argsort(distances[inside], kind="stable")]):
        if all(abs(numbers[place] - other.index) > 1 for other in taken):
            taken.append(Candidate(numbers[place], float(distances[place])))
        if len(taken) == config.most:
            break
    return sorted(taken, key=lambda candidate: candidate.index)


def reach(node: Node, config: Association) -> float:
    """Return how far from a node's scan others still overlap with it [m]."""
    points = node.scan.body_points
    return config.reach * float(np.median(np.hypot(*points.T))) if len(points) else 0.0


def _earlier(nodes: Sequence[Node]) -> tuple[list[int], Array]:
    """Return the numbers and the pose covariances (m, 3, 3) of the places before the newest.

    The last is the preceding node, which has its own constraint.
    """
    numbers = [*places(nodes), len(nodes) - 2]
    return numbers, np.array([nodes[number].covariance for number in numbers])
