# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How far the pose that is known online jumps when a scan corrects it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array, ConstraintKind, Estimate
from msss_graphslam.evaluation.errors import interpolate

__all__ = ["FAR", "Jumps", "first_far_closures", "largest_jumps"]

FAR = 19
"""A loop closure is far that spans more keyframes than this."""


@dataclass(frozen=True, slots=True)
class Jumps:
    """The ``largest`` jump [m], and the largest ``plain`` one, away from a first far loop closure.

    The plain one came after so many whole turns: after the first nothing but dead reckoning had
    told of the motion.
    """

    largest: float = 0.0
    plain: float = 0.0
    turns: int = 0


def largest_jumps(estimate: Estimate) -> Jumps:
    """Return the largest steps from one output to the next beyond those of dead reckoning."""
    reckoned, covered = interpolate(estimate.dead_reckoning, estimate.online.stamps_ns)
    stamps = estimate.online.stamps_ns[covered]
    jumps = _beyond(estimate.online.planar[covered], reckoned[covered])
    if not jumps.size:
        return Jumps()
    ends = np.array([frame.scan.end_stamp_ns for frame in estimate.keyframes], dtype=np.int64)
    turns = np.searchsorted(ends, stamps[1:], side="right")
    plain = np.where(np.isin(turns - 1, first_far_closures(estimate)), 0.0, jumps)
    return Jumps(float(jumps.max()), float(plain.max()), int(turns[plain.argmax()]))


def first_far_closures(estimate: Estimate) -> NDArray[np.int64]:
    """Return the keyframes with a far loop closure, of which none shortly before has one."""
    far = sorted(
        {
            edge.second
            for edge in estimate.constraints
            if edge.kind is ConstraintKind.LOOP
            and edge.accepted
            and edge.second - edge.first > FAR
        }
    )
    numbers = np.array(far, dtype=np.int64)
    return numbers[np.diff(numbers, prepend=-FAR - 1) > FAR]


def _beyond(poses: Array, reckoned: Array) -> Array:
    """Return the lengths (n - 1,) of the steps of poses (n, 3) beyond those of dead reckoning."""
    position = poses[:, 0] + 1j * poses[:, 1]
    turn = np.exp(1j * (poses[:-1, 2] - reckoned[:-1, 2]))
    step = turn * np.diff(reckoned[:, 0] + 1j * reckoned[:, 1])
    return np.asarray(np.abs(np.diff(position) - step))
