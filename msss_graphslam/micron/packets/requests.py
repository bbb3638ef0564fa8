# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The host's short commands."""

import struct
from dataclasses import dataclass
from typing import ClassVar, Self

from msss_graphslam.micron.frame import Frame, MessageType
from msss_graphslam.micron.packets.layout import pack, require

__all__ = ["Reboot", "SendData", "SendUserData", "SendVersion", "StopAlives"]

_TIME = struct.Struct("<I")


@dataclass(frozen=True, slots=True)
class _Bare:
    """A command that is its type alone."""

    TYPE: ClassVar[MessageType]

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the packet; PacketError if it has a payload."""
        require(not frame.payload, f"{cls.TYPE.name.lower().replace('_', ' ')}: wrong size")
        return cls()

    def frame(self) -> Frame:
        """Return the packet."""
        return Frame.to_head(self.TYPE)


@dataclass(frozen=True, slots=True)
class SendVersion(_Bare):
    """mtSendVersion: asks for mtVersionData."""

    TYPE = MessageType.SEND_VERSION


@dataclass(frozen=True, slots=True)
class SendUserData(_Bare):
    """mtSendBBUser: asks for mtBBUserData."""

    TYPE = MessageType.SEND_USER_DATA


@dataclass(frozen=True, slots=True)
class Reboot(_Bare):
    """mtReBoot: the head starts anew, without parameters."""

    TYPE = MessageType.REBOOT


@dataclass(frozen=True, slots=True)
class StopAlives(_Bare):
    """mtStopAlives: the head sends no more mtAlive."""

    TYPE = MessageType.STOP_ALIVES


@dataclass(frozen=True, slots=True)
class SendData:
    """mtSendData: asks for a beam; ``time_ms`` is the host's time of day, 0 will do."""

    time_ms: int = 0

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the payload; PacketError if its size is wrong."""
        require(len(frame.payload) == _TIME.size, "send data: wrong size")
        return cls(*_TIME.unpack(frame.payload))

    def frame(self) -> Frame:
        """Return the packet; PacketError if the time does not fit."""
        return Frame.to_head(MessageType.SEND_DATA, pack(_TIME, self.time_ms))
