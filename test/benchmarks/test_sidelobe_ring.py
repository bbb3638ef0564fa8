# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The sidelobe ring: where it is found, and the page about it."""

import numpy as np
import pytest

from benchmarks.campaign import Provenance
from benchmarks.ring_finding import BLANK, RISE, WINDOW, nearest_wall, ring_range
from benchmarks.sidelobe_ring import HEADER, deviation, ring_page
from msss_graphslam.core.types import Array
from msss_graphslam.simulation.ray_casting import Walls

RANGES = np.arange(0.05, 10.0, 0.05)


def heard(*surfaces: tuple[float, float, slice], floor: float = 2.0) -> Array:
    """Return levels (w, k) [dB]: surfaces by range, level and beams, over a floor."""
    rng = np.random.default_rng(1)
    levels = np.maximum(floor + rng.normal(0.0, 1.0, (WINDOW, len(RANGES))), 0.0)
    for distance, level, beams in surfaces:
        levels[beams] = np.maximum(
            levels[beams], level * np.exp(-(((RANGES - distance) / 0.2) ** 2))
        )
    return levels


EVERY, FEW = slice(None), slice(0, WINDOW // 3)


@pytest.mark.parametrize("distance", [1.8, 3.0, 7.5])
def test_the_ring_is_where_all_beams_rise(distance: float) -> None:
    """At its leading edge: the -6 dB point of a crest of 0.2 m."""
    found = ring_range(heard((distance, 15.0, EVERY)), RANGES)
    assert distance - 0.25 < found < distance


def test_a_wall_that_few_beams_meet_is_no_ring() -> None:
    found = ring_range(heard((3.0, 50.0, FEW), (5.0, 15.0, EVERY)), RANGES)
    assert 4.7 < found < 5.0


def test_the_nearer_of_two_is_taken() -> None:
    found = ring_range(heard((3.0, 15.0, EVERY), (5.0, 40.0, EVERY)), RANGES)
    assert 2.7 < found < 3.0


@pytest.mark.parametrize(
    "levels",
    [
        np.zeros((WINDOW, len(RANGES))),
        heard(),
        heard((3.0, 50.0, FEW)),
        heard((BLANK - 0.5, 30.0, EVERY)),
        heard((3.0, 0.5 * RISE, EVERY)),
    ],
    ids=["silence", "noise", "a few beams", "the hull", "too weak"],
)
def test_without_a_ring_nothing_is_found(levels: Array) -> None:
    assert np.isnan(ring_range(levels, RANGES))


def test_the_nearest_wall_may_be_a_corner() -> None:
    walls = Walls.of([np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.0, 8.0]])])
    positions = np.array([[4.0, 1.0], [9.5, 4.0], [-3.0, -4.0], [5.0, 7.0]])
    distances, azimuths = nearest_wall(positions, walls)
    np.testing.assert_allclose(distances, [1.0, 0.5, 5.0, 1.0])
    expected = [-0.5 * np.pi, 0.0, np.arctan2(4.0, 3.0), 0.5 * np.pi]
    np.testing.assert_allclose(azimuths, expected)


def test_a_few_outliers_do_not_make_the_deviation() -> None:
    values = np.random.default_rng(1).normal(3.0, 0.1, 2000)
    values[:100] = 50.0
    assert deviation(values) == pytest.approx(0.1, rel=0.15)


@pytest.mark.parametrize("given", [True, False])
def test_the_page_shows_recordings_only_where_some_were_given(*, given: bool) -> None:
    row = ["pond, ring", "10", "90 %", "80 %", "-0.030", "0.020"]
    recorded = [["tank", *row[1:]]] if given else []
    page = ring_page([row], recorded, Provenance("python -m some.command", "1.2.3", "0123abcd"))
    assert "| pond, ring | 10 | 90 % | 80 % | -0.030 | 0.020 |" in page
    assert ("| tank |" in page) == ("## Recorded" in page) == given
    assert "`python -m some.command`" in page
    assert len(row) == len(HEADER)
    assert "{" not in page
