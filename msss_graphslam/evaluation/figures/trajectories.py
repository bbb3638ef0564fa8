# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Trajectories over the map: the paper's Figures 10 and 16."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from msss_graphslam.core.types import Array, Trajectory
from msss_graphslam.evaluation.assessment import DEAD_RECKONING, Assessment
from msss_graphslam.evaluation.errors import start_end_gap
from msss_graphslam.evaluation.figures.panels import map_extent, map_figure
from msss_graphslam.evaluation.figures.style import MAP, TRUTH, Plate, colour, label

__all__ = ["trajectories"]


def trajectories(assessments: Sequence[Assessment]) -> Plate:
    """Draw every estimator's trajectory over the map of the last one."""
    best = assessments[-1]
    tracks = {name: path for run in assessments for name, path in run.trajectories.items()}
    positions = np.vstack([path.planar[:, :2] for path in tracks.values()])
    figure, (axes,) = map_figure(map_extent(best.record.points, positions))
    draw_points(axes, best.record.points)
    for name, path in tracks.items():
        dashed = name == DEAD_RECKONING
        draw_track(axes, path.planar, colour(name), label(name), "--" if dashed else "-")
    if best.anchored_truth is not None:
        draw_track(axes, best.anchored_truth, TRUTH, "ground truth", ":")
    draw_ends(axes, best.record.estimate.trajectory.planar, colour(best.estimator))
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=7)
    return Plate("trajectories", "Trajectories over the map", _caption(best, tracks), figure)


def draw_points(axes: Axes, points: Array) -> None:
    """Draw map points (n, 2 or more) [m]; more of them are drawn fainter."""
    count = max(len(points), 1)
    alpha = float(np.clip(6000.0 / count, 0.2, 0.9))
    size = float(np.clip(100.0 / np.sqrt(count), 1.5, 3.5))
    axes.plot(points[:, 0], points[:, 1], ".", color=MAP, markersize=size, alpha=alpha, mew=0)


def draw_track(axes: Axes, planar: Array, shade: str, name: str, style: str = "-") -> None:
    """Draw planar poses (n, 3) as a line."""
    axes.plot(planar[:, 0], planar[:, 1], style, color=shade, linewidth=1.5, label=name)


def draw_ends(axes: Axes, planar: Array, shade: str) -> None:
    """Mark where a trajectory starts (ring) and ends (square); both show where they coincide."""
    for row, marker, size, face, name in (
        (0, "o", 11.0, "white", "start"),
        (-1, "s", 5.0, shade, "end"),
    ):
        axes.plot(
            *planar[row, :2],
            marker=marker,
            markersize=size,
            label=name,
            color=shade,
            markerfacecolor=face,
            markeredgewidth=1.8,
            linestyle="none",
            zorder=5,
        )


def _caption(assessment: Assessment, tracks: Mapping[str, Trajectory]) -> str:
    gaps = ", ".join(
        f"{start_end_gap(path):.2f} m ({label(name)})" for name, path in tracks.items()
    )
    shift = (
        " The ground truth is shifted to the common start and not rotated."
        if assessment.errors
        else ""
    )
    return (
        f"Grey: the walls as mapped by {label(assessment.estimator)}. Start and end lie {gaps}"
        f" apart.{shift}"
    )
