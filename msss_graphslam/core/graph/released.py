# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Keyframes that have left the smoother: each stays where it stood to one that has not."""

# Deviation: in the paper every keyframe stays in the graph for good. Of the scans at a known place
# thousands would hang on the few keyframes there, and the smoother goes through all of them in
# every update, although they have long said what they had to say of that place.

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from msss_graphslam.core.compounding import between, compose, compose_covariance
from msss_graphslam.core.types import Array, Constraint

__all__ = ["Released"]


class Released:
    """The holds of what has left: from a keyframe in the smoother to one outside."""

    def __init__(self) -> None:
        self._holds: dict[int, Constraint] = {}

    def __contains__(self, number: int) -> bool:
        return number in self._holds

    def hold(self, number: int) -> Constraint:
        """Return by what a keyframe is held that has left."""
        return self._holds[number]

    def add(self, edges: Sequence[Constraint], pose_of: Callable[[int], Array]) -> None:
        """Let the keyframe go at which the ``edges`` end; ``pose_of`` gives poses (3,).

        The surest of them holds it: its covariance is no smaller than that of all together.
        """
        surest = min(map(self.from_inside, edges), key=_position_variance)
        relative = between(pose_of(surest.first), pose_of(surest.second))
        self._holds[surest.second] = replace(surest, relative_pose=relative)

    def from_inside(self, edge: Constraint) -> Constraint:
        """Return the constraint as one that begins at a keyframe in the smoother."""
        hold = self._holds.get(edge.first)
        if hold is None:
            return edge
        return replace(
            edge,
            first=hold.first,
            relative_pose=compose(hold.relative_pose, edge.relative_pose),
            covariance=compose_covariance(
                hold.relative_pose, hold.covariance, edge.relative_pose, edge.covariance
            ),
        )

    def completed(self, inside: Array) -> Array:
        """Return the poses (n, 3) of all keyframes, by those (m, 3) in the smoother."""
        if not self._holds:
            return inside
        numbers = list(self._holds)
        stays = np.ones(len(inside) + len(numbers), dtype=bool)
        stays[numbers] = False
        poses = np.empty((len(stays), 3))
        poses[stays] = inside
        holds = self._holds.values()
        anchors = poses[[hold.first for hold in holds]]
        poses[numbers] = compose(anchors, np.array([hold.relative_pose for hold in holds]))
        return poses


def _position_variance(edge: Constraint) -> float:
    return float(np.trace(edge.covariance[:2, :2]))
