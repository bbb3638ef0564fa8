# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.core.echo_extraction import find_echoes, smoothing_kernel, to_decibels

DROP = 6.0
DYNAMIC_RANGE = 20.0


def echoes_of(levels, threshold=14.0):
    levels = np.asarray(levels, dtype=float)
    return find_echoes(levels, np.full(levels.size, threshold), DROP, DYNAMIC_RANGE)


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
