# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from synthetic_run import synthetic_run, without_keyframes

from msss_graphslam.core.maps.mapping import OccupancyGrid
from msss_graphslam.core.types import Beam
from msss_graphslam.evaluation.assessment import assess
from msss_graphslam.evaluation.figures.closures import closures
from msss_graphslam.evaluation.figures.network import refusal_colours
from msss_graphslam.evaluation.figures.plates import comparison_plates, png, run_plates
from msss_graphslam.evaluation.figures.style import colour
from msss_graphslam.results.record import example_scan

ALWAYS = ["trajectories", "maps", "occupancy"]
REST = ["scan", "network", "closures", "uncertainty", "timing"]


@pytest.fixture(scope="module")
def assessment():
    return assess(synthetic_run(6))


@pytest.fixture(scope="module")
def plates(assessment):
    return {plate.name: plate for plate in run_plates(assessment)}


def with_beams(record):
    """Keep the beams of the example scan, as a runner does."""
    frame = record.estimate.keyframes[example_scan(record.estimate)]
    ranges = np.linspace(0.1, 20.0, 50)
    beams = [
        Beam(int(stamp), bearing, ranges, np.full(50, 40.0))
        for stamp, bearing in zip(
            frame.scan.beam_stamps_ns, np.linspace(-np.pi, np.pi, 60), strict=True
        )
    ]
    return replace(record, example_beams=tuple(beams))


def test_a_run_with_truth_has_every_figure(plates):
    assert list(plates) == [*ALWAYS, "errors", *REST]


def test_without_truth_the_errors_give_way_to_the_corrections():
    plates = {
        plate.name: plate for plate in run_plates(assess(synthetic_run(6, with_truth=False)))
    }
    assert list(plates) == [*ALWAYS, "corrections", *REST]
    for plate in plates.values():
        words = [text.get_text() for axes in plate.figure.axes for text in axes.texts]
        words += [axes.get_ylabel() for axes in plate.figure.axes]
        legends = [axes.get_legend() for axes in plate.figure.axes if axes.get_legend()]
        words += [text.get_text() for legend in legends for text in legend.get_texts()]
        assert not [word for word in words if "error" in word or word == "ground truth"]


def test_every_axis_says_what_it_shows_and_in_which_unit(plates):
    countable = {"loop closures", "accepted loop closures", "scans between its two ends", ""}
    for plate in plates.values():
        for axes in plate.figure.axes:
            for text in (axes.get_xlabel(), axes.get_ylabel()):
                assert "[" in text or text in countable, (plate.name, text)
        labels = [axes.get_xlabel() for axes in plate.figure.axes]
        assert any(labels)


def test_captions_are_sentences(plates):
    for plate in plates.values():
        assert plate.caption.endswith(".")
        assert "_" not in plate.caption


def test_maps_have_equal_scales(plates):
    for name in (*ALWAYS, "scan", "network"):
        assert all(axes.get_aspect() == 1.0 for axes in plates[name].figure.axes), name


def test_the_trajectory_figure_shows_truth_and_both_estimates(assessment, plates):
    (axes,) = plates["trajectories"].figure.axes
    lines = {line.get_label(): line for line in axes.get_lines()}
    assert {"dead reckoning", "full", "ground truth", "start", "end"} <= set(lines)
    drawn = np.column_stack(lines["full"].get_data())
    np.testing.assert_array_equal(drawn, assessment.record.estimate.trajectory.planar[:, :2])


def test_the_errors_drawn_are_the_errors_measured(assessment, plates):
    position, _ = plates["errors"].figure.axes
    lines = {line.get_label(): line.get_ydata() for line in position.get_lines()}
    for name in ("dead reckoning", "full"):
        measured = assessment.errors[name.replace(" ", "_")].anchored
        np.testing.assert_array_equal(lines[name], measured)


def test_the_bars_of_the_closures_add_up(assessment):
    fates, _ = closures(assessment).figure.axes
    widths = [int(bar.get_width()) for bar in fates.patches]
    assert widths[0] == assessment.record.accepted_loops
    assert sum(widths) == assessment.record.tried_loops


def test_estimators_and_reasons_have_colours_of_their_own(assessment):
    names = ("dead_reckoning", "uspic", "chen2015", "full")
    assert len({colour(name) for name in names}) == 4
    reasons = refusal_colours(assessment.record.estimate.constraints)
    assert set(reasons) == {"mahalanobis_distance", "shape_distance"}
    assert len(set(reasons.values())) == 2


def test_the_sonar_image_needs_the_beams(assessment):
    plates = [plate.name for plate in run_plates(assess(with_beams(assessment.record)))]
    assert "echoes" in plates


def test_a_recording_of_less_than_a_turn_still_has_figures(assessment):
    record = replace(
        without_keyframes(assessment.record),
        grid=OccupancyGrid(np.zeros((0, 0), dtype=np.int8), 0.1, np.zeros(2)),
    )
    plates = run_plates(assess(record))
    assert [plate.name for plate in plates] == ["trajectories", "maps", "errors", "timing"]
    assert all(png(plate, 150) for plate in plates)


def test_a_comparison_shows_all_estimators_in_one_set_of_figures():
    names = ("dead_reckoning", "uspic", "chen2015", "full")
    plates = comparison_plates([assess(synthetic_run(3, estimator=name)) for name in names])
    assert [plate.name for plate in plates] == ["trajectories", "errors", "maps"]
    titles = [axes.get_title("left") for axes in plates[2].figure.axes]
    assert titles == ["dead reckoning", "uspic", "chen2015", "full"]
