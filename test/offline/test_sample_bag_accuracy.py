# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The golden run: the sample bag through every estimator, held to limits of accuracy."""

from pathlib import Path

import pytest

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.evaluation.assessment import Assessment, assess
from msss_graphslam.evaluation.errors import Statistics, start_end_gap
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.reader import open_recording

pytestmark = pytest.mark.slow

SAMPLE = Path(__file__).parents[2] / "bags" / "pond"


def assessed(name: str) -> Assessment:
    recording = open_recording(SAMPLE)
    return assess(estimate(recording, ESTIMATORS[name], Configuration(), lambda *_: None))


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [("dead_reckoning", 4.0, 6.0), ("uspic", 0.5, 2.0), ("chen2015", 0.2, 1.3)],
)
def test_the_papers_methods_err_as_much_as_they_do(name: str, least: float, most: float) -> None:
    mean = Statistics.of(assessed(name).errors[name].anchored).mean
    assert least < mean < most


def test_full_is_far_more_accurate() -> None:
    assessment = assessed("full")
    errors = assessment.errors["full"]
    assert Statistics.of(errors.anchored).mean < 0.10
    assert Statistics.of(errors.aligned).mean < 0.03
    assert assessment.online_errors is not None
    assert Statistics.of(assessment.online_errors.anchored).mean < 0.15
    assert start_end_gap(assessment.record.estimate.trajectory) < 0.2
