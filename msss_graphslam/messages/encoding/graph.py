# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The pose graph: its edges as odometry, and markers to look at."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from msss_graphslam.core.types import Array, Constraint, ConstraintKind
from msss_graphslam.messages.encoding.primitives import (
    Make,
    covariance_36,
    header,
    point,
    pose_of,
)
from msss_graphslam.messages.frames import MAP

__all__ = ["constraint", "graph_markers"]

# visualization_msgs/Marker
_LINE_LIST = 5
_SPHERE_LIST = 7

_NODE_DIAMETER = 0.3
_LINE_WIDTH = 0.05
_COLOURS = {
    "nodes": (0.0, 0.45, 0.70, 1.0),
    "odometry": (0.35, 0.35, 0.35, 1.0),
    "loops": (0.0, 0.62, 0.45, 1.0),
    "refused": (0.84, 0.37, 0.0, 0.35),
}


def constraint(make: Make, stamp_ns: int, edge: Constraint) -> Any:
    """Return one edge as a nav_msgs/Odometry between the frames keyframe_i and keyframe_j."""
    return make(
        "nav_msgs/msg/Odometry",
        header=header(make, stamp_ns, f"keyframe_{edge.first}"),
        child_frame_id=f"keyframe_{edge.second}",
        pose=make(
            "geometry_msgs/msg/PoseWithCovariance",
            pose=pose_of(make, edge.relative_pose),
            covariance=covariance_36(edge.covariance),
        ),
    )


def graph_markers(
    make: Make,
    stamp_ns: int,
    poses: Array,
    constraints: Sequence[Constraint],
    frame_id: str = MAP,
) -> Any:
    """Return nodes, odometry edges, loop closures and refused closures as a MarkerArray.

    ``poses`` (n, 3) are the keyframes' x, y, yaw; an edge to a keyframe without one is left out.
    """
    places = np.zeros((len(poses), 3))
    places[:, :2] = poses[:, :2]
    edges: dict[str, list[int]] = {"odometry": [], "loops": [], "refused": []}
    for edge in constraints:
        if max(edge.first, edge.second) < len(places):
            edges[_namespace(edge)] += [edge.first, edge.second]
    stamped = header(make, stamp_ns, frame_id)
    markers = [_marker(make, stamped, "nodes", _SPHERE_LIST, _NODE_DIAMETER, places)]
    markers += [
        _marker(make, stamped, name, _LINE_LIST, _LINE_WIDTH, places[ends])
        for name, ends in edges.items()
    ]
    return make("visualization_msgs/msg/MarkerArray", markers=markers)


def _namespace(edge: Constraint) -> str:
    if not edge.accepted:
        return "refused"
    return "loops" if edge.kind is ConstraintKind.LOOP else "odometry"


def _marker(make: Make, stamped: Any, name: str, kind: int, size: float, places: Array) -> Any:
    red, green, blue, alpha = _COLOURS[name]
    return make(
        "visualization_msgs/msg/Marker",
        header=stamped,
        ns=name,
        id=0,
        type=kind,
        action=0,
        pose=pose_of(make, np.zeros(3)),
        scale=make("geometry_msgs/msg/Vector3", x=size, y=size, z=size),
        color=make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=alpha),
        points=[point(make, place) for place in places],
    )
