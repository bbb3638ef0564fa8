# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Peaks of a sequence of numbers, and where it falls to a level beside them."""

# SciPy has these, to the same bits, in a package that holds 70 MiB: the node that makes scans of
# beams shall fit on a vehicle's computer.

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array

__all__ = ["crossings", "prominent_peaks"]

Indices = NDArray[np.intp]

_STRIDE = 16


def prominent_peaks(values: Array, prominence: float) -> Indices:
    """Return the peaks of (n,) values that stand ``prominence`` or more above their valleys.

    A peak's valley is the lowest value between it and a higher one, or the end; of the valleys to
    its two sides the higher counts. A flat top's peak is its middle. No value may be negative, and
    the first and the last must be 0; so sequences may stand one after another, each for itself.
    """
    peaks = _maxima(values)
    heights = values[peaks]
    peaks, heights = peaks[heights >= prominence], heights[heights >= prominence]
    if not peaks.size:
        return peaks
    valleys = np.minimum.reduceat(values, np.append(0, peaks))
    stands_out = heights - np.maximum(valleys[:-1], valleys[1:]) >= prominence
    tops, lows = heights.tolist(), valleys.tolist()
    for peak in np.flatnonzero(~stands_out).tolist():
        before = _falls(tops, lows, peak, -1, prominence)
        stands_out[peak] = before and _falls(tops, lows, peak, 1, prominence)
    return np.asarray(peaks[stands_out])


def crossings(
    values: Array, peaks: Indices, levels: Array, origins: Indices
) -> tuple[Array, Array]:
    """Return where (n,) values fall to the ``levels`` (k,) before and after the ``peaks`` (k,).

    The places (k,), counted from the ``origins`` (k,), lie between two of the values. The first
    and the last value must lie below all levels, and the peaks above theirs.
    """
    left = _fallen(values, peaks, levels, -1)
    right = _fallen(values, peaks, levels, 1)
    before = (levels - values[left]) / (values[left + 1] - values[left])
    after = (levels - values[right]) / (values[right - 1] - values[right])
    return (left - origins) + before, (right - origins) - after


def _maxima(values: Array) -> Indices:
    """Return the places of the local maxima, the middle of flat ones; none at an end."""
    steps = values[1:] - values[:-1]
    changes = steps.nonzero()[0]
    rises = steps[changes] > 0.0
    tops = (rises[:-1] > rises[1:]).nonzero()[0]
    return np.asarray((changes[tops] + 1 + changes[tops + 1]) >> 1)


def _falls(
    heights: Sequence[float], valleys: Sequence[float], peak: int, step: int, prominence: float
) -> bool:
    """Whether a valley on the way from a peak to a higher one is deep enough.

    ``valleys`` (k + 1,) lie before each peak (k,) and behind the last; ``step`` is 1 or -1.
    """
    top, behind = heights[peak], (step + 1) // 2
    while heights[peak] <= top:
        # The ends are 0, and no peak is lower than its prominence: no way leads beyond them.
        if top - valleys[peak + behind] >= prominence:
            return True
        peak += step
    return False


def _fallen(values: Array, peaks: Indices, levels: Array, direction: int) -> Indices:
    """Return the first places (k,) from the peaks on that do not exceed the levels."""
    places = peaks.copy()
    walking = np.arange(peaks.size)
    steps = direction * np.arange(1, _STRIDE + 1)
    while walking.size:
        ahead = values.take(places[walking, None] + steps, mode="clip")
        low = ahead <= levels[walking, None]
        stride = np.where(low.any(axis=1), low.argmax(axis=1) + 1, _STRIDE)
        places[walking] += direction * stride
        walking = walking[~low.any(axis=1)]
    return places
