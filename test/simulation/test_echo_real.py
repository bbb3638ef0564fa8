# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The simulated head against what was measured on real ones; levels in dB throughout."""

from dataclasses import replace

import numpy as np
import pytest
from simulated_scenes import FAR_AWAY, OPEN_WATER, SETTINGS, SQUARE, facing_wall, levels, pings

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.decibels import codes_from_power, power_from_level
from msss_graphslam.simulation.echo_real import RealEchoes
from msss_graphslam.simulation.ray_casting import Walls
from msss_graphslam.simulation.scene import Pings
from msss_graphslam.simulation.settings import SonarSettings

RANGES = SETTINGS.ranges


def hear(
    outline: Array,
    beams: Pings,
    settings: SonarSettings = OPEN_WATER,
    *,
    rough: bool = True,
    seed: int = 4,
) -> Array:
    """The levels (b, bins) of beams before a wall."""
    return levels(RealEchoes(Walls.of([outline]), settings, rough, seed).codes(beams))


def bins(start: float, end: float) -> slice:
    return slice(*np.searchsorted(RANGES, [start, end]))


def whole_turn() -> Pings:
    bearings = SETTINGS.bearings(200)
    return Pings(np.zeros((200, 2)), bearings, bearings)


def wall_at(distance: float) -> Array:
    """A wall 20 m long at one side of the vehicle, as in the recording, and nothing else."""
    half, far = 10.0, 1e3
    return np.array(
        [[distance, -half], [distance, half], [far, far], [-far, far], [-far, -far], [far, -far]]
    )


def test_codes_are_half_decibels_packed_into_a_byte() -> None:
    codes = np.unique(RealEchoes(Walls.of([SQUARE]), SETTINGS, True, 1).codes(whole_turn()))
    lattice = [int(np.floor(k * 255 / 160)) for k in range(125)]
    assert set(codes.tolist()) <= set(lattice)
    assert len(codes) > 60


@pytest.mark.parametrize(
    ("decibels", "code"), [(-90.0, 0), (0.49, 0), (0.51, 1), (10.01, 31), (80.0, 255), (99.0, 255)]
)
def test_a_level_has_its_code(decibels: float, code: int) -> None:
    assert codes_from_power(power_from_level(decibels)) == code


def test_a_good_part_of_the_cells_is_zero_and_none_is_saturated() -> None:
    heard = hear(wall_at(6.5), whole_turn(), replace(SETTINGS, hull_shadow=np.radians(162.0)))
    assert 0.14 < np.mean(heard == 0.0) < 0.51
    assert heard.max() < 62.0


def test_the_near_field_of_a_free_bearing_is_gone_beyond_0_6_m() -> None:
    heard = hear(FAR_AWAY, pings(400))
    median = np.median(heard, axis=0)
    assert median[bins(0.2, 0.4)].max() == pytest.approx(27.0, abs=2.0)
    assert median[bins(0.65, 2.0)].max() < 12.0


def test_the_hull_rings_longer_and_differently_by_bearing() -> None:
    settings = replace(SETTINGS, hull_sector=np.radians(162.0))
    bearings = np.repeat(np.radians(np.arange(110.0, 251.0, 14.0)), 100)
    beams = Pings(np.zeros((len(bearings), 2)), bearings, bearings)
    heard = [hear(FAR_AWAY, beams, settings, seed=seed) for seed in range(8)]
    pooled = np.concatenate(heard)
    assert np.median(pooled, axis=0).max() == pytest.approx(35.0, abs=2.0)
    rings_to = [
        RANGES[bins(0.0, 2.0)][np.percentile(one, 95, axis=0)[bins(0.0, 2.0)] >= 12.0].max()
        for one in heard
    ]
    assert 1.1 <= np.mean(rings_to) <= 1.35
    for one in heard:
        medians = np.median(one.reshape(11, 100, -1), axis=1)
        assert np.ptp(medians[:, bins(0.6, 0.9)].mean(axis=1)) > 3.0


def test_the_floor_rises_by_a_decibel_a_metre_from_2_m_on() -> None:
    median = np.median(hear(FAR_AWAY, pings(400)), axis=0)
    assert median[bins(1.6, 2.0)].max() == 0.0
    assert 4.0 <= median[-5:].mean() <= 9.0
    slope = np.polyfit(RANGES[bins(5.0, 10.0)], median[bins(5.0, 10.0)], 1)[0]
    assert slope == pytest.approx(1.0, abs=0.3)


def test_the_floor_stays_level_at_long_range() -> None:
    settings = replace(OPEN_WATER, maximum_range=50.0, beam_period=0.078)
    median = np.median(hear(FAR_AWAY, pings(400), settings), axis=0)
    assert np.ptp(median[-150:]) < 1.5
    assert 4.0 <= median[-150:].mean() <= 9.0


@pytest.mark.parametrize(
    ("degrees", "measured"), [(0.0, 48.3), (30.0, 46.8), (50.0, 44.5), (65.0, 42.5)]
)
def test_a_walls_level_falls_slowly_with_incidence(degrees: float, measured: float) -> None:
    wall = facing_wall(7.0, np.radians(degrees))
    heard = hear(wall, pings(300))[:, bins(4.0, 9.5)]
    assert np.median(heard.max(axis=1)) == pytest.approx(measured, abs=2.0)


