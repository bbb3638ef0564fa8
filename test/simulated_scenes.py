# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Small scenes that the simulator's tests share."""

from dataclasses import replace

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.path import Path
from msss_graphslam.simulation.scene import Pings
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.vehicle import Motion
from msss_graphslam.simulation.worlds import World

SETTINGS = SonarSettings(10.0, 200, np.radians(1.8), 0.04285)
OPEN_WATER = replace(SETTINGS, maximum_range=10.0, hull_sector=0.0)
SQUARE = np.array([[6.0, 6.0], [-6.0, 6.0], [-6.0, -6.0], [6.0, -6.0]])
FAR_AWAY = 1e4 * SQUARE


def levels(codes: Array) -> Array:
    """The levels [dB] of codes; an oracle: the table of all half decibels, looked up."""
    table = [k * 255 // 160 for k in range(161)]
    return 0.5 * np.searchsorted(table, codes)


def pings(count: int, bearing: float = 0.0, azimuth: float | None = None) -> Pings:
    """Beams from the origin, all the same way."""
    return Pings(
        np.zeros((count, 2)),
        np.full(count, bearing),
        np.full(count, bearing if azimuth is None else azimuth),
    )


def facing_wall(distance: float, incidence: float) -> Array:
    """A very long wall, ``distance`` [m] along x, met at ``incidence`` [rad] on the x axis."""
    along = np.array([np.sin(incidence), np.cos(incidence)])
    behind = np.array([np.cos(incidence), -np.sin(incidence)])
    foot = np.array([distance, 0.0])
    reach = 1e4
    return np.array(
        [
            foot - reach * along,
            foot + reach * along,
            foot + reach * (along + behind),
            foot + reach * (behind - along),
        ]
    )


def resting(duration: float, yaw: float = 0.0) -> Motion:
    times = np.arange(0.0, duration, 0.02)
    poses = np.zeros((len(times), 6))
    poses[:, 5] = yaw
    return Motion(times, poses, 0.02)


def basin(outline: Array, settings: SonarSettings) -> World:
    """A world of one smooth wall around a vehicle at the origin."""
    triangle = Path.through(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    return World("basin", (outline,), triangle, 1, 2.0, rough=False, sonar=settings)
