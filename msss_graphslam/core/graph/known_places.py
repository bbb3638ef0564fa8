# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where a vehicle comes again and again: when a place is known, and what a scan there adds."""

# Deviation: in the paper every scan is a place to come back to, and all its edges stay in the
# graph. Lap upon lap ties a basin's keyframes into one dense block, and what a scan costs grows
# with the mission. A place that was mapped often enough is known: further scans are located by the
# keyframes there, but no later scan is matched with them.

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msss_graphslam.core.compounding import planar_rotation
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["KNOWN_BETTER", "hung_again", "is_known", "located_alone"]

KEYFRAMES = 20
"""As many keyframes within overlap make a place known: four or five laps of a slow vehicle."""

CLOSURES = 2
"""Loop closures by which a scan must be found there again; one alone may be false."""

KNOWN_BETTER = "known_better_by_loops"
"""Why the edge from the preceding keyframe is left out of the graph."""


def is_known(pose: Array, places: Array, reach: float, tried: Sequence[Constraint]) -> bool:
    """Whether a scan at ``pose`` (3,) lies where enough keyframes (n, 3) lie already.

    ``reach`` [m] is how far apart scans still overlap, ``tried`` are the scan's constraints.
    """
    near = np.hypot(*(places[:, :2] - pose[:2]).T) <= reach
    return bool(np.count_nonzero(near) >= KEYFRAMES and len(_closures(tried)) >= CLOSURES)


def located_alone(tried: Sequence[Constraint]) -> list[Constraint]:
    """Return the constraints, that from the preceding keyframe refused if it adds nothing.

    That is where the loop closures say more than it in every direction. Chains of scans then end
    there, and a known place's scans hang on its keyframes alone, not on each other.
    """
    loops = _information(_closures(tried))
    chain = _information([entry for entry in tried if entry.accepted and not _is_loop(entry)])
    if np.linalg.eigvalsh(loops - chain)[0] < 0.0:
        return list(tried)
    return [
        replace(entry, refusal=KNOWN_BETTER) if entry.accepted and not _is_loop(entry) else entry
        for entry in tried
    ]


def hung_again(tried: Sequence[Constraint]) -> list[Constraint]:
    """Return the constraints, that from the preceding keyframe accepted again.

    For a scan of which a loop closure was refused after all.
    """
    return [replace(edge, refusal="") if edge.refusal == KNOWN_BETTER else edge for edge in tried]


def _is_loop(constraint: Constraint) -> bool:
    return constraint.kind is ConstraintKind.LOOP


def _closures(tried: Sequence[Constraint]) -> list[Constraint]:
    return [entry for entry in tried if entry.accepted and _is_loop(entry)]


def _information(constraints: Sequence[Constraint]) -> Array:
    """Return what the constraints say together (3, 3) of where their second keyframe is."""
    total = np.zeros((3, 3))
    for entry in constraints:
        # In the axes of the second keyframe, which all of them have in common.
        turn = planar_rotation(float(entry.relative_pose[2]))
        total += turn.T @ np.linalg.inv(entry.covariance) @ turn
    return total
