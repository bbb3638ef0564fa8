# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Echoes in one profile: levels in decibels, peaks, edges with sub-bin accuracy, variances."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.peaks import crossings, prominent_peaks
from msss_graphslam.core.types import Array

__all__ = ["Echoes", "find_echoes", "smoothing_kernel", "to_decibels"]

FULL_SCALE = 255.0
DECIBELS_OF_FULL_SCALE = 80.0


@dataclass(frozen=True, slots=True)
class Echoes:
    """The echoes of one profile in order of range, in units of bins.

    ``peaks`` (k,) are bins; ``leading`` and ``trailing`` (k,) the places where the level has come
    within the echo's drop of the peak, and leaves it; ``levels`` (k,) the peaks [dB].
    """

    peaks: NDArray[np.intp]
    leading: Array
    trailing: Array
    levels: Array

    def first(self, count: int) -> "Echoes":
        """Return the ``count`` nearest echoes."""
        return Echoes(
            self.peaks[:count], self.leading[:count], self.trailing[:count], self.levels[:count]
        )


def to_decibels(codes: Array, scale: str) -> Array:
    """Return the levels [dB] of codes 0..255 (n,), and silence for NaN.

    ``db80`` is 0..80 dB (Tritech Micron). ``linear`` amplitudes are taken relative to one code,
    which makes full scale 48 dB, the level at which a Micron sees a wall.
    """
    codes = np.minimum(np.fmax(codes, 0.0), FULL_SCALE)
    if scale == "linear":
        return np.asarray(20.0 * np.log10(np.maximum(codes, 1.0)))
    return codes * (DECIBELS_OF_FULL_SCALE / FULL_SCALE)


def smoothing_kernel(echo_length: float, bin_size: float, bins: int) -> Array:
    """Return a normalised Hann window, a quarter of an echo [m] wide at half its height.

    It spans at least three bins, so that an echo of one bin, a speck, loses half of its contrast;
    where the bins are longer than an echo it leaves them alone.
    """
    half = int(np.ceil(0.125 * echo_length / bin_size)) if bin_size <= echo_length else 0
    half = min(half, (bins - 1) // 2)
    window = np.hanning(2 * half + 3)[1:-1]
    return np.asarray(window / window.sum())


def find_echoes(levels: Array, thresholds: Array, drop: float, dynamic_range: float) -> Echoes:
    """Find the echoes whose peaks exceed the thresholds (n,) and the beam's dynamic range [dB].

    An echo stands ``drop`` above the valleys to its stronger neighbours, and begins and ends
    within the profile: a beam that is loud throughout holds none.
    """
    above = levels > thresholds
    if not above.any():
        return _NONE
    thresholds = np.maximum(thresholds, levels[above].max() - dynamic_range)
    excess = np.zeros(levels.size + 2)
    np.maximum(levels - thresholds + drop, 0.0, out=excess[1:-1])
    peaks = prominent_peaks(excess, drop) - 1
    if not peaks.size:
        return _NONE
    return _with_edges(levels, peaks, drop)


def _with_edges(levels: Array, peaks: NDArray[np.intp], drop: float) -> Echoes:
    heights = levels[peaks]
    profile = levels.tolist()
    edges = [
        crossings(profile, peak, height - drop)
        for peak, height in zip(peaks.tolist(), heights.tolist(), strict=True)
    ]
    leading, trailing = np.array(edges).T
    whole_echo = (leading > 0.0) & (trailing < levels.size - 1)
    return Echoes(
        peaks[whole_echo], leading[whole_echo], trailing[whole_echo], heights[whole_echo]
    )


_NONE = Echoes(np.zeros(0, np.intp), np.zeros(0), np.zeros(0), np.zeros(0))
