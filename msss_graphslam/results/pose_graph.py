# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The pose graph as a g2o file, which gtsam, g2o and Ceres read."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from msss_graphslam.core.types import Array, Constraint, Keyframe
from msss_graphslam.results.atomic import write_text

__all__ = ["write_pose_graph"]


def write_pose_graph(
    path: Path, keyframes: Sequence[Keyframe], constraints: Sequence[Constraint]
) -> None:
    """Write the keyframes as vertices and the accepted constraints as edges.

    Numbers have 17 significant digits: what is read back is what was written. No vertex is marked
    as fixed, since gtsam stops reading at a FIX line.
    """
    lines = [_vertex(number, keyframe.pose) for number, keyframe in enumerate(keyframes)]
    lines += [_edge(constraint) for constraint in constraints if constraint.accepted]
    write_text(path, "".join(f"{line}\n" for line in lines))


def _vertex(number: int, pose: Array) -> str:
    return f"VERTEX_SE2 {number} {_numbers(pose)}"


def _edge(constraint: Constraint) -> str:
    information = np.linalg.inv(constraint.covariance)
    symmetric = 0.5 * (information + information.T)
    numbers = _numbers(np.concatenate([constraint.relative_pose, symmetric[np.triu_indices(3)]]))
    return f"EDGE_SE2 {constraint.first} {constraint.second} {numbers}"


def _numbers(values: Array) -> str:
    return " ".join(f"{value:.17g}" for value in values)
