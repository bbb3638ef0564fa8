# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from echo_profiles import Profile, beam_of
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from msss_graphslam.config.groups import Segmentation, Sonar
from msss_graphslam.core.echoes.beam_segmentation import BeamSegmenter
from msss_graphslam.core.types import Beam


def segmenter(scale="db80", **values):
    return BeamSegmenter(Sonar(intensity_scale=scale), replace(Segmentation(), **values))


def read(profile, **values):
    return segmenter(**values).segment(profile.beam())


@pytest.mark.parametrize("distance", np.linspace(5.0, 5.05, 6))
def test_a_clean_pulse_is_found_within_a_twentieth_of_a_bin(distance):
    reading = read(Profile([(distance, 48.0)]))
    assert reading.ranges == pytest.approx([distance], abs=0.0025)


@pytest.mark.parametrize(
    ("maximum_range", "bins"), [(10.0, 100), (10.0, 800), (20.0, 350), (75.0, 800), (75.0, 100)]
)
@pytest.mark.parametrize("share", [0.3, 0.71, 0.9])
def test_a_clean_pulse_is_found_with_every_setting_of_the_head(maximum_range, bins, share):
    # A pulse shorter than a bin is in that bin whole, as a head sums up what a bin's time brings.
    bin_size, distance = maximum_range / bins, share * maximum_range
    pulse = Profile([(distance, 48.0)], max(0.08, 0.4 * bin_size), bins, maximum_range)
    reading = read(pulse)
    assert reading.ranges == pytest.approx([distance], abs=max(0.01, 0.2 * bin_size))


def test_the_middle_of_a_spread_echo_is_its_range():
    footprint = [(6.0 + offset, 45.0) for offset in np.linspace(-0.4, 0.4, 17)]
    narrow, spread = read(Profile([(6.0, 45.0)])), read(Profile(footprint))
    assert spread.ranges == pytest.approx([6.0], abs=0.01)
    assert spread.variances > 4.0 * narrow.variances


@pytest.mark.parametrize("deviation", [0.05, 0.15])
def test_the_variance_is_that_of_speckled_echoes_off_rough_walls(deviation):
    generator = np.random.default_rng(3)
    reader, truth = segmenter(), generator.uniform(5.0, 15.0, 400)
    readings = []
    for distance in truth + generator.normal(0.0, Segmentation().surface_roughness, truth.size):
        profile = Profile([(distance, 48.0)], deviation)
        power = 10.0 ** (profile.levels / 10.0) * generator.gamma(4.0, 0.25, profile.bins)
        codes = np.maximum(10.0 * np.log10(power), 0.0) * 255.0 / 80.0
        readings.append(reader.segment(beam_of(np.floor(codes), profile.ranges)))
    errors = np.array([reading.ranges[0] for reading in readings]) - truth
    claimed = np.array([reading.variances[0] for reading in readings])
    assert abs(errors.mean()) < 0.01
    assert 0.4 < np.mean(errors**2 / claimed) < 1.5


def test_the_nearest_echo_comes_first_though_multipath_is_stronger():
    reading = read(Profile([(6.0, 40.0), (9.0, 50.0)]))
    assert reading.ranges == pytest.approx([6.0, 9.0], abs=0.01)
    assert reading.levels == pytest.approx([40.0, 50.0], abs=2.0)


def test_only_the_nearest_candidates_are_kept():
    echoes = [(4.0 + 2.0 * number, 45.0) for number in range(5)]
    assert read(Profile(echoes), candidates=2).ranges == pytest.approx([4.0, 6.0], abs=0.01)


@pytest.mark.parametrize(("bins", "count"), [(1, 0), (6, 1)])
def test_a_speck_of_one_bin_is_not_a_surface(bins, count):
    profile = Profile([])
    profile.extra = np.zeros(profile.bins)
    profile.extra[200 : 200 + bins] = 28.0
    assert read(profile).ranges.size == count


def test_noise_holds_no_echo_once_the_floor_is_known():
    generator = np.random.default_rng(4)
    ranges = 0.05 * (np.arange(400) + 0.5)
    reader = segmenter()
    found = 0
    for number in range(300):
        power = 10.0 ** (ranges / 20.0) * generator.gamma(4.0, 0.25, 400)
        reading = reader.segment(beam_of(10.0 * np.log10(power) * 255.0 / 80.0, ranges))
        found += reading.ranges.size if number >= 20 else 0
    assert found <= 2


