# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The figures that a report begins with."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.types import SonarCalibration
from msss_graphslam.evaluation.assessment import DEAD_RECKONING, Assessment
from msss_graphslam.evaluation.errors import Statistics, start_end_gap
from msss_graphslam.evaluation.wording import phrase

__all__ = ["Headline", "headlines"]


@dataclass(frozen=True, slots=True)
class Headline:
    """One figure with its name and a line that puts it into proportion."""

    name: str
    value: str
    note: str


def headlines(assessments: Sequence[Assessment]) -> list[Headline]:
    """Return what a reader wants to know first of the last run given."""
    run = assessments[-1]
    record = run.record
    refused = sum(record.refused.values())
    return [
        _accuracy(run),
        Headline(
            "loop closures",
            f"{record.accepted_loops}",
            f"accepted of {record.tried_loops} tried, {len(record.estimate.keyframes)} scans",
        ),
        Headline(
            "real time",
            f"{record.realtime_factor:.0f}\u00d7",
            f"{record.bag.duration:.0f} s of mission in {record.cost.wall:.1f} s,"
            f" {record.cost.peak_rss_mib:.0f} MiB",
        ),
        Headline(
            "refused data",
            f"{refused}",
            f"in {len(record.refused)} ways, {record.beams} beams used" if refused else "none",
        ),
        *_calibration(record.estimate.sonar_calibration),
    ]


def _calibration(found: SonarCalibration | None) -> list[Headline]:
    if found is None:
        return []
    yaw, scale = found.deviations
    note = (
        f"\u00b1 {np.degrees(yaw):.1f}\u00b0; ranges \u00d7 {found.scale:.3f} \u00b1 {scale:.3f}"
    )
    return [Headline("head against DVL", f"{np.degrees(found.yaw):+.1f}\u00b0", note)]


def _accuracy(run: Assessment) -> Headline:
    if run.errors:
        mean = Statistics.of(run.errors[run.estimator].anchored).mean
        reference = Statistics.of(run.errors[DEAD_RECKONING].anchored).mean
        note = f"{phrase(run.estimator)}; dead reckoning {reference:.2f} m"
        return Headline("mean position error", f"{mean:.2f} m", note)
    estimate = run.record.estimate
    gap = start_end_gap(estimate.dead_reckoning)
    return Headline(
        "start to end",
        f"{start_end_gap(estimate.trajectory):.2f} m",
        f"by {phrase(run.estimator)}; {gap:.2f} m by dead reckoning; no ground truth",
    )
