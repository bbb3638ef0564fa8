# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The network of constraints: the paper's Figure 9."""

from collections import Counter
from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from msss_graphslam.core.types import Array, Constraint, ConstraintKind
from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.figures.panels import map_extent, map_figure
from msss_graphslam.evaluation.figures.style import (
    ACCENT,
    MUTED,
    REFUSALS,
    TRUTH,
    Plate,
    phrase,
)
from msss_graphslam.evaluation.figures.trajectories import draw_track

__all__ = ["network", "refusal_colours"]

# Of the legends: how many entries side by side, and a line's height [inch].
_COLUMNS, _LINE = 2, 0.18


def network(assessment: Assessment) -> Plate | None:
    """Draw the accepted constraints, and beside them the refused loop closures by reason."""
    estimate = assessment.record.estimate
    if len(estimate.keyframes) < 2:
        return None
    nodes = np.array([frame.pose[:2] for frame in estimate.keyframes])
    entries = max(4, 1 + len(refusal_colours(estimate.constraints)))
    header = 0.5 + _LINE * -(-entries // _COLUMNS)
    figure, (accepted, refused) = map_figure(map_extent(nodes, nodes), 2, header)
    if assessment.anchored_truth is not None:
        draw_track(accepted, assessment.anchored_truth, TRUTH, "ground truth", ":")
    _draw_accepted(accepted, nodes, estimate.constraints)
    _draw_refused(refused, nodes, estimate.constraints)
    for axes, title in ((accepted, "in the graph"), (refused, "refused")):
        axes.plot(*nodes.T, "o", color=MUTED, markersize=3.5, mew=0, zorder=4)
        _legend(axes, title)
    return Plate("network", "The constraint network", _caption(assessment), figure)


def refusal_colours(constraints: Iterable[Constraint]) -> dict[str, str]:
    """Return a colour for each reason of refused loop closures, the most frequent first."""
    reasons = Counter(
        edge.refusal for edge in constraints if edge.kind is ConstraintKind.LOOP and edge.refusal
    )
    ordered = sorted(reasons, key=lambda reason: (-reasons[reason], reason))
    return {
        reason: REFUSALS[min(number, len(REFUSALS) - 1)] for number, reason in enumerate(ordered)
    }


def _draw_accepted(axes: Axes, nodes: Array, constraints: Iterable[Constraint]) -> None:
    accepted = [edge for edge in constraints if edge.accepted]
    for kind, shade, width, name in (
        (ConstraintKind.LOOP, ACCENT, 0.7, "loop closures"),
        (ConstraintKind.ODOMETRY, "#b5bdc6", 2.6, "dead reckoning"),
        (ConstraintKind.CONSECUTIVE, TRUTH, 1.0, "consecutive scans"),
    ):
        _draw(axes, nodes, [edge for edge in accepted if edge.kind is kind], shade, name, width)


def _draw_refused(axes: Axes, nodes: Array, constraints: Iterable[Constraint]) -> None:
    constraints = list(constraints)
    colours = refusal_colours(constraints)
    for reason, shade in reversed(colours.items()):
        edges = [
            edge
            for edge in constraints
            if edge.refusal == reason and edge.kind is ConstraintKind.LOOP
        ]
        _draw(axes, nodes, edges, shade, phrase(reason), 0.5)
    others = [
        edge for edge in constraints if edge.refusal and edge.kind is not ConstraintKind.LOOP
    ]
    _draw(axes, nodes, others, TRUTH, "consecutive scans", 1.4)


def _draw(
    axes: Axes, nodes: Array, edges: list[Constraint], shade: str, name: str, width: float
) -> None:
    if edges:
        ends = nodes[[(edge.first, edge.second) for edge in edges]]
        alpha = float(np.clip(300.0 / len(edges), 0.06, 0.9))
        lines = LineCollection(
            list(ends), colors=shade, linewidths=width, alpha=alpha, label=f"{name} ({len(edges)})"
        )
        axes.add_collection(lines)


def _legend(axes: Axes, title: str) -> None:
    handles, names = axes.get_legend_handles_labels()
    legend = axes.legend(
        handles,
        names,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=_COLUMNS,
        title=title if names else f"{title}: none",
        alignment="left",
    )
    legend.get_title().set_fontweight("bold")
    for handle in legend.get_lines():
        handle.set(alpha=1.0, linewidth=2.0)


def _caption(assessment: Assessment) -> str:
    record = assessment.record
    far = sum(
        edge.second - edge.first > 20
        for edge in record.estimate.constraints
        if edge.accepted and edge.kind is ConstraintKind.LOOP
    )
    return (
        f"Dots are scans at their optimised poses. {record.accepted_loops} of {record.tried_loops}"
        f" loop closures were accepted, {far} of them between scans more than 20 apart,"
        " which are the ones that bound the drift."
    )
