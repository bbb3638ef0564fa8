# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Peaks and crossings: SciPy's are the oracle, to the bit."""

import numpy as np
import pytest
from scipy.signal import find_peaks, peak_widths

from msss_graphslam.core.peaks import crossings, prominent_peaks

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


@pytest.mark.parametrize("flat", [True, False])
@pytest.mark.parametrize("drop", [0.5, 2.0])
def test_crossings_are_scipy_s(drop: float, flat: bool) -> None:
    for seed in SEEDS:
        values = profile(seed, flat=flat)
        peaks = prominent_peaks(np.pad(values, 1), drop) - 1
        whole = (
            np.full(peaks.size, drop),
            np.zeros(peaks.size, np.intp),
            np.full(peaks.size, values.size - 1),
        )
        _, _, left, right = peak_widths(values, peaks, rel_height=1.0, prominence_data=whole)
        found = [crossings(values.tolist(), peak, values[peak] - drop) for peak in peaks.tolist()]
        assert [list(pair) for pair in found] == np.column_stack([left, right]).tolist()


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 2.0], [2.0, 2.0, 2.0], [0.0, 1.0, 2.0, 3.0]])
def test_what_has_no_top_has_no_peak(values: list[float]) -> None:
    assert prominent_peaks(np.array(values), 0.1).size == 0


@pytest.mark.parametrize(("prominence", "count"), [(2.0, 2), (2.1, 1)])
def test_a_peak_stands_above_the_higher_one_of_its_valleys(prominence: float, count: int) -> None:
    values = np.array([0.0, 5.0, 1.0, 3.0, 0.0])
    assert prominent_peaks(values, prominence).size == count
