# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Echoes in profiles: levels in decibels, peaks, edges with sub-bin accuracy."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.echoes.peaks import crossings, prominent_peaks
from msss_graphslam.core.types import Array

__all__ = ["Echoes", "find_echoes", "smooth", "smoothing_kernel", "to_decibels"]

FULL_SCALE = 255.0
DECIBELS_OF_FULL_SCALE = 80.0
SILENCE = -1e3
"""Level [dB] that stands before the first bin and behind the last, below all that can be."""


@dataclass(frozen=True, slots=True)
class Echoes:
    """The echoes of profiles in order of profile and range, in units of bins.

    ``profiles`` (k,) are numbers, ascending, and ``peaks`` (k,) bins; ``leading`` and ``trailing``
    (k,) the places where the level has come within the echo's drop of the peak, and leaves it;
    ``levels`` (k,) the peaks [dB].
    """

    profiles: NDArray[np.intp]
    peaks: NDArray[np.intp]
    leading: Array
    trailing: Array
    levels: Array

    def first(self, count: int) -> "Echoes":
        """Return the ``count`` nearest echoes of every profile."""
        rank = np.arange(self.profiles.size) - np.searchsorted(self.profiles, self.profiles)
        return self.where(rank < count)

    def where(self, kept: NDArray[np.bool_]) -> "Echoes":
        """Return those echoes for which ``kept`` (k,) is true."""
        return Echoes(
            self.profiles[kept],
            self.peaks[kept],
            self.leading[kept],
            self.trailing[kept],
            self.levels[kept],
        )


def to_decibels(codes: Array, scale: str) -> Array:
    """Return the levels [dB] of codes 0..255 (b, n), and silence for NaN.

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


def smooth(levels: Array, kernel: Array) -> Array:
    """Return profiles (b, n) convolved with the kernel (2 h + 1,), by zeros beyond their ends."""
    half, bins = kernel.size // 2, levels.shape[1]
    padded = np.zeros((len(levels), bins + 2 * half))
    padded[:, half : half + bins] = levels
    total = kernel[0] * padded[:, :bins]
    for place in range(1, kernel.size):
        total += kernel[place] * padded[:, place : place + bins]
    return np.asarray(total)


def find_echoes(levels: Array, thresholds: Array, drop: float, dynamic_range: float) -> Echoes:
    """Find the echoes in profiles (b, n) [dB], each for itself.

    Their peaks exceed the thresholds (b, n), and come within the dynamic range of the strongest
    that does. An echo stands ``drop`` above the valleys to its stronger neighbours, and begins and
    ends within the profile: a beam that is loud throughout holds none.
    """
    strongest = np.where(levels > thresholds, levels, -np.inf).max(axis=1)
    least = np.where(strongest > -np.inf, strongest - dynamic_range, np.inf)
    # One sequence of all profiles, as the ends keep them apart.
    excess = np.zeros((len(levels), levels.shape[1] + 2))
    inner = excess[:, 1:-1]
    np.subtract(levels, np.maximum(thresholds, least[:, None]), out=inner)
    inner += drop
    np.maximum(inner, 0.0, out=inner)
    return _with_edges(levels, prominent_peaks(excess.reshape(-1), drop), drop)


def _with_edges(levels: Array, peaks: NDArray[np.intp], drop: float) -> Echoes:
    """Return the echoes at the peaks (k,) of the profiles (b, n) with one bin more at each end."""
    count, bins = levels.shape
    padded = np.full((count, bins + 2), SILENCE)
    padded[:, 1:-1] = levels
    values = padded.reshape(-1)
    heights = values[peaks]
    profiles = peaks // (bins + 2)
    first = profiles * (bins + 2) + 1
    leading, trailing = crossings(values, peaks, heights - drop, first)
    whole_echo = (leading > 0.0) & (trailing < bins - 1)
    found = Echoes(profiles, peaks - first, leading, trailing, heights).where(whole_echo)
    return _without_shoulders(found)


def _without_shoulders(echoes: Echoes) -> Echoes:
    """Leave out what no valley of levels parts from a stronger echo beside it.

    It stood out where the threshold falls; its edges would be those of both together.
    """
    together = echoes.profiles[1:] == echoes.profiles[:-1]
    rises = echoes.levels[1:] > echoes.levels[:-1]
    shoulder = np.zeros(echoes.profiles.size, dtype=bool)
    shoulder[1:] = together & ~rises & (echoes.leading[1:] < echoes.peaks[:-1])
    shoulder[:-1] |= together & rises & (echoes.trailing[:-1] > echoes.peaks[1:])
    return _without_shoulders(echoes.where(~shoulder)) if shoulder.any() else echoes
