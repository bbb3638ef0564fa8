# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Peaks of a sequence of numbers, and where it falls below a level beside them."""

# SciPy has these, to the same bits, in a package that holds 70 MiB: the node that makes scans of
# beams shall fit on a vehicle's computer.

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array

__all__ = ["crossings", "prominent_peaks"]


def prominent_peaks(values: Array, prominence: float) -> NDArray[np.intp]:
    """Return the peaks of (n,) values that stand ``prominence`` or more above their valleys.

    A peak's valley is the lowest value between it and a higher one, or the end; of the valleys to
    its two sides the higher counts. No value may be negative. A flat top's peak is its middle.
    """
    peaks = _maxima(values)
    peaks = peaks[values[peaks] >= prominence]
    stands_out = [values[peak] - _valley(values, peak) >= prominence for peak in peaks.tolist()]
    return np.asarray(peaks[np.array(stands_out, dtype=bool)])


def crossings(values: Sequence[float], peak: int, level: float) -> tuple[float, float]:
    """Return where values fall to ``level`` before and after the peak, between two of them.

    It is the first or last place where they do not.
    """
    left, right, last = peak, peak, len(values) - 1
    while left > 0 and values[left] > level:
        left -= 1
    while right < last and values[right] > level:
        right += 1
    before, after = float(left), float(right)
    if values[left] < level:
        before += (level - values[left]) / (values[left + 1] - values[left])
    if values[right] < level:
        after -= (level - values[right]) / (values[right - 1] - values[right])
    return before, after


def _maxima(values: Array) -> NDArray[np.intp]:
    """Return the places of the local maxima, the middle of flat ones; none at an end."""
    steps = values[1:] - values[:-1]
    changes = steps.nonzero()[0]
    rises = steps[changes] > 0.0
    tops = (rises[:-1] > rises[1:]).nonzero()[0]
    return np.asarray((changes[tops] + 1 + changes[tops + 1]) >> 1)


def _valley(values: Array, peak: int) -> float:
    """Return the higher one of the valleys to both sides."""
    higher = (values > values[peak]).nonzero()[0]
    place = int(higher.searchsorted(peak))
    first = higher[place - 1] + 1 if place else 0
    end = higher[place] if place < higher.size else values.size
    return max(float(values[first:peak].min()), float(values[peak:end].min()))
