# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss run`` and ``msss compare``: from a bag to a directory of results."""

from pathlib import Path

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.report import write_comparison_report, write_report
from msss_graphslam.offline.estimation import Progress, estimate
from msss_graphslam.offline.estimators import recipe_named
from msss_graphslam.offline.writing import write_results
from msss_graphslam.recordings.reader import Recording, open_recording
from msss_graphslam.results.directory import ResultDirectory
from msss_graphslam.results.record import RunRecord

__all__ = ["compare", "run"]


def run(
    bag: Path, output: Path, estimator: str, configuration: Configuration, progress: Progress
) -> RunRecord:
    """Run one estimator over a bag and write every result into ``output``."""
    recipe = recipe_named(estimator)
    recording = open_recording(bag)
    directory = ResultDirectory.create(output)
    record = estimate(recording, recipe, configuration, progress)
    progress(0.95, "report")
    write_report(directory, write_results(record, directory))
    progress(1.0, "done")
    return record


def compare(
    bag: Path, output: Path, configuration: Configuration, progress: Progress
) -> list[RunRecord]:
    """Run every estimator; one directory each under ``output`` and one report of all."""
    recording = open_recording(bag)
    directory = ResultDirectory.create(output)
    assessments = [
        _compared(recording, name, number, output, configuration, progress)
        for number, name in enumerate(ESTIMATORS)
    ]
    progress(0.95, "report")
    write_comparison_report(directory, assessments)
    progress(1.0, "done")
    return [assessment.record for assessment in assessments]


def _compared(
    recording: Recording,
    name: str,
    number: int,
    output: Path,
    configuration: Configuration,
    progress: Progress,
) -> Assessment:
    def share(fraction: float, _: str) -> None:
        progress(0.95 * (number + fraction) / len(ESTIMATORS), name)

    record = estimate(recording, ESTIMATORS[name], configuration, share)
    return write_results(record, ResultDirectory.create(output / name))
