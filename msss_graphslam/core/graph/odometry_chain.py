# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the way from keyframe to keyframe says of where two of them lie to each other."""

# Deviation: the paper takes every closure that has passed Section VI. A few that are wrong in the
# same way, as two corners that look alike make them, can outvote any robust kernel; the way from
# keyframe to keyframe knows of no far closure and cannot be outvoted.

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.compounding import between, compose, planar_rotation, wrap
from msss_graphslam.core.types import Array, Constraint

__all__ = ["LAG", "OdometryChain"]

LAG = 6
"""Matches of scans so many apart or fewer belong to the way: with the nearest three that a scan is
matched with beside its predecessor, no two of them neighbours."""


@dataclass(frozen=True, slots=True)
class _Window:
    """The newest w keyframes: ``poses`` (w, 3), ``covariance`` (3 w, 3 w) of their errors.

    These are told as motions about the origin.
    """

    poses: Array
    covariance: Array

    def block(self, first: int, second: int) -> Array:
        """Return what the errors of two of them have in common (3, 3)."""
        rows, columns = (slice(3 * number, 3 * number + 3) for number in (first, second))
        return self.covariance[rows, columns]

    def apart(self, first: int, second: int) -> Array:
        """Return the covariance (3, 3) of the motion of one against the other."""
        mixed = self.block(first, second)
        return self.block(first, first) + self.block(second, second) - mixed - mixed.T


class OdometryChain:
    """The keyframes' poses by what lies within ``LAG`` of them, and the covariance of any two.

    A Kalman smoother over the newest keyframes takes in the edges between them. To first order an
    edge's error moves all that follows as a rigid body. Told as a motion about the origin, such
    errors add up along the chain, so that the covariance between two keyframes is a difference of
    two sums, at the same cost for near and far ones.
    """

    def __init__(self) -> None:
        self._poses = [np.zeros(3)]
        self._starts = [np.zeros((3, 3))]
        self._pieces = [0]
        self._window = self._before = _Window(np.zeros((1, 3)), np.zeros((3, 3)))

    def append(self, edge: Constraint | None) -> None:
        """Add a keyframe by its edge from the one before; None where there is no such edge."""
        self._before = self._window
        if edge is None:
            self._window = _Window(np.zeros((1, 3)), np.zeros((3, 3)))
        else:
            self._window = _grown(self._window, edge)
        self._poses.append(self._window.poses[-1])
        self._starts.append(np.zeros((3, 3)))
        self._pieces.append(self._pieces[-1] + (edge is None))
        self._note()

    def take_in(self, edge: Constraint, share: float = 1.0) -> None:
        """Count an edge between the newest keyframe and one within ``LAG``, as a ``share``."""
        if not self.reaches(edge):
            return
        first = self._place(edge.first)
        self._window = _measured(self._window, first, edge.relative_pose, edge.covariance / share)
        self._note()

    def reaches(self, edge: Constraint) -> bool:
        """Whether the edge ends at the newest keyframe and begins within ``LAG`` of it."""
        return edge.second == len(self) - 1 and 0 <= self._place(edge.first) < self._newest

    def drop_newest(self) -> None:
        """Take the newest keyframe back, as if it had not been added; once in a row."""
        del self._poses[-1], self._starts[-1], self._pieces[-1]
        self._window = self._before
        self._note()

    def __len__(self) -> int:
        return len(self._poses)

    def displacement(self, first: int) -> tuple[Array, Array] | None:
        """Return the newest keyframe's pose (3,) in that of ``first`` and its covariance (3, 3).

        None where the chain is broken between them. The covariance is in the axes of ``first``.
        """
        if self._pieces[first] != self._pieces[-1]:
            return None
        pose, other = self._poses[first], self._poses[-1]
        place = self._place(first)
        if place >= 0:
            spread = self._window.apart(place, self._newest)
        else:
            spread = self._starts[first] + self._window.block(self._newest, self._newest)
        turned = planar_rotation(float(pose[2])).T @ _about_origin(-other[:2])
        return between(pose, other), turned @ spread @ turned.T

    def deviation(self, edge: Constraint) -> tuple[Array, Array]:
        """Return how far a closure is off the chain (3,) and the covariance (3, 3) of that.

        It ends at the newest keyframe. Where the chain is broken nothing contradicts it: 0.
        """
        known = self.displacement(edge.first)
        if known is None:
            return np.zeros(3), edge.covariance
        off = edge.relative_pose - known[0]
        off[2] = wrap(off[2])
        return off, known[1] + edge.covariance

    def turned(self, first: int, off: Array) -> Array:
        """Return what is told (3,) in the axes of a keyframe in those of the chain."""
        return np.asarray(planar_rotation(float(self._poses[first][2])) @ off)

    @property
    def _newest(self) -> int:
        return len(self._window.poses) - 1

    def _place(self, keyframe: int) -> int:
        """Return the place of a keyframe in the window, negative for one before it."""
        return keyframe - (len(self) - 1 - self._newest)

    def _note(self) -> None:
        """Keep what the window says of its keyframes for when it has gone on."""
        count = len(self._window.poses)
        self._poses[-count:] = list(self._window.poses)
        # The oldest leaves next. What it shares with the newest, it shares with all that follow.
        mixed = self._window.block(0, self._newest)
        self._starts[-count] = self._window.block(0, 0) - mixed - mixed.T


def _grown(window: _Window, edge: Constraint) -> _Window:
    """Return the window with a further keyframe, of the newest ones only."""
    last = window.poses[-1]
    pose = compose(last, edge.relative_pose)
    turned = _about_origin(pose[:2]) @ planar_rotation(float(last[2]))
    shared = window.covariance[:, -3:]
    own = shared[-3:] + turned @ edge.covariance @ turned.T
    covariance = np.block([[window.covariance, shared], [shared.T, own]])
    kept = slice(-3 * (LAG + 1), None)
    return _Window(np.vstack([window.poses, pose])[-(LAG + 1) :], covariance[kept, kept])


def _measured(window: _Window, first: int, relative: Array, covariance: Array) -> _Window:
    """Return the window with the newest keyframe measured from one of the others."""
    newest = len(window.poses) - 1
    pose, other = window.poses[first], window.poses[newest]
    off = relative - between(pose, other)
    off[2] = wrap(off[2])
    turned = _about_origin(other[:2]) @ planar_rotation(float(pose[2]))
    spread = window.apart(first, newest) + turned @ covariance @ turned.T
    columns = [slice(3 * number, 3 * number + 3) for number in (newest, first)]
    mixed = window.covariance[:, columns[0]] - window.covariance[:, columns[1]]
    gain = np.linalg.solve(spread, mixed.T).T
    moved = (gain @ (turned @ off)).reshape(-1, 3)
    away = [
        _about_origin(-at[:2]) @ motion for at, motion in zip(window.poses, moved, strict=True)
    ]
    left = window.covariance - gain @ mixed.T
    return _Window(window.poses + np.array(away), 0.5 * (left + left.T))


def _about_origin(point: Array) -> Array:
    """Return what tells a small motion at a point (2,) as one about the origin (3, 3)."""
    moved = np.eye(3)
    moved[:2, 2] = point[1], -point[0]
    return moved
