# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Peaks and crossings: SciPy's are the oracle, to the bit."""

import numpy as np
import pytest
from scipy.signal import find_peaks, peak_widths

from msss_graphslam.core.echoes.peaks import crossings, prominent_peaks

SEEDS = range(200)


def profile(seed: int, *, flat: bool) -> np.ndarray:
    """Some noise above silence; ``flat`` ones have tops several bins wide."""
    rng = np.random.default_rng(seed)
    values = rng.integers(-3, 6, rng.integers(3, 60)).astype(float)
    return np.maximum(values if flat else values + rng.normal(scale=0.3, size=values.size), 0.0)


@pytest.mark.parametrize("flat", [True, False])
@pytest.mark.parametrize("prominence", [0.5, 1.0, 3.0])
def test_peaks_are_scipy_s(prominence: float, flat: bool) -> None:
    found = 0
    for seed in SEEDS:
        padded = np.pad(profile(seed, flat=flat), 1)
        expected = find_peaks(padded, prominence=prominence)[0]
        np.testing.assert_array_equal(prominent_peaks(padded, prominence), expected)
        found += expected.size
    assert found > len(SEEDS)


@pytest.mark.parametrize("prominence", [0.5, 1.0, 3.0])
def test_sequences_one_after_another_are_each_for_itself(prominence: float) -> None:
    several = [np.pad(profile(seed, flat=seed % 2 == 0), 1) for seed in SEEDS]
    starts = np.cumsum([0, *(values.size for values in several)])
    expected = [
        start + find_peaks(values, prominence=prominence)[0]
        for start, values in zip(starts, several, strict=False)
    ]
    found = prominent_peaks(np.concatenate(several), prominence)
    np.testing.assert_array_equal(found, np.concatenate(expected))


@pytest.mark.parametrize("flat", [True, False])
@pytest.mark.parametrize("drop", [0.5, 2.0])
def test_crossings_are_scipy_s(drop: float, flat: bool) -> None:
    for seed in SEEDS:
        values = np.concatenate([profile(seed, flat=flat), profile(seed + 1, flat=flat)])
        values = np.pad(values, 1, constant_values=-drop - 1.0)
        peaks = find_peaks(values, prominence=drop)[0]
        whole = (
            np.full(peaks.size, drop),
            np.zeros(peaks.size, np.intp),
            np.full(peaks.size, values.size - 1),
        )
        _, _, left, right = peak_widths(values, peaks, rel_height=1.0, prominence_data=whole)
        before, after = crossings(values, peaks, values[peaks] - drop, np.zeros_like(peaks))
        assert before.tolist() == left.tolist()
        assert after.tolist() == right.tolist()
        moved, _ = crossings(values, peaks, values[peaks] - drop, peaks)
        assert moved == pytest.approx(left - peaks)


@pytest.mark.parametrize("width", [1, 15, 16, 17, 32, 33, 100])
def test_crossings_are_found_however_far_they_are(width: int) -> None:
    values = np.r_[0.0, np.full(width, 9.0), 10.0, np.full(2 * width, 9.0), 0.0]
    before, after = crossings(values, np.array([width + 1]), np.array([4.5]), np.array([0]))
    assert (before.tolist(), after.tolist()) == ([0.5], [3.0 * width + 1.5])


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 2.0], [2.0, 2.0, 2.0], [0.0, 1.0, 2.0, 3.0]])
def test_what_has_no_top_has_no_peak(values: list[float]) -> None:
    assert prominent_peaks(np.array(values), 0.1).size == 0


@pytest.mark.parametrize(("prominence", "count"), [(2.0, 2), (2.1, 1)])
def test_a_peak_stands_above_the_higher_one_of_its_valleys(prominence: float, count: int) -> None:
    values = np.array([0.0, 5.0, 1.0, 3.0, 0.0])
    assert prominent_peaks(values, prominence).size == count