def ringing(profile, level):
    return np.where((profile.ranges > 0.3) & (profile.ranges < 0.7), level, 0.0)


@pytest.mark.parametrize(("level", "count"), [(40.0, 1), (43.0, 2)])
def test_hull_ringing_is_no_echo_in_the_first_beam_already(level, count):
    profile = Profile([(5.0, 48.0)])
    profile.extra = ringing(profile, level)
    assert read(profile).ranges.size == count


def test_a_weak_near_echo_is_seen_where_no_ringing_was_learned():
    reader = segmenter()
    quiet, near = Profile([(5.0, 48.0)]), Profile([(0.8, 35.0), (5.0, 48.0)])
    assert reader.segment(near.beam()).ranges.size == 1
    for _ in range(300):
        reader.segment(quiet.beam())
    assert reader.segment(near.beam()).ranges == pytest.approx([0.8, 5.0], abs=0.01)


def test_a_near_wall_at_rest_stays_visible():
    reader, wall = segmenter(), Profile([(0.8, 48.0)])
    readings = [reader.segment(wall.beam()) for _ in range(300)]
    assert readings[-1].ranges == pytest.approx([0.8], abs=0.01)


def test_linear_heads_give_the_same_ranges():
    profile = Profile([(6.0, 40.0), (9.0, 44.0)])
    linear = segmenter("linear").segment(profile.linear_beam())
    assert linear.ranges == pytest.approx(read(profile).ranges, abs=0.01)


@given(st.floats(-np.pi, np.pi))
def test_the_first_beam_is_read_alike_at_every_bearing(bearing):
    profile = Profile([(0.8, 38.0), (6.0, 40.0), (9.0, 44.0)])
    reading = segmenter().segment(profile.beam(bearing))
    assert reading.bearing == bearing
    assert reading.ranges == pytest.approx(read(profile).ranges)


def test_saturation_is_flagged_and_does_not_shift_the_range():
    profile = Profile([(6.0, 90.0)], deviation=0.15)
    reading = read(profile)
    assert reading.saturated
    assert reading.ranges == pytest.approx([6.0], abs=0.02)
    assert not read(Profile([(6.0, 79.0)])).saturated


RANGES = np.array([0.5, 1.0, 1.5])


@pytest.mark.parametrize(
    ("ranges", "codes"),
    [
        pytest.param(np.zeros(0), np.zeros(0), id="no bins"),
        pytest.param(np.ones(1), np.full(1, 99.0), id="one bin"),
        pytest.param(RANGES, np.zeros(3), id="silence"),
        pytest.param(RANGES, np.full(3, np.nan), id="codes not finite"),
        pytest.param(RANGES, np.full(2, 9.0), id="lengths differ"),
        pytest.param(RANGES[::-1], np.full(3, 9.0), id="falling ranges"),
        pytest.param(RANGES - 0.8, np.full(3, 9.0), id="negative range"),
        pytest.param(np.full(3, np.nan), np.full(3, 9.0), id="ranges not finite"),
        pytest.param(np.array([0.5, 1.0, np.inf]), np.full(3, 9.0), id="infinite range"),
    ],
)
def test_a_beam_that_holds_nothing_is_flagged_empty(ranges, codes):
    reading = segmenter().segment(Beam(7, 0.1, ranges, codes))
    assert reading.empty
    assert reading.ranges.size == reading.variances.size == reading.levels.size == 0
    assert reading.stamp_ns == 7
    assert np.isfinite(reading.maximum_range)


def test_a_beam_without_a_bearing_is_flagged_empty():
    profile = Profile([(6.0, 48.0)])
    assert segmenter().segment(profile.beam(bearing=np.nan)).empty


def test_open_water_is_not_empty_but_has_no_candidates():
    reading = read(Profile([]))
    assert not reading.empty
    assert reading.ranges.size == 0
    assert reading.maximum_range == pytest.approx(19.975)


def test_three_bins_may_hold_an_echo():
    reading = segmenter().segment(beam_of(np.array([0.0, 200.0, 0.0]), RANGES + 2.0))
    assert reading.ranges == pytest.approx([3.0])


