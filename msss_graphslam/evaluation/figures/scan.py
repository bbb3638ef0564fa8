# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One scan as measured, motion-compensated and corrected: the paper's Figures 2 and 15."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from msss_graphslam.core.compounding import inverse, transform_points
from msss_graphslam.core.types import Array, Beam
from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.figures.style import MAP, Plate, map_figure
from msss_graphslam.results.record import example_scan

__all__ = ["echo_image", "one_scan"]

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
    figure, panels = map_figure(np.vstack([points for points, _, _ in layouts.values()]), 3)
    walls = transform_points(inverse(frame.pose), assessment.record.points[:, :2])
    for axes, (name, (points, motion, shade)) in zip(panels, layouts.items(), strict=True):
        _draw_layout(axes, walls, points, motion, shade)
        axes.set_title(name, color=shade)
    _frame(panels[0], np.vstack([points for points, _, _ in layouts.values()]))
    figure.align_labels()
    return Plate("scan", "One scan before and after correction", _caption(assessment), figure)


def echo_image(assessment: Assessment) -> Plate | None:
    """Draw the echoes of that scan as the head sent them, unmoved and corrected."""
    number = example_scan(assessment.record.estimate)
    beams = assessment.record.example_beams
    if number is None or not beams:
        return None
    scan = assessment.record.estimate.keyframes[number].scan
    kept, rows = _rows_of(beams, scan.beam_stamps_ns)
    if len(kept) < 2:
        return None
    figure = Figure(figsize=(9.0, 4.8), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, motion, title in (
        (panels[0], np.zeros((len(kept), 3)), "as measured"),
        (panels[1], scan.motion[rows], "corrected"),
    ):
        _draw_echoes(axes, kept, motion, _mount_yaw(assessment))
        axes.set_title(title)
        axes.set_xlabel("x, forward [m]")
    panels[0].set_ylabel("y, to port [m]")
    caption = (
        "The echo profiles of the same turn, brighter is stronger, drawn with the vehicle at rest"
        " and along its corrected motion."
    )
    return Plate("echoes", "The sonar image of one turn", caption, figure)


def _draw_layout(axes: Axes, walls: Array, points: Array, motion: Array, shade: str) -> None:
    axes.plot(*walls.T, ".", color=MAP, markersize=1.5, alpha=0.35, mew=0)
    axes.plot(*points.T, ".", color=shade, markersize=3.5, mew=0)
    axes.plot(*motion[:, :2].T, "-", color="#111111", linewidth=1.4)
    axes.plot(*motion[-1, :2], "s", color="#111111", markersize=4)
    axes.set_xlabel("x, forward [m]")
    if axes.get_ylabel():
        axes.set_ylabel("y, to port [m]")


def _frame(axes: Axes, points: Array) -> None:
    """Show the scan, not the whole map."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.06 * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)


def _rows_of(beams: tuple[Beam, ...], stamps_ns: np.ndarray) -> tuple[list[Beam], list[int]]:
    rows = {int(stamp): row for row, stamp in enumerate(stamps_ns)}
    kept = [beam for beam in beams if beam.stamp_ns in rows]
    return kept, [rows[beam.stamp_ns] for beam in kept]


def _mount_yaw(assessment: Assessment) -> float:
    return float(assessment.record.configuration["sonar"]["mount_yaw"])


def _draw_echoes(axes: Axes, beams: list[Beam], motion: Array, mount_yaw: float) -> None:
    axes.set_aspect("equal")
    axes.set_facecolor("#0b1522")
    axes.grid(visible=False)
    positions, strengths = [], []
    for beam, pose in zip(beams, motion, strict=True):
        angle = beam.bearing + mount_yaw
        ray = beam.ranges[:, None] * np.array([np.cos(angle), np.sin(angle)])
        positions.append(transform_points(pose, ray))
        strengths.append(beam.intensities)
    x, y = np.vstack(positions).T
    axes.scatter(x, y, c=np.concatenate(strengths), s=1.2, cmap="cividis", linewidths=0)


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
