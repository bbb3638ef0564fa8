# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Synthetic echo profiles with known ranges, for the tests of the segmentation."""

from dataclasses import dataclass, field

import numpy as np

from msss_graphslam.core.types import Array, Beam, Reading

FLOOR = 2.0


@dataclass
class Profile:
    """Gaussian echoes (range [m], level [dB]) over a constant floor [dB], as a db80 beam."""

    echoes: list[tuple[float, float]]
    deviation: float = 0.08
    bins: int = 400
    maximum_range: float = 20.0
    floor: float = FLOOR
    extra: Array | None = field(default=None)

    @property
    def ranges(self) -> Array:
        return (np.arange(self.bins) + 0.5) * self.maximum_range / self.bins

    @property
    def levels(self) -> Array:
        power = np.full(self.bins, 10.0 ** (self.floor / 10.0))
        for distance, level in self.echoes:
            shape = np.exp(-(((self.ranges - distance) / self.deviation) ** 2))
            power += 10.0 ** (level / 10.0) * shape
        levels = 10.0 * np.log10(power)
        return levels if self.extra is None else np.maximum(levels, self.extra)

    def beam(self, bearing: float = 0.3, stamp_ns: int = 0) -> Beam:
        return beam_of(self.levels * 255.0 / 80.0, self.ranges, bearing, stamp_ns)

    def linear_beam(self, full_scale: float = 48.0) -> Beam:
        codes = np.minimum(255.0 * 10.0 ** ((self.levels - full_scale) / 20.0), 255.0)
        return beam_of(np.floor(codes), self.ranges, 0.3, 0)


def beam_of(codes: Array, ranges: Array, bearing: float = 0.3, stamp_ns: int = 0) -> Beam:
    return Beam(stamp_ns, bearing, ranges, np.clip(codes, 0.0, 255.0))


def reading_of(
    bearing: float, echoes: list[tuple[float, float]], deviation: float = 0.03
) -> Reading:
    """Return a reading with the candidates (range [m], level [dB])."""
    ranges, levels = np.array(echoes, dtype=float).reshape(-1, 2).T
    return Reading(0, bearing, ranges, np.full(ranges.size, deviation**2), levels, 20.0)
