# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Specks: small echoes from the water before a wall."""

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.decibels import power_from_level
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.streams import stream

__all__ = ["Specks"]

_PER_METRE = 0.4
_LONGEST_RUN = 4
_LONGEST_BINS = 2
_LEAST_LEVEL = 14.0
_MEAN_EXCESS = 4.5
_GREATEST_LEVEL = 40.0
_CLUSTERING = 2.5


class Specks:
    """Echoes of one or two bins in a few beams, more of them towards the wall."""

    def __init__(self, settings: SonarSettings, seed: int) -> None:
        self._settings = settings
        self._generator = stream(seed, "specks")

    def add(self, power: Array, wall_ranges: Array) -> None:
        """Add specks to the power (b, bins) of beams that meet a wall at ``wall_ranges`` (b,) [m].

        Beams without a wall in range get none.
        """
        generator = self._generator
        clear = np.where(wall_ranges < self._settings.maximum_range, wall_ranges, 0.0)
        cells_each = 0.5 * (1 + _LONGEST_RUN)
        beams = np.repeat(
            np.arange(len(clear)), generator.poisson(_PER_METRE / cells_each * clear)
        )
        count = len(beams)
        ranges = clear[beams] * generator.beta(_CLUSTERING, 1.0, count)
        levels = _LEAST_LEVEL + generator.exponential(_MEAN_EXCESS, count)
        levels = np.minimum(levels, _GREATEST_LEVEL)
        first_bins = (ranges / self._settings.bin_length).astype(np.intp)
        runs = generator.integers(1, _LONGEST_RUN, count, endpoint=True)
        lengths = generator.integers(1, _LONGEST_BINS, count, endpoint=True)
        for run in range(_LONGEST_RUN):
            for length in range(_LONGEST_BINS):
                at, bins = beams + run, first_bins + length
                fits = (run < runs) & (length < lengths)
                fits &= (at < len(power)) & (bins < power.shape[1])
                np.add.at(power, (at[fits], bins[fits]), power_from_level(levels[fits]))