@pytest.mark.parametrize(
    ("rough", "lead_6", "tail_6", "lead_20", "tail_20"),
    [(True, 0.15, 0.2, 0.5, 1.0), (False, 0.05, 0.05, 0.13, 0.23)],
)
def test_an_echo_has_the_measured_shape(
    rough: bool, lead_6: float, tail_6: float, lead_20: float, tail_20: float
) -> None:
    power = power_from_level(hear(facing_wall(7.0, 0.0), pings(400), rough=rough)).mean(axis=0)
    level = 10.0 * np.log10(power)
    peak = int(np.argmax(level[40:])) + 40
    assert RANGES[peak] == pytest.approx(7.0, abs=0.06)

    def reach(drop: float, step: int) -> float:
        at = peak
        while level[at] > level[peak] - drop:
            at += step
        return float(abs(RANGES[at] - RANGES[peak]))

    assert reach(6.0, -1) == pytest.approx(lead_6, abs=0.08)
    assert reach(6.0, +1) == pytest.approx(tail_6, abs=0.08)
    assert reach(20.0, -1) == pytest.approx(lead_20, abs=0.15)
    assert reach(20.0, +1) == pytest.approx(tail_20, abs=0.25)


def test_speckle_is_gamma_of_three_to_five_looks() -> None:
    heard = hear(FAR_AWAY, pings(2000))[:, bins(8.5, 9.5)]
    power = power_from_level(heard)
    looks = power.mean() ** 2 / power.var()
    assert 3.0 < looks < 5.0
    power -= power.mean(axis=0)
    neighbours = np.mean(power[:, 1:] * power[:, :-1]) / np.mean(power**2)
    assert 0.1 < neighbours < 0.3


def test_a_wall_echo_varies_from_beam_to_beam_as_measured() -> None:
    peaks = hear(facing_wall(7.0, 0.0), pings(500))[:, bins(5.0, 9.0)].max(axis=1)
    assert 1.1 < peaks.std() < 1.8


def test_the_nearest_surface_rings_at_all_bearings_35_db_below() -> None:
    beams = whole_turn()
    heard = hear(wall_at(7.0), beams)
    ahead, ring = np.abs(beams.bearings) < 0.3, np.abs(beams.bearings) > 1.2
    strongest = np.median(heard[ahead][:, bins(6.5, 7.5)].max(axis=1))
    below = heard[ring][:, bins(6.9, 7.3)].max(axis=1) - strongest
    assert -40.0 < np.median(below) < -30.0
    before = np.median(heard[ring][:, bins(5.8, 6.2)])
    assert np.median(heard[ring][:, bins(6.9, 7.3)]) > before + 5.0
    assert np.median(heard[ring][:, bins(8.0, 9.0)]) > before + 2.0


def test_the_hull_mirrors_the_scene_16_to_21_db_below() -> None:
    settings = replace(SETTINGS, hull_shadow=np.radians(162.0))
    astern = np.radians(170.0)
    mirrored = np.radians(180.0 - 14.0 - 170.0)
    wall = facing_wall(6.5, 0.0)
    turn = np.array([[np.cos(mirrored), np.sin(mirrored)], [-np.sin(mirrored), np.cos(mirrored)]])
    image = hear(wall @ turn, pings(300, astern), settings)[:, bins(5.0, 8.0)].max(axis=1)
    scene = hear(wall @ turn, pings(300, mirrored), settings)[:, bins(5.0, 8.0)].max(axis=1)
    assert -22.0 < np.median(image) - np.median(scene) < -15.0


def test_a_hull_shadow_hides_wall_floor_and_specks() -> None:
    wall = 0.9 * SQUARE
    free, shadowed = (
        hear(wall, pings(200, np.pi), replace(SETTINGS, hull_sector=0.0, hull_shadow=shadow))
        for shadow in (0.0, np.radians(162.0))
    )
    at_wall = bins(5.2, 5.8)
    assert np.median(free[:, at_wall].max(axis=1)) > 44.0
    assert np.median(shadowed[:, at_wall].max(axis=1)) < 34.0
    assert shadowed[:, bins(2.0, 4.0)].max() == 0.0


@pytest.mark.parametrize(("degrees", "hidden"), [(98.0, False), (100.0, True), (-100.0, True)])
def test_the_shadow_has_its_edges_81_degrees_from_astern(degrees: float, hidden: bool) -> None:
    settings = replace(SETTINGS, hull_shadow=np.radians(162.0))
    heard = hear(facing_wall(6.0, 0.0), pings(100, np.radians(degrees), azimuth=0.0), settings)
    assert (np.median(heard[:, bins(5.5, 6.5)].max(axis=1)) < 35.0) == hidden


def test_a_second_bounce_comes_10_db_below_at_twice_the_range() -> None:
    heard = hear(facing_wall(4.0, 0.0), pings(300))
    first = np.median(heard[:, bins(3.5, 4.5)].max(axis=1))
    second = np.median(heard[:, bins(7.5, 8.5)].max(axis=1))
    assert second - first == pytest.approx(-10.0, abs=1.5)


def test_specks_lie_before_the_wall_and_more_of_them_near_it() -> None:
    heard = hear(facing_wall(9.0, 0.0), pings(3000))
    speck = heard >= 14.0
    starts = speck & ~np.roll(speck, 1, axis=1)
    near, far = starts[:, bins(5.0, 7.0)].mean(0).sum(), starts[:, bins(1.5, 3.5)].mean(0).sum()
    assert near > 2.0 * far
    assert 0.2 < starts[:, bins(1.5, 7.5)].mean(0).sum() / 6.0 < 0.7
    assert not (hear(FAR_AWAY, pings(500))[:, bins(1.5, 5.0)] >= 14.0).any()


def test_a_beam_wider_than_its_wall_is_pulled_in_at_grazing_incidence() -> None:
    def edge(degrees: float) -> float:
        heard = hear(facing_wall(4.0, np.radians(degrees)), pings(300), rough=False)
        power = power_from_level(heard).mean(axis=0)
        rising = np.flatnonzero(power[40:] > power[40:].max() * power_from_level(-6.0))[0] + 40
        return float(RANGES[rising])

    assert 0.05 < edge(0.0) - edge(65.0) < 0.25
