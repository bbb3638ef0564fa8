# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Loop closures: how many were accepted, and why the others were not."""

from collections import Counter

import numpy as np
from matplotlib.axes import Axes

from msss_graphslam.core.types import Constraint, ConstraintKind
from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.figures.network import refusal_colours
from msss_graphslam.evaluation.figures.panels import panels, room_for
from msss_graphslam.evaluation.figures.style import ACCENT, Plate, phrase

__all__ = ["closures"]


def closures(assessment: Assessment) -> Plate | None:
    """Draw the fates of the loop closures, and how far apart the accepted ones lie."""
    loops = [
        edge for edge in assessment.record.estimate.constraints if edge.kind is ConstraintKind.LOOP
    ]
    if not loops:
        return None
    colours = {"": ACCENT} | refusal_colours(loops)
    names = ["accepted" if not reason else phrase(reason) for reason in colours]
    figure, ((fates, spans),) = panels(
        1, 2, 2.6, left=room_for(names), between=(0.8, 0.0), width_ratios=(3, 2)
    )
    _draw_fates(fates, loops, colours, names)
    _draw_spans(spans, [edge.second - edge.first for edge in loops if edge.accepted])
    caption = (
        "Left: what became of every loop closure that was tried. Right: the number of scans"
        " between the ends of the accepted ones; long spans tie the rounds together."
    )
    return Plate("closures", "Loop closures, accepted and refused", caption, figure)


def _draw_fates(
    axes: Axes, loops: list[Constraint], colours: dict[str, str], names: list[str]
) -> None:
    counts = Counter(edge.refusal for edge in loops)
    bars = axes.barh(names, [counts[reason] for reason in colours], color=list(colours.values()))
    axes.bar_label(bars, padding=3, color="#333a42")
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    axes.margins(x=0.12)
    axes.set_xlabel("loop closures")


def _draw_spans(axes: Axes, spans: list[int]) -> None:
    if spans:
        edges = np.linspace(0.0, max(spans) + 1.0, min(max(spans) + 1, 25) + 1)
        axes.hist(spans, bins=list(edges), color=ACCENT, rwidth=0.9)
    axes.set_xlabel("scans between its two ends")
    axes.set_ylabel("accepted loop closures")
    axes.grid(visible=False, axis="x")
