# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Pressure and depth."""

from msss_graphslam.config.groups import Sensors

__all__ = ["STANDARD_ATMOSPHERE", "height_of", "pressure_at"]

STANDARD_ATMOSPHERE = 101_325.0
"""Pressure of the air at the water's surface [Pa]."""

_GRAVITY = 9.80665


def height_of(pressure: float, sensors: Sensors) -> float:
    """Return z [m], up and 0 at the surface, where the sensor reads ``pressure`` [Pa]."""
    surface = 0.0 if sensors.gauge_pressure else STANDARD_ATMOSPHERE
    return (surface - pressure) / (sensors.water_density * _GRAVITY)


def pressure_at(z: float, sensors: Sensors) -> float:
    """Return what the sensor reads [Pa] at z [m]; the inverse of ``height_of``."""
    surface = 0.0 if sensors.gauge_pressure else STANDARD_ATMOSPHERE
    return surface - z * sensors.water_density * _GRAVITY
