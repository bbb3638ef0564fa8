# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.config.groups import Segmentation
from msss_graphslam.core.echo_background import NoiseFloor, Ringing

CONFIG = Segmentation()
RANGES = 0.05 * (np.arange(100) + 0.5)
NEAR = int(np.searchsorted(RANGES, CONFIG.ringing_range))


def test_the_floor_finds_the_median_of_the_noise():
    generator = np.random.default_rng(1)
    gain = np.linspace(3.0, 9.0, 100)
    floor = NoiseFloor(100)
    for _ in range(300):
        estimate = floor.update(gain + generator.normal(0.0, 2.0, 100))
    assert estimate == pytest.approx(gain, abs=1.5)


def test_the_floor_never_falls_with_the_range():
    generator = np.random.default_rng(2)
    floor = NoiseFloor(60)
    for _ in range(50):
        estimate = floor.update(generator.uniform(0.0, 40.0, 60))
        assert np.all(np.diff(estimate) >= 0.0)


def test_a_wall_that_stays_does_not_lift_the_floor():
    levels = np.full(100, 4.0)
    levels[50:55] = 50.0
    floor = NoiseFloor(100)
    for _ in range(1000):
        estimate = floor.update(levels)
    assert estimate == pytest.approx(np.full(100, 4.0), abs=0.2)


def test_the_first_turn_starts_with_the_configured_ringing():
    ringing = Ringing(RANGES, CONFIG).update(np.full(100, 80.0), 0.0)
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
        at_hull = ringing.update(hull, 3.0)
        at_sea = ringing.update(free, 0.0)
    plateau = (RANGES[:NEAR] > 0.3) & (RANGES[:NEAR] < 0.9)
    assert np.all(at_hull[plateau] > 30.0)
    assert np.all(at_sea[plateau] < 10.0)


def test_a_wall_before_a_vehicle_at_rest_is_not_learned_away():
    ringing = Ringing(RANGES, CONFIG)
    for _ in range(100):
        learned = ringing.update(np.full(100, 48.0), 1.0)
    assert np.all(learned <= CONFIG.hull_ringing)
