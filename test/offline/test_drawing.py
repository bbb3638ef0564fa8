# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Figures drawn by copies of this process: the same ones, whatever becomes of them."""

import os
import signal

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


def test_the_figures_are_those_drawn_here_in_the_same_order(
    assessment: Assessment, expected: list[Picture], monkeypatch: pytest.MonkeyPatch
) -> None:
    drawing = Drawing(assessment)
    monkeypatch.setattr(module, "_share", None)
    assert drawing.pictures() == expected


@pytest.mark.parametrize("number", [0, 1])
def test_a_copy_that_is_killed_costs_no_figure(
    number: int, assessment: Assessment, expected: list[Picture]
) -> None:
    drawing = Drawing(assessment)
    os.kill(drawing._copies[number]._pid, signal.SIGKILL)
    assert drawing.pictures() == expected


def test_copies_that_fail_cost_no_figure_and_never_come_back_here(
    assessment: Assessment, expected: list[Picture], monkeypatch: pytest.MonkeyPatch
) -> None:
    here, share = os.getpid(), module._share

    def fail_in_copies(of: Assessment, number: int) -> list[Picture | None]:
        if os.getpid() != here:
            raise RuntimeError("no font")
        return share(of, number)

    monkeypatch.setattr(module, "_share", fail_in_copies)
    assert Drawing(assessment).pictures() == expected
    assert os.getpid() == here


def test_no_copy_is_left(assessment: Assessment) -> None:
    drawing = Drawing(assessment)
    drawing.pictures()
    for copy in drawing._copies:
        with pytest.raises(ProcessLookupError):
            os.kill(copy._pid, 0)
