# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is done to measurements."""

import numpy as np
import pytest

from benchmarks.alterations import Alteration, altered
from msss_graphslam.core.types import Beam, Depth, Inertial, Measurement

CODES = np.arange(256.0)
BEAM = Beam(10, 0.5, 0.05 * np.arange(1.0, 257.0), CODES)
MEASURED: list[Measurement] = [BEAM, Inertial(11, np.zeros(3), np.zeros(3)), Depth(12, -2.0), BEAM]


def test_without_alteration_nothing_changes() -> None:
    assert all(a is b for a, b in zip(altered(MEASURED, Alteration.NONE), MEASURED, strict=True))


def test_without_imu_the_rest_stays() -> None:
    left = list(altered(MEASURED, Alteration.NO_IMU))
    assert [entry.stamp_ns for entry in left] == [10, 12, 10]


def test_four_bits_are_sixteen_levels_over_the_whole_scale() -> None:
    beam, *_, last = altered(MEASURED, Alteration.FOUR_BITS)
    assert isinstance(beam, Beam)
    assert isinstance(last, Beam)
    levels, counts = np.unique(beam.intensities, return_counts=True)
    np.testing.assert_allclose(levels, np.linspace(0.0, 255.0, 16))
    assert set(counts) == {16}
    assert np.abs(beam.intensities - CODES).max() <= 17.0
    np.testing.assert_array_equal(last.intensities, beam.intensities)
    np.testing.assert_array_equal(beam.ranges, BEAM.ranges)


@pytest.mark.parametrize("number", [0, 3])
def test_faster_sound_makes_ranges_too_short(number: int) -> None:
    beam = list(altered(MEASURED, Alteration.SOUND_SPEED))[number]
    assert isinstance(beam, Beam)
    np.testing.assert_allclose(1.01 * beam.ranges, BEAM.ranges)
    np.testing.assert_array_equal(beam.intensities, CODES)
