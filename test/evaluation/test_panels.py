# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Nothing that a figure says is cut off, and no panel's labels or legend lie on another panel."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from synthetic_run import synthetic_run

from msss_graphslam.evaluation.assessment import assess
from msss_graphslam.evaluation.figures.panels import map_figure, panels, room_for
from msss_graphslam.evaluation.figures.plates import comparison_plates, run_plates
from msss_graphslam.evaluation.pictures import DPI


def stretched(trajectory, factors):
    poses = trajectory.poses.copy()
    poses[:, :2] *= factors
    return replace(trajectory, poses=poses)


def run_of(estimator, factors, truth=True):
    record = synthetic_run(12)
    estimate = record.estimate
    ways = ("trajectory", "online", "dead_reckoning")
    drawn = replace(
        estimate,
        estimator=estimator,
        keyframes=tuple(
            replace(frame, pose=frame.pose * [*factors, 1.0]) for frame in estimate.keyframes
        ),
        **{name: stretched(getattr(estimate, name), factors) for name in ways},
    )
    shown = record.truth if truth else None
    return assess(replace(record, estimate=drawn, truth=shown and stretched(shown, factors)))


def boxes(figure):
    """Return what each panel takes with its labels, title and legend [pixels]."""
    figure.set_dpi(DPI)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    seen = [axes for axes in figure.axes if axes.get_visible()]
    return [axes.get_tightbbox(canvas.get_renderer()) for axes in seen]


@pytest.mark.parametrize("factors", [(1.0, 1.0), (8.0, 1.0), (1.0, 8.0), (30.0, 1.0), (1e3, 1e3)])
@pytest.mark.parametrize("truth", [True, False])
def test_everything_has_room(factors, truth):
    names = ("uspic", "chen2015", "full")
    runs = [run_of(name, np.array(factors), truth) for name in names]
    for plate in (*run_plates(runs[-1]), *comparison_plates(runs)):
        found = boxes(plate.figure)
        page = plate.figure.bbox
        for box in found:
            assert box.x0 >= 0.0, plate.name
            assert box.y0 >= 0.0, plate.name
            assert box.x1 <= page.x1, plate.name
            assert box.y1 <= page.y1, plate.name
        for one, other in combinations(found, 2):
            assert not one.overlaps(other), plate.name


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("extent", [(30.0, 13.0), (13.0, 30.0), (300.0, 2.0)])
def test_maps_have_the_scale_of_both_axes_in_common(count, extent):
    figure, grid = map_figure(np.array([[0.0, 0.0], extent]), count)
    assert len(grid) == count
    FigureCanvasAgg(figure).draw()
    for axes in grid:
        box = axes.get_window_extent()
        assert box.width / box.height == pytest.approx(extent[0] / extent[1], rel=1e-6)


def test_panels_are_as_large_as_asked_for():
    figure, grid = panels(2, 2, 4.0, left=1.0, between=(0.5, 1.0))
    box = grid[0, 0].get_position()
    width, height = figure.get_size_inches()
    assert box.height * height == pytest.approx(1.5)
    below = grid[1, 0].get_position()
    assert (box.y0 - below.y1) * height == pytest.approx(1.0)
    beside = grid[0, 1].get_position()
    assert (beside.x0 - box.x1) * width == pytest.approx(0.5)
    assert box.x0 * width == pytest.approx(1.0)


def test_the_longest_name_decides_the_room():
    assert room_for(["a", "abcdefgh"]) > room_for(["a", "abcd"]) > room_for([])
