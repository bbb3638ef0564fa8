# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Echoes with all that a real Micron's have, at the levels measured on recordings of two heads.

Ten times the logarithm of a power is the head's level in dB throughout.
"""

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.decibels import codes_from_power, power_from_level
from msss_graphslam.simulation.echo_shape import ROUGH_WALL, SMOOTH_WALL, ProfileSynthesis
from msss_graphslam.simulation.hull import Hull
from msss_graphslam.simulation.ray_casting import Walls
from msss_graphslam.simulation.scene import Fan, Pings, Scatterers
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.sidelobes import Sidelobes
from msss_graphslam.simulation.speckle import Speckle
from msss_graphslam.simulation.specks import Specks

__all__ = ["RealEchoes"]

_INCIDENCE = np.radians([0.0, 30.0, 50.0, 65.0, 80.0, 90.0])
_WALL_LEVEL = (49.0, 48.0, 46.8, 46.0, 42.5, 28.0)
_SECOND_BOUNCE = power_from_level(-10.0)
_RETURN_POWER = 6
_FLOOR_RANGES, _FLOOR_LEVELS = (2.0, 10.0), (-1.5, 7.0)


class RealEchoes:
    """Wall echoes, second bounces, sidelobes, the hull, specks, speckle and noise."""

    def __init__(self, walls: Walls, settings: SonarSettings, rough: bool, seed: int) -> None:
        self._hull = Hull(settings, seed)
        self._fan = Fan(walls, settings.beam_width)
        self._sidelobes = Sidelobes(walls, settings.beam_width, self._hull, seed)
        self._synthesis = ProfileSynthesis(settings, ROUGH_WALL if rough else SMOOTH_WALL)
        self._speckle = Speckle(seed)
        self._specks = Specks(settings, seed)
        self._floor = power_from_level(_floor_level(settings.ranges))

    def codes(self, pings: Pings) -> NDArray[np.uint8]:
        """Return the codes (b, bins) of consecutive beams."""
        hidden = self._hull.hides(pings.bearings)
        power, wall_ranges = self._scene(pings.origins, pings.azimuths)
        power += self._floor
        power[hidden] = 0.0
        power += self._sidelobe_power(pings)
        self._add_mirror_image(power, pings)
        power += self._hull.ringing(pings.bearings)
        power = self._speckle.on(power)
        self._specks.add(power, np.where(hidden, np.inf, wall_ranges))
        return codes_from_power(power)

    def _scene(self, origins: Array, azimuths: Array) -> tuple[Array, Array]:
        """Return what the main lobe hears (b, bins), and the ranges (b,) of its first wall."""
        first = self._fan.cast(origins, azimuths)
        second = self._fan.cast_on(origins, azimuths, first)
        walls = Scatterers.between_rays(first)
        bounces = Scatterers.between_rays(second)
        wall_power = self._fan.shares * _wall_power(walls.incidence)
        returned = _SECOND_BOUNCE * np.cos(walls.incidence) ** _RETURN_POWER * wall_power
        bounced = _SECOND_BOUNCE * self._fan.shares * _wall_power(bounces.incidence)
        ranges = np.concatenate([walls.ranges, 2.0 * walls.ranges, bounces.ranges], axis=1)
        powers = np.concatenate([wall_power, returned, bounced], axis=1)
        return self._synthesis.profiles(ranges, powers), first.ranges.min(axis=1)

    def _sidelobe_power(self, pings: Pings) -> Array:
        around, shares = self._sidelobes.hear(pings)
        return self._synthesis.profiles(around.ranges, shares * _wall_power(around.incidence))

    def _add_mirror_image(self, power: Array, pings: Pings) -> None:
        near = np.flatnonzero(self._hull.near(pings.bearings))
        bearings = pings.bearings[near]
        azimuths = pings.azimuths[near] - bearings + self._hull.mirrored(bearings)
        image, _ = self._scene(pings.origins[near], azimuths)
        power[near] += self._hull.mirror_power(bearings)[:, None] * image


def _wall_power(incidence: Array) -> Array:
    """Return the power of a wall that fills the beam at one range; diffuse, without a cliff."""
    return power_from_level(np.interp(incidence, _INCIDENCE, _WALL_LEVEL))


def _floor_level(ranges: Array) -> Array:
    """Return the noise [dB]: it rises with the head's gain, which levels off at 10 m."""
    return np.interp(ranges, _FLOOR_RANGES, _FLOOR_LEVELS)
