# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where the time goes."""

import numpy as np

from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.figures.panels import panels, room_for
from msss_graphslam.evaluation.figures.style import ACCENT, MUTED, Plate, phrase

__all__ = ["timing"]


def timing(assessment: Assessment) -> Plate | None:
    """Draw each stage's total share and the spread of its calls."""
    stages = {name: times for name, times in assessment.record.cost.stages.items() if len(times)}
    if not stages:
        return None
    names = [phrase(name) for name in stages]
    height = 0.8 + 0.38 * len(stages)
    figure, ((totals, calls),) = panels(1, 2, height, left=room_for(names), sharey=True)
    bars = totals.barh(names, [float(np.sum(times)) for times in stages.values()], color=ACCENT)
    totals.bar_label(bars, fmt="%.2f", padding=3, color="#333a42")
    totals.margins(x=0.15)
    totals.set_xlabel("total [s]")
    for row, times in enumerate(stages.values()):
        low, middle, high, longest = 1e3 * np.quantile(times, [0.05, 0.5, 0.95, 1.0])
        calls.plot([low, high], [row, row], color=ACCENT, lw=5, alpha=0.35)
        calls.plot(middle, row, "o", color=ACCENT)
        calls.plot(longest, row, "|", color=MUTED, markersize=9, markeredgewidth=1.5)
    calls.set_xscale("log")
    calls.xaxis.set_major_formatter("{x:g}")
    calls.xaxis.set_minor_formatter("")
    calls.set_xlabel("one call [ms]")
    totals.invert_yaxis()
    for axes in (totals, calls):
        axes.grid(visible=False, axis="y")
    caption = (
        f"Left: time by stage; {assessment.record.bag.duration:.0f} s of mission took"
        f" {assessment.record.cost.wall:.1f} s in all. Right: one call of it: median (dot), 5 to"
        " 95 % (bar), longest (stroke)."
    )
    return Plate("timing", "Computing time by stage", caption, figure)
