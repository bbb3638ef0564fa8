# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From ranges and powers of scatterers to the echo power in every bin."""

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.decibels import power_from_level
from msss_graphslam.simulation.settings import SonarSettings

__all__ = ["GAUSSIAN_PULSE", "ROUGH_WALL", "SMOOTH_WALL", "EchoShape", "ProfileSynthesis"]

_FINEST = 0.03
_STRETCH_RANGE = 10.0
_PULSE_DEVIATION = 0.08
_PULSE_OFFSETS = tuple(0.01 * k for k in range(-30, 31))


@dataclass(frozen=True, slots=True)
class EchoShape:
    """The level [dB] of one echo against its peak at ``offsets`` [m]; negative is nearer.

    Beyond 10 m a shape that ``stretches`` grows with the square root of the range.
    """

    offsets: tuple[float, ...]
    levels: tuple[float, ...]
    stretches: bool = True

    def power(self, offsets: Array, ranges: Array) -> Array:
        """Return the power at ``offsets`` [m] from echoes at ``ranges`` [m]."""
        stretch = np.sqrt(np.maximum(ranges / _STRETCH_RANGE, 1.0)) if self.stretches else 1.0
        level = np.interp(offsets / stretch, self.offsets, self.levels)
        return np.where(level > self.levels[0], power_from_level(level), 0.0)


ROUGH_WALL = EchoShape((-0.9, -0.42, -0.1, 0.0, 0.15, 0.85, 2.4), (-50, -20, -6, 0, -6, -20, -50))
SMOOTH_WALL = EchoShape(
    (-0.35, -0.13, -0.05, 0.0, 0.05, 0.23, 0.7), (-50, -20, -6, 0, -6, -20, -50)
)
GAUSSIAN_PULSE = EchoShape(
    _PULSE_OFFSETS,
    tuple(-10.0 / np.log(10.0) * (x / _PULSE_DEVIATION) ** 2 for x in _PULSE_OFFSETS),
    stretches=False,
)


class ProfileSynthesis:
    """Adds up the echoes of point scatterers, on a grid finer than the bins."""

    def __init__(self, settings: SonarSettings, shape: EchoShape) -> None:
        self._cell = settings.bin_length / np.ceil(settings.bin_length / _FINEST)
        reach = settings.maximum_range - shape.offsets[0]
        cells = self._cell * np.arange(int(np.ceil(reach / self._cell)) + 1)[:, None]
        self._responses = shape.power(settings.ranges - cells, cells).astype(np.float32)

    def profiles(self, ranges: Array, powers: Array) -> Array:
        """Return the power (b, bins) of echoes at ``ranges`` (b, k) [m] with ``powers`` (b, k).

        What lies beyond the grid, an infinite range for instance, adds nothing.
        """
        beams, cells = len(ranges), len(self._responses)
        within = (ranges >= 0.0) & (ranges < self._cell * (cells - 1))
        position = np.where(within, ranges, 0.0) / self._cell
        lower = position.astype(np.intp)
        upper_share = position - lower
        powers = np.where(within, powers, 0.0)
        flat = (lower + cells * np.arange(beams)[:, None]).ravel()
        grid = np.bincount(flat, (powers * (1.0 - upper_share)).ravel(), beams * cells)
        grid += np.bincount(flat + 1, (powers * upper_share).ravel(), beams * cells)
        return np.asarray(grid.reshape(beams, cells).astype(np.float32) @ self._responses)
