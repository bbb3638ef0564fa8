# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a Micron DST sends and takes, each packet defined once for both directions.

Every class reads itself from a frame (``decode``) and makes one (``frame``); all numbers are in
the protocol's own units.
"""

from msss_graphslam.micron.packets.control import HeadControl, HeadInformation, HeadStatus
from msss_graphslam.micron.packets.decoding import (
    Command,
    Packet,
    Reply,
    Unknown,
    decode_packet,
)
from msss_graphslam.micron.packets.head_command import (
    Gains,
    GainsCommand,
    HeadCommand,
    ReverseScan,
)
from msss_graphslam.micron.packets.head_data import TURN, HeadData, Sweep
from msss_graphslam.micron.packets.layout import PacketError
from msss_graphslam.micron.packets.replies import (
    Alive,
    CalibrationData,
    FpgaVersionData,
    UserData,
    VersionData,
)
from msss_graphslam.micron.packets.requests import (
    Reboot,
    SendData,
    SendUserData,
    SendVersion,
    StopAlives,
)

__all__ = [
    "TURN",
    "Alive",
    "CalibrationData",
    "Command",
    "FpgaVersionData",
    "Gains",
    "GainsCommand",
    "HeadCommand",
    "HeadControl",
    "HeadData",
    "HeadInformation",
    "HeadStatus",
    "Packet",
    "PacketError",
    "Reboot",
    "Reply",
    "ReverseScan",
    "SendData",
    "SendUserData",
    "SendVersion",
    "StopAlives",
    "Sweep",
    "Unknown",
    "UserData",
    "VersionData",
    "decode_packet",
]
