# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Echoes as papers simulate them: a clean pulse, noise, and faults at given rates."""

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.decibels import codes_from_power, power_from_level
from msss_graphslam.simulation.echo_shape import GAUSSIAN_PULSE, ProfileSynthesis
from msss_graphslam.simulation.ray_casting import Walls
from msss_graphslam.simulation.scene import Fan, Pings, Scatterers
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.streams import stream

__all__ = ["IdealEchoes"]

_WALL_LEVEL, _WALL_LEVEL_DEVIATION = 48.0, 1.5
_NOISE_LEVEL = 4.0
_RANGE_JITTER = 0.03
_MISSES = 0.02
_HALF_LOST, _LOSS_WIDTH = np.radians(72.0), np.radians(3.0)
_OUTLIERS = 0.03
_MULTIPATHS = 0.35
_MULTIPATH_DELAYS = (0.5, 5.0)
_MULTIPATH_LEVEL, _MULTIPATH_DEVIATION = -6.0, 3.0
_ARCS_PER_TURN = 0.4
_ARC_BEAMS = (4, 14)


class IdealEchoes:
    """One echo a beam, now and then lost, false, followed by another or drowned in cross-talk."""

    def __init__(self, walls: Walls, settings: SonarSettings, seed: int) -> None:
        self._settings = settings
        self._fan = Fan(walls, settings.beam_width)
        self._synthesis = ProfileSynthesis(settings, GAUSSIAN_PULSE)
        self._losses = stream(seed, "ideal losses")
        self._jitter = stream(seed, "ideal range jitter")
        self._levels = stream(seed, "ideal levels")
        self._outliers = stream(seed, "ideal outliers")
        self._multipath = stream(seed, "ideal multipath")
        self._cross_talk = stream(seed, "ideal cross-talk")
        self._noise = stream(seed, "ideal noise")
        self._arc_range = 0.0
        self._arc_beams_left = 0

    def codes(self, pings: Pings) -> NDArray[np.uint8]:
        """Return the codes (b, bins) of consecutive beams."""
        walls = self._wall_echoes(pings)
        others = self._false_echoes(walls[0].min(axis=1))
        ranges, powers = (np.hstack(parts) for parts in zip(walls, others, strict=True))
        power = self._synthesis.profiles(ranges, powers)
        power += power_from_level(_NOISE_LEVEL) * self._noise.standard_exponential(power.shape)
        return codes_from_power(power)

    def _wall_echoes(self, pings: Pings) -> tuple[Array, Array]:
        """Return ranges and powers (b, k) of the wall; infinitely far where its echo is lost."""
        hits = self._fan.cast(pings.origins, pings.azimuths)
        walls = Scatterers.between_rays(hits)
        axis = hits.incidence[:, hits.incidence.shape[1] // 2]
        kept = (1.0 - _MISSES) / (1.0 + np.exp((axis - _HALF_LOST) / _LOSS_WIDTH))
        lost = self._losses.random((len(axis), 1)) >= kept[:, None]
        jitter = _RANGE_JITTER * self._jitter.standard_normal((len(axis), 1))
        level = self._levels.normal(_WALL_LEVEL, _WALL_LEVEL_DEVIATION, (len(axis), 1))
        ranges = np.where(lost, np.inf, walls.ranges + jitter)
        return ranges, self._fan.shares * power_from_level(level)

    def _false_echoes(self, wall_ranges: Array) -> tuple[Array, Array]:
        """Return ranges and powers (b, 3) of outliers, multipath, cross-talk; inf is none."""
        beams = len(wall_ranges)
        outliers = self._outliers.uniform(0.0, self._settings.maximum_range, beams)
        outliers[self._outliers.random(beams) >= _OUTLIERS] = np.inf
        delayed = wall_ranges + self._multipath.uniform(*_MULTIPATH_DELAYS, beams)
        delayed[self._multipath.random(beams) >= _MULTIPATHS] = np.inf
        levels = np.full((beams, 3), _WALL_LEVEL)
        levels[:, 1] += self._multipath.normal(_MULTIPATH_LEVEL, _MULTIPATH_DEVIATION, beams)
        ranges = np.stack([outliers, delayed, self._arcs(beams)], axis=1)
        return ranges, power_from_level(levels)

    def _arcs(self, beams: int) -> Array:
        """Return ranges (b,) of another sonar's pulses, alike for some beams; inf is none."""
        generator, ranges = self._cross_talk, np.full(beams, np.inf)
        per_beam = _ARCS_PER_TURN * self._settings.step / (2.0 * np.pi)
        starts = generator.random(beams) < per_beam
        for beam in range(beams):
            if starts[beam]:
                self._arc_range = generator.uniform(0.0, self._settings.maximum_range)
                self._arc_beams_left = int(generator.integers(*_ARC_BEAMS, endpoint=True))
            if self._arc_beams_left:
                ranges[beam] = self._arc_range
                self._arc_beams_left -= 1
        return ranges
