# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Figures drawn by another process: the same ones, whatever becomes of it."""

import pytest
from synthetic_run import synthetic_run

from msss_graphslam.evaluation.assessment import Assessment, assess
from msss_graphslam.evaluation.pictures import Picture, run_pictures
from msss_graphslam.offline import drawing as module
from msss_graphslam.offline.drawing import Drawing


@pytest.fixture(scope="module")
def assessment() -> Assessment:
    return assess(synthetic_run(6))


@pytest.fixture(scope="module")
def expected(assessment: Assessment) -> list[Picture]:
    return run_pictures(assessment)


def test_the_figures_are_those_drawn_here(
    assessment: Assessment, expected: list[Picture], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("msss_graphslam.evaluation.pictures.run_pictures", None)
    with Drawing() as drawing:
        drawing.begin(assessment)
        assert drawing.pictures() == expected


@pytest.mark.parametrize("name", ["no.such.module", "this", "msss_graphslam"])
def test_a_process_that_fails_costs_no_figure(
    name: str, assessment: Assessment, expected: list[Picture], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_MODULE", name)
    with Drawing() as drawing:
        drawing.begin(assessment)
        assert drawing.pictures() == expected


def test_a_process_that_nothing_is_asked_of_ends() -> None:
    with Drawing() as drawing:
        process = drawing._process
    assert process.returncode is not None


def test_a_process_ends_where_the_work_beside_it_fails(assessment: Assessment) -> None:
    with pytest.raises(RuntimeError, match="beside"), Drawing() as drawing:
        process = drawing._process
        drawing.begin(assessment)
        raise RuntimeError("beside")
    assert process.returncode is not None


def test_figures_that_were_not_begun_are_an_error() -> None:
    with Drawing() as drawing, pytest.raises(ValueError, match="begun"):
        drawing.pictures()
