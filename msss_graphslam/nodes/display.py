# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the back end shows: keyframes, markers, path and maps."""

from typing import Any

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.maps.mapping import OccupancyGrid, map_points, occupancy_grid
from msss_graphslam.core.types import Array, Trajectory
from msss_graphslam.messages import encoding
from msss_graphslam.messages.encoding import serialised
from msss_graphslam.messages.frames import MAP as MAP_FRAME
from msss_graphslam.messages.topics import KEYFRAMES, MAP, MAP_POINTS, MARKERS, PATH
from msss_graphslam.nodes.mission import Mission
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode

__all__ = ["Display"]

_LONGEST_PATH = 2000


class Display:
    """Publishes pictures of a mission, with the last of each kept for late subscribers."""

    def __init__(self, node: SlamNode) -> None:
        self._frame = node.frame(MAP_FRAME)
        self._keyframes = node.offer(KEYFRAMES)
        self._markers = node.offer(MARKERS)
        self._path = node.offer(PATH)
        self._points = node.offer(MAP_POINTS)
        self._grid = node.offer(MAP)

    def show_graph(self, mission: Mission) -> None:
        """Publish keyframes and edges."""
        path = mission.keyframe_path()
        self._keyframes.publish(serialised.path(path, self._frame), path.poses)
        markers = serialised.graph_markers(
            mission.newest_ns, mission.poses, mission.constraints, self._frame
        )
        self._markers.publish(markers, mission.poses)

    def show_path(self, trajectory: Trajectory) -> None:
        """Publish the corrected trajectory, thinned to what a viewer can take, its end kept."""
        step = -(-len(trajectory.stamps_ns) // _LONGEST_PATH) or 1
        thinned = Trajectory(trajectory.stamps_ns[::-step][::-1], trajectory.poses[::-step][::-1])
        self._path.publish(serialised.path(thinned, self._frame), thinned.poses)

    def show_maps(self, mission: Mission, configuration: Configuration) -> None:
        """Publish points and grid of the scans as the trajectory lays them out."""
        keyframes = mission.keyframes()
        grid = occupancy_grid(keyframes, configuration.mapping, configuration.sonar.mount_position)
        self.show_map(mission.newest_ns, map_points(keyframes), grid)

    def show_map(self, stamp_ns: int, points: Array, grid: OccupancyGrid) -> None:
        """Publish points and grid."""
        self._points.publish(encoding.map_cloud(make, stamp_ns, points, self._frame), points)
        self._grid.publish(self._grid_message(stamp_ns, grid))

    def map_message(self, mission: Mission, configuration: Configuration) -> Any:
        """Return the grid as it stands, a nav_msgs/OccupancyGrid."""
        keyframes = mission.keyframes()
        grid = occupancy_grid(keyframes, configuration.mapping, configuration.sonar.mount_position)
        return self._grid_message(mission.newest_ns, grid)

    def _grid_message(self, stamp_ns: int, grid: OccupancyGrid) -> Any:
        return encoding.occupancy_grid(
            make, stamp_ns, grid.occupancy, grid.resolution, grid.origin, self._frame
        )
