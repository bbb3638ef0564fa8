# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.signal import find_peaks

from msss_graphslam.core.echoes.echo_extraction import (
    find_echoes,
    smooth,
    smoothing_kernel,
    to_decibels,
)

DROP = 6.0
DYNAMIC_RANGE = 20.0


def echoes_of(levels, threshold=14.0):
    levels = np.atleast_2d(np.asarray(levels, dtype=float))
    return find_echoes(levels, np.full(levels.shape, threshold), DROP, DYNAMIC_RANGE)


def test_codes_of_a_micron_are_decibels():
    assert to_decibels(np.array([0.0, 127.5, 255.0]), "db80") == pytest.approx([0.0, 40.0, 80.0])


def test_ten_times_the_linear_amplitude_is_20_decibels_more():
    weak, strong, silent = to_decibels(np.array([20.0, 200.0, 0.0]), "linear")
    assert strong - weak == pytest.approx(20.0)
    assert silent == 0.0


def test_codes_that_no_head_sends_stay_within_the_scale():
    levels = to_decibels(np.array([np.nan, -5.0, 300.0, np.inf]), "db80")
    assert levels == pytest.approx([0.0, 0.0, 80.0, 80.0])


@pytest.mark.parametrize(("bin_size", "size"), [(0.0125, 5), (0.025, 3), (0.1, 3), (0.201, 1)])
def test_smoothing_spans_three_bins_or_a_part_of_the_echo(bin_size, size):
    kernel = smoothing_kernel(0.2, bin_size, 100)
    assert kernel.size == size
    assert kernel.sum() == pytest.approx(1.0)


def test_edges_are_interpolated_between_bins():
    echoes = echoes_of([0.0, 0.0, 20.0, 30.0, 20.0, 0.0, 0.0])
    assert echoes.peaks.tolist() == [3]
    assert echoes.leading == pytest.approx([2.4])
    assert echoes.trailing == pytest.approx([3.6])
    assert echoes.levels == pytest.approx([30.0])


@pytest.mark.parametrize(("peak", "count"), [(14.0, 0), (14.1, 1)])
def test_an_echo_must_exceed_the_threshold(peak, count):
    assert echoes_of([0.0, 0.0, peak, 0.0, 0.0]).peaks.size == count


@pytest.mark.parametrize(("weaker", "count"), [(30.5, 2), (29.5, 1)])
def test_an_echo_must_lie_within_the_dynamic_range(weaker, count):
    levels = [0.0, 0.0, weaker, 0.0, 0.0, 50.0, 0.0, 0.0]
    assert echoes_of(levels).peaks.size == count


@pytest.mark.parametrize(("dip", "count"), [(33.5, 2), (34.5, 1)])
def test_a_dip_separates_two_echoes_if_it_is_deep_enough(dip, count):
    assert echoes_of([0.0, 20.0, 40.0, dip, 42.0, 20.0, 0.0]).peaks.size == count


def test_echoes_come_in_order_of_range_and_can_be_cut():
    echoes = echoes_of([0.0, 40.0, 0.0, 50.0, 0.0, 45.0, 0.0])
    assert echoes.peaks.tolist() == [1, 3, 5]
    assert echoes.first(2).levels == pytest.approx([40.0, 50.0])


@pytest.mark.parametrize(
    "levels",
    [
        np.full(20, 80.0),
        np.r_[np.full(5, 60.0), np.zeros(15)],
        np.r_[np.zeros(15), np.full(5, 60.0)],
    ],
    ids=["loud throughout", "loud from the first bin on", "loud up to the last bin"],
)
def test_what_does_not_begin_and_end_is_no_echo(levels):
    assert echoes_of(levels).peaks.size == 0


def smoothed_profiles(seed, count=12):
    generator = np.random.default_rng(seed)
    bins = int(generator.integers(3, 90))
    codes = generator.integers(0, 61, (count, bins)).astype(float)
    codes[generator.random(count) < 0.2] = 0.0
    kernel = smoothing_kernel(0.2, generator.choice([0.02, 0.1, 0.3]), bins)
    return smooth(codes, kernel), generator.uniform(10.0, 50.0, (count, bins))


