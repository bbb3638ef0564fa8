# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The whole pose graph at once, for the covariances that it gives in the end."""

from collections.abc import Sequence

from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.types import Array, Constraint

__all__ = ["whole_graph"]


def whole_graph(poses: Array, constraints: Sequence[Constraint], config: BackEndConfig) -> BackEnd:
    """Return the graph of all accepted constraints at once, begun at the poses (n, 3)."""
    back_end = BackEnd(config)
    for pose in poses:
        back_end.add_keyframe(pose)
    back_end.update([edge for edge in constraints if edge.accepted])
    return back_end
