# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from simulated_scenes import FAR_AWAY, OPEN_WATER, facing_wall, levels, pings

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.echo_ideal import IdealEchoes
from msss_graphslam.simulation.ray_casting import Walls

RANGES = OPEN_WATER.ranges
BEAMS = 8000


def hear(outline: Array, beams: int = BEAMS) -> Array:
    return levels(IdealEchoes(Walls.of([outline]), OPEN_WATER, seed=2).codes(pings(beams)))


def echoes_near(heard: Array, distance: float) -> Array:
    return heard[:, np.abs(RANGES - distance) < 0.2].max(axis=1) > 35.0


def test_the_pulse_is_a_clean_bell_about_the_wall() -> None:
    heard = hear(facing_wall(3.0, 0.0))
    peaks = RANGES[heard[:, :70].argmax(axis=1)]
    peaks = peaks[np.abs(peaks - 3.0) < 0.2]
    assert peaks.mean() == pytest.approx(3.0, abs=0.01)
    # The jitter of 0.03 m and the bins of 0.05 m.
    assert peaks.std() == pytest.approx(np.hypot(0.03, 0.05 / np.sqrt(12.0)), abs=0.01)


@pytest.mark.parametrize(
    ("degrees", "lost", "tolerance"), [(0.0, 0.02, 0.01), (72.0, 0.5, 0.03), (85.0, 0.98, 0.02)]
)
def test_echoes_are_lost_at_grazing_incidence(
    degrees: float, lost: float, tolerance: float
) -> None:
    heard = hear(facing_wall(3.0, np.radians(degrees)))
    window = (RANGES > 1.5) & (RANGES < 3.3)
    quiet = heard[:, window].max(axis=1) < 28.0
    others = 1.0 - 0.03 * 1.8 / 10.0
    assert quiet.mean() == pytest.approx(lost * others, abs=tolerance)


def test_outliers_multipath_and_arcs_come_at_their_rates() -> None:
    """Before the wall there are outliers and arcs alone; the multipath lies 0.5 to 5 m behind."""
    heard = hear(facing_wall(4.0, 0.0), 40_000)
    before = (heard[:, (RANGES > 0.3) & (RANGES < 3.3)] > 35.0).any(axis=1)
    arc_beams = 0.4 / 200.0 * 9.0
    assert before.mean() == pytest.approx((0.03 + arc_beams) * 0.3, rel=0.25)
    behind = (heard[:, (RANGES > 4.5) & (RANGES < 9.2)] > 30.0).any(axis=1)
    assert behind.mean() == pytest.approx(0.35, abs=0.06)


def test_cross_talk_stays_at_one_range_for_some_beams() -> None:
    model = IdealEchoes(Walls.of([FAR_AWAY]), OPEN_WATER, seed=3)
    ranges = model._arcs(50_000)
    begins = 1 + np.flatnonzero(np.isfinite(ranges[1:]) & (ranges[1:] != ranges[:-1]))
    assert len(begins) == pytest.approx(0.4 * 50_000 / 200, rel=0.3)
    lengths = [np.flatnonzero(ranges[k:] != ranges[k])[0] for k in begins[:-1]]
    assert np.mean(np.array(lengths) >= 4) > 0.9
    assert max(lengths) <= 14


def test_codes_are_half_decibels_here_too() -> None:
    codes = IdealEchoes(Walls.of([facing_wall(4.0, 0.0)]), OPEN_WATER, 1).codes(pings(300))
    lattice = [int(np.floor(k * 255 / 160)) for k in range(161)]
    assert set(np.unique(codes).tolist()) <= set(lattice)