@pytest.mark.parametrize("seed", range(40))
def test_the_echoes_of_many_profiles_are_those_of_each(seed):
    levels, thresholds = smoothed_profiles(seed)
    together = find_echoes(levels, thresholds, DROP, DYNAMIC_RANGE)
    for number, (profile, threshold) in enumerate(zip(levels, thresholds, strict=True)):
        alone = find_echoes(profile[None], threshold[None], DROP, DYNAMIC_RANGE)
        own = together.where(together.profiles == number)
        for name in ("peaks", "leading", "trailing", "levels"):
            np.testing.assert_array_equal(getattr(own, name), getattr(alone, name))


@pytest.mark.parametrize("seed", range(40))
def test_echoes_are_those_of_scipy_s_peaks(seed):
    found = 0
    for levels, thresholds in zip(*smoothed_profiles(seed), strict=True):
        echoes = find_echoes(levels[None], thresholds[None], DROP, DYNAMIC_RANGE)
        above = levels > thresholds
        least = levels[above].max(initial=-np.inf) - DYNAMIC_RANGE
        limits = np.maximum(thresholds, least) if above.any() else np.full(levels.size, np.inf)
        excess = np.pad(np.maximum(levels - limits + DROP, 0.0), 1)
        peaks = find_peaks(excess, prominence=DROP)[0] - 1
        edges = np.array([edges_of(levels, peak) for peak in peaks]).reshape(-1, 2)
        whole = (edges[:, 0] > 0.0) & (edges[:, 1] < levels.size - 1)
        alone = [stands_alone(number, peaks, edges, levels) for number in range(peaks.size)]
        whole &= np.array(alone, dtype=bool)
        np.testing.assert_array_equal(echoes.peaks, peaks[whole])
        np.testing.assert_allclose(
            np.column_stack([echoes.leading, echoes.trailing]), edges[whole], atol=1e-12
        )
        found += whole.sum()
    assert found or levels.size < 20


def stands_alone(number, peaks, edges, levels):
    """Whether no peak between the echo's edges is stronger, or as strong and nearer."""
    begin, end = edges[number]
    rank = (levels[peaks[number]], -peaks[number])
    return all((levels[peak], -peak) <= rank for peak in peaks if begin < peak < end)


def edges_of(levels, peak):
    """Walk down from the peak on both sides, bin by bin."""
    level, edges = levels[peak] - DROP, []
    for step, end in ((-1, 0), (1, levels.size - 1)):
        place = peak
        while place != end and levels[place] > level:
            place += step
        below = level - levels[place]
        share = below / (levels[place - step] - levels[place]) if below > 0.0 else 0.0
        edges.append(place - step * share)
    return edges


def test_the_nearest_are_cut_for_each_profile():
    one = [0.0, 40.0, 0.0, 50.0, 0.0, 45.0, 0.0]
    echoes = echoes_of([one, np.zeros(7), one]).first(2)
    assert echoes.profiles.tolist() == [0, 0, 2, 2]
    assert echoes.peaks.tolist() == [1, 3, 1, 3]


@pytest.mark.parametrize("size", [1, 3, 5, 11])
def test_smoothing_is_a_convolution(size):
    profiles = np.random.default_rng(size).uniform(0.0, 80.0, (7, 31))
    kernel = np.random.default_rng(1).uniform(0.0, 1.0, size)
    expected = [np.convolve(profile, kernel[::-1], "same") for profile in profiles]
    np.testing.assert_allclose(smooth(profiles, kernel), expected, atol=1e-11)


@pytest.mark.parametrize("direction", [1, -1])
def test_a_shoulder_that_stands_out_where_the_threshold_falls_is_no_echo(direction):
    levels = np.array([[0.0, 0, 20, 40, 36, 38, 20, 0, 0]])[:, ::direction]
    thresholds = np.array([[14.0, 14, 14, 14, 36, 14, 14, 14, 14]])[:, ::direction]
    echoes = find_echoes(levels, thresholds, DROP, DYNAMIC_RANGE)
    assert echoes.levels == pytest.approx([40.0])


def test_equal_echoes_without_a_valley_are_one():
    levels = np.array([[0.0, 0, 40, 36, 40, 0, 0]])
    thresholds = np.array([[14.0, 14, 14, 38, 14, 14, 14]])
    assert find_echoes(levels, thresholds, DROP, DYNAMIC_RANGE).peaks.size == 1
