# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The flags in commands and replies, lowest bit first."""

from enum import IntFlag

__all__ = ["HeadControl", "HeadInformation", "HeadStatus"]


class HeadControl(IntFlag):
    """How the head works (HdCtrl), in mtHeadCommand and again in every mtHeadData."""

    EIGHT_BIT = 1 << 0
    CONTINUOUS = 1 << 1
    SCAN_RIGHT = 1 << 2
    INVERT = 1 << 3
    MOTOR_OFF = 1 << 4
    TRANSMITTER_OFF = 1 << 5
    SPARE = 1 << 6
    CHANNEL_2 = 1 << 7
    RAW = 1 << 8
    HAS_MOTOR = 1 << 9
    APPLY_OFFSET = 1 << 10
    PING_PONG = 1 << 11
    STARE_LEFT_LIMIT = 1 << 12
    REPLY_ASL = 1 << 13
    REPLY_THRESHOLD = 1 << 14
    IGNORE_SENSOR = 1 << 15


class HeadStatus(IntFlag):
    """What the head says of itself in every mtHeadData."""

    POWER_LOSS = 1 << 0
    MOTOR_ERROR = 1 << 1
    PROFILER_SYNC_ERROR = 1 << 2
    PROFILER_PING_ERROR = 1 << 3
    EIGHT_BIT_DATA = 1 << 4
    SPARE_5 = 1 << 5
    SPARE_6 = 1 << 6
    MESSAGE_APPENDED = 1 << 7


class HeadInformation(IntFlag):
    """What the head says of itself in every mtAlive (HeadInf).

    One public driver reads this byte from its highest bit. That contradicts the others and the
    order 5D, 4D, 4A, CA, 8A in which a real head starts, so the lowest bit comes first here.
    """

    RECENTRING = 1 << 0
    CENTRED = 1 << 1
    MOTORING = 1 << 2
    MOTOR_ON = 1 << 3
    DIRECTION = 1 << 4
    IN_SCAN = 1 << 5
    NO_PARAMETERS = 1 << 6
    SENT_CONFIGURATION = 1 << 7
