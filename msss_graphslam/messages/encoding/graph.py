# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The pose graph: its edges as odometry, and markers to look at."""

from collections.abc import Sequence
from dataclasses import dataclass
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

__all__ = ["MARKERS", "MarkerStyle", "constraint", "graph_markers", "marker_points"]

# visualization_msgs/Marker
_LINE_LIST = 5
_SPHERE_LIST = 7


@dataclass(frozen=True, slots=True)
class MarkerStyle:
    """How a marker looks: its kind, its size [m], red, green, blue and opacity."""

    kind: int
    size: float
    colour: tuple[float, float, float, float]


MARKERS = {
    "nodes": MarkerStyle(_SPHERE_LIST, 0.3, (0.0, 0.45, 0.70, 1.0)),
    "odometry": MarkerStyle(_LINE_LIST, 0.05, (0.35, 0.35, 0.35, 1.0)),
    "loops": MarkerStyle(_LINE_LIST, 0.05, (0.0, 0.62, 0.45, 1.0)),
    "refused": MarkerStyle(_LINE_LIST, 0.05, (0.84, 0.37, 0.0, 0.35)),
}
"""The markers of a graph by their namespace."""


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
    stamped = header(make, stamp_ns, frame_id)
    markers = [
        _marker(make, stamped, name, places)
        for name, places in marker_points(poses, constraints).items()
    ]
    return make("visualization_msgs/msg/MarkerArray", markers=markers)


def marker_points(poses: Array, constraints: Sequence[Constraint]) -> dict[str, Array]:
    """Return the points (m, 3) of each of the MARKERS, two for an edge."""
    places = np.zeros((len(poses), 3))
    places[:, :2] = poses[:, :2]
    ends: dict[str, list[int]] = {name: [] for name in MARKERS if name != "nodes"}
    for edge in constraints:
        if edge.first < len(places) > edge.second:
            ends[_namespace(edge)] += (edge.first, edge.second)
    edges = {name: places[np.array(rows, dtype=np.intp)] for name, rows in ends.items()}
    return {"nodes": places, **edges}


def _namespace(edge: Constraint) -> str:
    if not edge.accepted:
        return "refused"
    return "loops" if edge.kind is ConstraintKind.LOOP else "odometry"


def _marker(make: Make, stamped: Any, name: str, places: Array) -> Any:
    style = MARKERS[name]
    size = style.size
    red, green, blue, alpha = style.colour
    return make(
        "visualization_msgs/msg/Marker",
        header=stamped,
        ns=name,
        id=0,
        type=style.kind,
        action=0,
        pose=pose_of(make, np.zeros(3)),
        scale=make("geometry_msgs/msg/Vector3", x=size, y=size, z=size),
        color=make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=alpha),
        points=[point(make, place) for place in places],
    )
