# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How sure the estimate is of itself, and, where there is a truth, whether rightly so."""

import numpy as np
from matplotlib.axes import Axes

from msss_graphslam.core.types import Array
from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.figures.panels import panels
from msss_graphslam.evaluation.figures.style import MUTED, TRUTH, Plate, colour, minutes

__all__ = ["uncertainty"]


def uncertainty(assessment: Assessment) -> Plate | None:
    """Draw the standard deviations of the keyframes' positions and headings."""
    frames = assessment.record.estimate.keyframes
    if not frames:
        return None
    covariances = np.array([frame.covariance for frame in frames])
    stamps = np.array([frame.scan.stamp_ns for frame in frames])
    time = minutes(stamps, assessment.record.bag.start_ns)
    figure, ((position,), (heading,)) = panels(2, 1, 3.7, sharex=True)
    spread = np.sqrt(np.trace(covariances[:, :2, :2], axis1=1, axis2=2))
    _draw_band(position, time, spread, colour(assessment.estimator))
    _draw_band(
        heading, time, np.degrees(np.sqrt(covariances[:, 2, 2])), colour(assessment.estimator)
    )
    _draw_actual(assessment, time, position, heading)
    for axes in (position, heading):
        axes.set_ylim(bottom=0.0)
    position.set_ylabel("position [m]")
    heading.set_ylabel("heading [deg]")
    heading.set_xlabel("time since the start of the recording [min]")
    position.margins(x=0.0)
    position.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4)
    return Plate("uncertainty", "Uncertainty of the scans' poses", _caption(assessment), figure)


def _draw_band(axes: Axes, time: Array, deviation: Array, shade: str) -> None:
    axes.fill_between(
        time, 0.0, 2.0 * deviation, color=shade, alpha=0.15, lw=0, label="two standard deviations"
    )
    axes.plot(time, deviation, color=shade, label="one standard deviation")


def _draw_actual(assessment: Assessment, time: Array, position: Axes, heading: Axes) -> None:
    errors = assessment.keyframe_errors
    if errors is None:
        position.plot([], [], color=MUTED, lw=0, label="(no ground truth to compare with)")
        return
    distance = np.linalg.norm(errors[:, :2], axis=1)
    position.plot(time, distance, ".", color=TRUTH, markersize=4, label="actual error")
    heading.plot(time, np.abs(np.degrees(errors[:, 2])), ".", color=TRUTH, markersize=4)


def _caption(assessment: Assessment) -> str:
    text = "One and two standard deviations of the scans' poses relative to the first scan's."
    nees = assessment.keyframe_consistency
    if nees is None:
        return text
    return (
        f"{text} Mean squared error over stated variance: {nees.mean:.2f} (1 is honest; 95 % band"
        f" of {nees.samples} independent poses {nees.low:.2f} to {nees.high:.2f})."
    )
