# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How long a head takes for a beam, and how old an echo profile is when it has arrived.

Fitted to the beam periods of five recordings, 42.7 to 85.2 ms, which it meets within 5 %.
"""

from math import degrees, pi

from msss_graphslam.micron.beam import AD_INTERVAL_S
from msss_graphslam.micron.packets import TURN, HeadData

__all__ = [
    "HEAD_DATA_OVERHEAD",
    "SAMPLE_TICK",
    "STEP_ANGLE",
    "beam_period",
    "echo_time",
    "listening_time",
    "reply_delay",
    "transfer_time",
]

SAMPLE_TICK = AD_INTERVAL_S
"""Unit of the interval between two bins [s]."""
STEP_ANGLE = 2.0 * pi / TURN
"""A sixteenth of a gradian, the unit of the head's angles [rad]."""
HEAD_DATA_OVERHEAD = 45
"""Bytes of a data packet beside its bins."""

_BITS_PER_BYTE = 10  # with start and stop bit
_MOTOR = 23.7e-3  # s/deg
_BETWEEN_PACKETS = 5e-3
_BETWEEN_ECHOES = 10e-3
_PROCESSING = 5e-3


def transfer_time(size: int, baudrate: int) -> float:
    """Return the time [s] that ``size`` bytes take on the line, 8N1."""
    return _BITS_PER_BYTE * size / baudrate


def echo_time(range_m: float, sound_speed: float) -> float:
    """Return the time [s] to ``range_m`` and back."""
    return 2.0 * range_m / sound_speed


def listening_time(ad_interval: int, bins: int) -> float:
    """Return the time [s] from the transmission to the end of the last bin."""
    return ad_interval * SAMPLE_TICK * bins


def beam_period(listening: float, step: float, data_bytes: int, baudrate: int) -> float:
    """Return the time [s] between two beams.

    ``listening`` [s] is the echo's time to the last bin, ``step`` [rad] the angle that the motor
    turns, ``data_bytes`` the size of the bins. The slowest of motor, line and sound decides; they
    work at the same time.
    """
    line = transfer_time(HEAD_DATA_OVERHEAD + data_bytes, baudrate)
    return max(
        _MOTOR * degrees(abs(step)),
        line + _BETWEEN_PACKETS,
        listening + _BETWEEN_ECHOES,
    )


def reply_delay(head_data: HeadData, baudrate: int) -> float:
    """Return the time [s] from the transmission to the arrival of the reply's last byte."""
    size = HEAD_DATA_OVERHEAD + len(head_data.data)
    listening = listening_time(head_data.ad_interval, head_data.bins)
    return listening + _PROCESSING + transfer_time(size, baudrate)
