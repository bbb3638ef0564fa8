# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.config.groups import Segmentation
from msss_graphslam.core.echoes.echo_background import NoiseFloor, Ringing

CONFIG = Segmentation()
RANGES = 0.05 * (np.arange(100) + 0.5)
NEAR = int(np.searchsorted(RANGES, CONFIG.ringing_range))


def heard(ringing, levels, bearing):
    return ringing.update(levels[None], np.array([bearing]))[0]


def test_the_floor_finds_the_median_of_the_noise():
    generator = np.random.default_rng(1)
    gain = np.linspace(3.0, 9.0, 100)
    floor = NoiseFloor(100)
    for _ in range(300):
        estimate = floor.update((gain + generator.normal(0.0, 2.0, 100))[None])[0]
    assert estimate == pytest.approx(gain, abs=1.5)


def test_the_floor_never_falls_with_the_range():
    generator = np.random.default_rng(2)
    floor = NoiseFloor(60)
    for _ in range(50):
        estimate = floor.update(generator.uniform(0.0, 40.0, (1, 60)))[0]
        assert np.all(np.diff(estimate) >= 0.0)


def test_a_wall_that_stays_does_not_lift_the_floor():
    levels = np.full(100, 4.0)
    levels[50:55] = 50.0
    floor = NoiseFloor(100)
    for _ in range(1000):
        estimate = floor.update(levels[None])[0]
    assert estimate == pytest.approx(np.full(100, 4.0), abs=0.2)


def test_the_first_turn_starts_with_the_configured_ringing():
    ringing = heard(Ringing(RANGES, CONFIG), np.full(100, 80.0), 0.0)
    assert ringing.size == NEAR
    assert ringing[RANGES[:NEAR] < CONFIG.hull_distance] == pytest.approx(
        CONFIG.transducer_ringing
    )
    assert ringing.max() == CONFIG.hull_ringing
    assert ringing[-1] < 5.0


def test_ringing_is_learned_where_the_hull_is_and_relaxed_elsewhere():
    hull, free = np.full(100, 30.0), np.zeros(100)
    ringing = Ringing(RANGES, CONFIG)
    for _ in range(400):
        at_hull = heard(ringing, hull, 3.0)
        at_sea = heard(ringing, free, 0.0)
    plateau = (RANGES[:NEAR] > 0.3) & (RANGES[:NEAR] < 0.9)
    assert np.all(at_hull[plateau] > 30.0)
    assert np.all(at_sea[plateau] < 10.0)


def test_a_wall_before_a_vehicle_at_rest_is_not_learned_away():
    ringing = Ringing(RANGES, CONFIG)
    for _ in range(100):
        learned = heard(ringing, np.full(100, 48.0), 1.0)
    assert np.all(learned <= CONFIG.hull_ringing)


@pytest.mark.parametrize("block", [1, 7, 60])
def test_what_is_learned_does_not_depend_on_how_many_beams_come_at_once(block):
    generator = np.random.default_rng(6)
    levels = generator.uniform(0.0, 60.0, (60, 100))
    bearings = generator.uniform(-np.pi, np.pi, 60)
    floor, ringing = NoiseFloor(100), Ringing(RANGES, CONFIG)
    parts = [slice(start, start + block) for start in range(0, 60, block)]
    floors = np.concatenate([floor.update(levels[part]) for part in parts])
    rings = np.concatenate([ringing.update(levels[part], bearings[part]) for part in parts])
    np.testing.assert_array_equal(floors, slow_floors(levels))
    np.testing.assert_array_equal(rings, slow_ringing(levels, bearings))


def slow_floors(levels):
    """Bin by bin: up by the step, down by the step, and never above what lies behind."""
    median, floors = np.zeros(levels.shape[1]), []
    for number, beam in enumerate(levels, start=1):
        step = max(5.0 / number, 0.1)
        for place, level in enumerate(beam):
            median[place] += step * (int(level > median[place]) - int(level < median[place]))
        floors.append([median[place:].min() for place in range(median.size)])
    return np.array(floors)


def slow_ringing(levels, bearings):
    first = heard(Ringing(RANGES, CONFIG), np.full(RANGES.size, 80.0), 0.0)
    sectors, learned = {}, []
    for beam, bearing in zip(levels, bearings, strict=True):
        sector = int(bearing / (2.0 * np.pi) % 1.0 * 50) % 50
        ringing = sectors.setdefault(sector, first.copy())
        for place, highest in enumerate(first):
            change = 3.0 if beam[place] + 6.0 > ringing[place] else -0.1
            ringing[place] = min(ringing[place] + change, highest)
        learned.append(ringing.copy())
    return np.array(learned)
