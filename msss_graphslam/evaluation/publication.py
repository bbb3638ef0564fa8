# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Everything that a run leaves behind, in one call."""

from collections.abc import Sequence

from msss_graphslam.evaluation.assessment import Assessment, assess
from msss_graphslam.evaluation.report import write_comparison_report, write_report
from msss_graphslam.evaluation.summary import summarise
from msss_graphslam.results.directory import ResultDirectory
from msss_graphslam.results.record import RunRecord

__all__ = ["publish", "publish_comparison"]


def publish(directory: ResultDirectory, record: RunRecord) -> Assessment:
    """Write all files of a run, and return what was measured of it."""
    assessment = assess(record)
    directory.write_estimate(record)
    directory.write_summary(summarise(assessment))
    write_report(directory, assessment)
    return assessment


def publish_comparison(directory: ResultDirectory, assessments: Sequence[Assessment]) -> None:
    """Write the report on several estimators' runs, and their summaries by estimator."""
    directory.write_summary({run.estimator: summarise(run) for run in assessments})
    write_comparison_report(directory, assessments)
