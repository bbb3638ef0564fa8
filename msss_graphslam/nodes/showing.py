# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When the back end shows what: nothing slow before a keyframe has been answered."""

from typing import Any

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Estimate
from msss_graphslam.nodes.display import Display
from msss_graphslam.nodes.live_run import Maps
from msss_graphslam.nodes.mission import Mission
from msss_graphslam.nodes.timing import Leisure, Throttle
from msss_graphslam.ros.node import SlamNode

__all__ = ["Showing"]

_PATH_PERIOD = 2.0


class Showing:
    """The pictures of a mission, each when it is new and there is time for it.

    ``map_period`` is the shortest time between two maps [s].
    """

    def __init__(self, node: SlamNode, map_period: float) -> None:
        self._parameters = node.parameters
        self._display = Display(node)
        self._leisure = Leisure()
        self._map_period = map_period
        self.rest()

    def rest(self) -> None:
        """Leave the pictures as they are until something new comes."""
        self._graph_due = Throttle(0.0)
        self._path_due = Throttle(_PATH_PERIOD)
        self._map_due = Throttle(self._map_period)

    def clear(self, mission: Mission) -> None:
        """Show a mission that begins."""
        self.rest()
        self._display.show_graph(mission)

    def ask_for_all(self) -> None:
        """Note a new keyframe that has been answered."""
        self._leisure.end()
        for due in (self._graph_due, self._path_due, self._map_due):
            due.ask()

    def ask_for_map(self) -> None:
        """Note that the map is to be drawn anew."""
        self._map_due.ask()

    def graph(self, mission: Mission) -> None:
        """Show the graph if it is new."""
        self._graph_due.run(lambda: self._display.show_graph(mission))

    def at_leisure(self, mission: Mission) -> None:
        """Show path and maps that are new, if there is time before the next keyframe."""
        if self._leisure.lasts:
            self._path_due.run(lambda: self._display.show_path(mission.trajectory()))
            self._map_due.run(lambda: self._display.show_maps(mission, self._configuration))

    def result(self, mission: Mission, estimate: Estimate, maps: Maps) -> None:
        """Show what was saved, and nothing else until something new comes."""
        self._display.show_path(estimate.trajectory)
        self._display.show_map(mission.newest_ns, *maps)
        self.rest()

    def map_message(self, mission: Mission) -> Any:
        """Return the grid as it stands, a nav_msgs/OccupancyGrid."""
        return self._display.map_message(mission, self._configuration)

    @property
    def _configuration(self) -> Configuration:
        return self._parameters.configuration
