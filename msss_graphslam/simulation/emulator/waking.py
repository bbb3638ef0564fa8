# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How a head comes to itself after power-up: silent, then searching its centre, then waiting."""

from msss_graphslam.micron.packets import HeadInformation

__all__ = ["ALIVE_PERIOD", "BOOTING", "CENTRING", "CONFIGURED", "READY", "waking"]

BOOTING = 0.5
"""Silence after power-up [s]."""
CENTRING = 2.0
"""Time from power-up until the motor has found its centre [s]."""
ALIVE_PERIOD = 1.0

_MOTOR_LOOKS_BACK = 1.0
_CENTRING_BACK = HeadInformation(0x5D)
_CENTRING_AHEAD = HeadInformation(0x4D)
_WAITING = HeadInformation(0x4A)
CONFIGURED = HeadInformation(0xCA)
READY = HeadInformation(0x8A)
"""Centred, with parameters. The values are those that Tritech gives for a start."""


def waking(since_power_up: float) -> HeadInformation:
    """Return what a head without parameters says of itself, so many seconds after power-up."""
    if since_power_up >= CENTRING:
        return _WAITING
    return _CENTRING_BACK if since_power_up < _MOTOR_LOOKS_BACK else _CENTRING_AHEAD
