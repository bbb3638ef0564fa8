# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Errors over time (the paper's Figure 11); without truth, what the correction changed."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.errors import PoseErrors
from msss_graphslam.evaluation.figures.panels import panels
from msss_graphslam.evaluation.figures.style import Plate, colour, label, minutes

__all__ = ["corrections", "errors_over_time"]


def errors_over_time(assessments: Sequence[Assessment]) -> Plate | None:
    """Draw the errors of position and heading of every estimator, or None without truth."""
    errors = {name: entry for run in assessments for name, entry in run.errors.items()}
    if not errors:
        return None
    start = assessments[0].record.bag.start_ns
    figure, (position, heading) = _panels()
    for name, entry in errors.items():
        _draw(position, heading, entry, start, colour(name), label(name))
    for run in assessments:
        if run.online_errors is not None and len(assessments) == 1:
            name = f"{label(run.estimator)}, online"
            _draw(position, heading, run.online_errors, start, colour(run.estimator), name, ":")
    _label(position, heading, "error")
    caption = (
        "Distance from the true position with the trajectory anchored at its start, and estimated"
        " minus true heading."
    )
    if len(assessments) == 1:
        caption += " Online is what a subscriber was told at that moment."
    return Plate("errors", "Errors over time", caption, figure)


def corrections(assessments: Sequence[Assessment]) -> Plate:
    """Draw how far each estimator moved from dead reckoning: no error, but known without truth."""
    figure, (position, heading) = _panels()
    for run in assessments:
        estimate = run.record.estimate
        for path, name, style in (
            (estimate.trajectory, label(run.estimator), "-"),
            (estimate.online, f"{label(run.estimator)}, online", ":"),
        ):
            reckoned = estimate.dead_reckoning
            # What was heard live may be stamped after the last beam.
            last = len(reckoned.stamps_ns) - 1
            rows = np.minimum(np.searchsorted(reckoned.stamps_ns, path.stamps_ns), last)
            difference = path.planar - reckoned.planar[rows]
            time = minutes(path.stamps_ns, run.record.bag.start_ns)
            shade = colour(run.estimator)
            distance = np.linalg.norm(difference[:, :2], axis=1)
            position.plot(time, distance, style, color=shade, label=name)
            heading.plot(time, np.degrees(np.unwrap(difference[:, 2])), style, color=shade)
    _label(position, heading, "change")
    caption = (
        "Distance between the corrected and the dead-reckoned position, and the difference of"
        " their headings. This is no error: the recording has no ground truth."
    )
    return Plate("corrections", "Correction of dead reckoning", caption, figure)


def _panels() -> tuple[Figure, tuple[Axes, Axes]]:
    figure, ((upper,), (lower,)) = panels(2, 1, 4.3, sharex=True, height_ratios=(3, 2))
    upper.margins(x=0.0)
    lower.set_xlabel("time since the start of the recording [min]")
    return figure, (upper, lower)


def _label(position: Axes, heading: Axes, what: str) -> None:
    """Name the axes, and the lines that are drawn."""
    position.set_ylabel(f"position {what} [m]")
    heading.set_ylabel(f"heading {what} [deg]")
    position.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5)


def _draw(
    position: Axes,
    heading: Axes,
    errors: PoseErrors,
    start_ns: int,
    shade: str,
    name: str,
    style: str = "-",
) -> None:
    time = minutes(errors.stamps_ns, start_ns)
    position.plot(time, errors.anchored, style, color=shade, label=name, linewidth=1.3)
    heading.plot(time, np.degrees(np.unwrap(errors.heading)), style, color=shade, linewidth=1.0)
