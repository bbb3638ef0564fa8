# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One scan as measured, motion-compensated and corrected: the paper's Figure 15."""

import numpy as np
from matplotlib.axes import Axes

from msss_graphslam.core.compounding import inverse, transform_points
from msss_graphslam.core.types import Array
from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.figures.panels import map_extent, map_figure
from msss_graphslam.evaluation.figures.style import Plate
from msss_graphslam.evaluation.figures.trajectories import draw_points
from msss_graphslam.results.record import example_scan

__all__ = ["one_scan"]

_BEFORE, _DURING, _AFTER = "#d55e00", "#0072b2", "#009e73"


def one_scan(assessment: Assessment) -> Plate | None:
    """Draw the scan in which the vehicle moved most, in three layouts over the whole map."""
    estimate = assessment.record.estimate
    number = example_scan(estimate)
    if number is None:
        return None
    frame, first = estimate.keyframes[number], estimate.first_scans[number]
    layouts = {
        "as measured": (first.body_points, np.zeros_like(first.motion), _BEFORE),
        "motion-compensated": (first.points, first.motion, _DURING),
        "corrected": (frame.scan.points, frame.scan.motion, _AFTER),
    }
    shown = np.vstack([points for points, _, _ in layouts.values()])
    figure, panels = map_figure(map_extent(shown, frame.scan.motion[:, :2]), 3)
    walls = transform_points(inverse(frame.pose), assessment.record.points[:, :2])
    for axes, (name, (points, motion, shade)) in zip(panels, layouts.items(), strict=True):
        _draw_layout(axes, walls, points, motion, shade)
        axes.set_title(name, color=shade)
    return Plate("scan", "One scan before and after correction", _caption(assessment), figure)


def _draw_layout(axes: Axes, walls: Array, points: Array, motion: Array, shade: str) -> None:
    draw_points(axes, walls)
    axes.plot(*points.T, ".", color=shade, markersize=3.5, mew=0)
    axes.plot(*motion[:, :2].T, "-", color="#111111", linewidth=1.4)
    axes.plot(*motion[-1, :2], "s", color="#111111", markersize=4)
    axes.set_xlabel("x, forward [m]")
    if axes.get_ylabel():
        axes.set_ylabel("y, to port [m]")


def _caption(assessment: Assessment) -> str:
    number = example_scan(assessment.record.estimate)
    scan = assessment.record.estimate.keyframes[number or 0].scan
    travelled = float(np.linalg.norm(scan.motion[-1, :2]))
    turned = abs(float(np.degrees(scan.motion[-1, 2])))
    duration = (scan.end_stamp_ns - scan.stamp_ns) * 1e-9
    return (
        f"Scan {number} took {duration:.1f} s, in which the vehicle went {travelled:.2f} m and"
        f" turned by {turned:.0f} deg (black, ends at the square). Left: drawn as if it had stood"
        " still. Middle: laid out by dead reckoning. Right: by the corrected trajectory. Grey: the"
        " finished map."
    )