def test_other_settings_of_the_head_begin_anew():
    reader = segmenter()
    for bins in (400, 200, 400):
        profile = Profile([(6.0, 48.0)], bins=bins)
        assert reader.segment(profile.beam()).ranges == pytest.approx([6.0], abs=0.01)


def test_the_same_beams_give_the_same_readings():
    generator = np.random.default_rng(5)
    codes = generator.integers(0, 256, (50, 200)).astype(float)
    ranges = 0.1 * (np.arange(200) + 0.5)
    first, second = segmenter(), segmenter()
    for row in codes:
        one, other = (reader.segment(beam_of(row, ranges)) for reader in (first, second))
        assert np.array_equal(one.ranges, other.ranges)
        assert np.array_equal(one.variances, other.variances)


@settings(max_examples=200, deadline=None)
@example(np.array([0.0, 0, 0, 6, 12, 4, 62, 177, 82, 8, 34, 3, 0]), "linear", 0.125)
@given(
    arrays(np.float64, st.integers(2, 60), elements=st.integers(0, 255).map(float)),
    st.sampled_from(["db80", "linear"]),
    st.floats(0.01, 1.0),
)
def test_any_codes_give_finite_ranges_in_order_within_reach(codes, scale, bin_size):
    reader = segmenter(scale)
    ranges = bin_size * (np.arange(codes.size) + 0.5)
    for _ in range(3):
        reading = reader.segment(beam_of(codes, ranges))
    assert np.all(np.isfinite(reading.ranges))
    assert np.all(np.isfinite(reading.levels))
    assert np.all(np.diff(reading.ranges) >= 0.0)
    assert np.all((reading.ranges > 0.0) & (reading.ranges <= reading.maximum_range))
    assert np.all(reading.variances > 0.0)


def turned_beams(seed, count=100):
    """Beams with one to three echoes; some silent, some without a bearing, two kinds of bins."""
    generator = np.random.default_rng(seed)
    beams = []
    for number in range(count):
        echoes = [(generator.uniform(0.5, 18.0), generator.uniform(20.0, 90.0)) for _ in range(3)]
        profile = Profile(echoes[: number % 4], bins=400 if number % 50 < 40 else 200)
        profile.extra = generator.uniform(0.0, 12.0, profile.bins)
        bearing = np.nan if number % 23 == 0 else generator.uniform(-np.pi, np.pi)
        beam = profile.beam(bearing)
        beams.append(
            replace(beam, stamp_ns=number, intensities=beam.intensities * (number % 9 > 0))
        )
    return beams


@pytest.mark.parametrize("scale", ["db80", "linear"])
@pytest.mark.parametrize("block", [2, 32, 100])
def test_many_beams_at_once_give_the_readings_of_one_by_one(block, scale):
    beams = turned_beams(8)
    first, second = segmenter(scale), segmenter(scale)
    expected = [first.segment(beam) for beam in beams]
    readings = []
    for start in range(0, len(beams), block):
        readings += second.segment_all(beams[start : start + block])
    assert sum(reading.ranges.size for reading in readings) > 90
    assert any(reading.saturated for reading in readings)
    assert [contents(one) for one in readings] == [contents(one) for one in expected]


def contents(reading):
    return (
        reading.stamp_ns,
        reading.maximum_range,
        reading.saturated,
        reading.empty,
        *(part.tobytes() for part in (reading.ranges, reading.variances, reading.levels)),
    )


def test_no_beams_give_no_readings():
    assert segmenter().segment_all([]) == []


def test_empty_beams_among_others_stay_in_their_place_and_teach_nothing():
    loud, silent = Profile([(6.0, 48.0)]).beam(), Profile([]).beam()
    silent = replace(silent, intensities=np.zeros(400))
    odd = Beam(9, 0.0, loud.ranges, np.full(3, 9.0))
    readings = segmenter().segment_all([silent, loud, odd, silent, loud])
    assert [reading.empty for reading in readings] == [True, False, True, True, False]
    alone = segmenter().segment_all([loud, loud])
    assert contents(readings[1]) == contents(alone[0])
    assert contents(readings[4]) == contents(alone[1])
