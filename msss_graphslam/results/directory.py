# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The directory of a run: one method a file."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from msss_graphslam.core.types import Estimate, Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.results.atomic import write_text
from msss_graphslam.results.constraint_table import write_constraint_table
from msss_graphslam.results.occupancy_map import write_occupancy_map
from msss_graphslam.results.point_cloud import write_points
from msss_graphslam.results.pose_graph import write_pose_graph
from msss_graphslam.results.record import RunRecord
from msss_graphslam.results.result_bag import write_result_bag
from msss_graphslam.results.tum import read_trajectory, write_trajectory

__all__ = ["ResultDirectory"]


class ResultDirectory:
    """Writes what a run leaves, and reads it back.

    Every file is written whole or not at all.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    @classmethod
    def create(cls, path: Path) -> "ResultDirectory":
        """Make the directory where it does not exist; UserError where that cannot be."""
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UserError(f"{path}: cannot make this directory ({error.strerror})") from error
        return cls(path)

    def write_estimate(self, record: RunRecord) -> None:
        """Write the trajectories, the graph, the maps and the bag of the output topics."""
        self.write_trajectories(record.estimate)
        self.write_graph_and_maps(record)

    def write_trajectories(self, estimate: Estimate) -> None:
        """Write where the vehicle was at each beam, and where it was thought to be."""
        write_trajectory(self.path / "trajectory.tum", estimate.trajectory)
        write_trajectory(self.path / "online.tum", estimate.online)
        write_trajectory(self.path / "dead_reckoning.tum", estimate.dead_reckoning)

    def write_graph_and_maps(self, record: RunRecord) -> None:
        """Write the rest of what was estimated."""
        estimate = record.estimate
        write_trajectory(self.path / "keyframes.tum", record.keyframe_trajectory)
        write_pose_graph(self.path / "graph.g2o", estimate.keyframes, estimate.constraints)
        write_constraint_table(self.path / "constraints.csv", estimate.constraints)
        write_points(self.path / "map.ply", record.points)
        write_occupancy_map(self.path / "map.pgm", self.path / "map.yaml", record.grid)
        write_result_bag(self.path / "result.mcap", record)

    def write_summary(self, summary: Mapping[str, Any]) -> None:
        """Write summary.json; a number that is not finite is an error, never a file."""
        text = json.dumps(summary, indent=2, allow_nan=False)
        write_text(self.path / "summary.json", f"{text}\n")

    def write_report(self, html: str) -> None:
        """Write report.html."""
        write_text(self.path / "report.html", html)

    def figure_path(self, name: str) -> Path:
        """Return the path of a figure, whose directory is there."""
        directory = self.path / "figures"
        directory.mkdir(exist_ok=True)
        return directory / f"{name}.png"

    def read_trajectories(self) -> tuple[Trajectory, Trajectory, Trajectory]:
        """Read the corrected trajectory, what was known online, and dead reckoning."""
        if not self.path.is_dir():
            raise UserError(f"{self.path}: no such directory; give the --out of an earlier run")
        corrected, online, dead_reckoning = (
            read_trajectory(self.path / f"{name}.tum")
            for name in ("trajectory", "online", "dead_reckoning")
        )
        return corrected, online, dead_reckoning

    def read_summary(self) -> dict[str, Any]:
        """Read summary.json."""
        path = self.path / "summary.json"
        try:
            summary = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise UserError(
                f"{path}: cannot be read ({error}); run the estimator again"
            ) from error
        if not isinstance(summary, dict):
            raise UserError(f"{path}: not a summary of this package; run the estimator again")
        return summary
