# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The result table: one row an estimator, None where a figure is not known."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.types import Trajectory
from msss_graphslam.evaluation.assessment import DEAD_RECKONING, Assessment
from msss_graphslam.evaluation.errors import (
    PoseErrors,
    Statistics,
    position_errors,
    start_end_gap,
)
from msss_graphslam.results.directory import ResultDirectory

__all__ = ["ResultRow", "evaluate_directory", "result_table"]


@dataclass(frozen=True, slots=True)
class ResultRow:
    """One trajectory's figures: anchored and aligned errors [m], heading error [deg], gap [m].

    ``thickness`` is that of the map's walls [m]; ``left_out`` counts the poses at which the truth
    is silent.
    """

    name: str
    start_end_gap: float
    anchored: Statistics | None = None
    aligned: Statistics | None = None
    heading: Statistics | None = None
    thickness: float | None = None
    left_out: int = 0


def result_table(assessments: Sequence[Assessment]) -> list[ResultRow]:
    """Return dead reckoning first, then for each run its final and its online trajectory."""
    first = assessments[0]
    rows = [
        _row(
            DEAD_RECKONING,
            first.record.estimate.dead_reckoning,
            first.errors.get(DEAD_RECKONING),
            first.dead_reckoned_thickness,
        )
    ]
    for run in assessments:
        if run.estimator != DEAD_RECKONING:
            estimate, name = run.record.estimate, run.estimator
            rows += [
                _row(name, estimate.trajectory, run.errors.get(name), run.thickness),
                _row(f"{name}, online", estimate.online, run.online_errors),
            ]
    return rows


def evaluate_directory(directory: ResultDirectory, truth: Trajectory) -> list[ResultRow]:
    """Compare the trajectories that a run left with a truth; UserError where that cannot be."""
    corrected, online, dead_reckoning = directory.read_trajectories()
    return [
        _row(name, trajectory, position_errors(trajectory, truth, launched_as))
        for name, trajectory, launched_as in (
            (DEAD_RECKONING, dead_reckoning, dead_reckoning),
            ("trajectory", corrected, corrected),
            ("online", online, corrected),
        )
    ]


def _row(
    name: str,
    trajectory: Trajectory,
    errors: PoseErrors | None,
    thickness: float | None = None,
) -> ResultRow:
    gap = start_end_gap(trajectory)
    if errors is None:
        return ResultRow(name, gap, thickness=thickness)
    return ResultRow(
        name,
        gap,
        anchored=Statistics.of(errors.anchored),
        aligned=Statistics.of(errors.aligned),
        heading=Statistics.of(np.abs(np.degrees(errors.heading))),
        thickness=thickness,
        left_out=errors.left_out,
    )
