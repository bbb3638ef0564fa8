# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the head says beside its beams."""

import struct
from dataclasses import dataclass
from typing import Self

from msss_graphslam.micron.frame import HEAD, Frame, MessageType
from msss_graphslam.micron.packets.control import HeadInformation
from msss_graphslam.micron.packets.layout import pack, require

__all__ = ["Alive", "CalibrationData", "FpgaVersionData", "UserData", "VersionData"]

_ALIVE = struct.Struct("<BIHB")
_VERSION = struct.Struct("<BBHIHB")
_USER_DATA_SIZES = (161, 250)
_DUPLEX_OFFSET = 133
_CALIBRATION_SIZE = 66
_FPGA_VERSION_SIZE = 14


@dataclass(frozen=True, slots=True)
class Alive:
    """mtAlive: what the head sends about once a second until it scans.

    ``time_ms`` is the head's clock, ``bearing`` its motor's position [1/16 gradian]; ``notice`` is
    0x80 while it has no parameters, else 0.
    """

    information: HeadInformation
    time_ms: int = 0
    bearing: int = 0
    notice: int = 0

    @property
    def recentring(self) -> bool:
        """Whether the motor is looking for its zero."""
        return HeadInformation.RECENTRING in self.information

    @property
    def centred(self) -> bool:
        """Whether the motor has found its zero."""
        return HeadInformation.CENTRED in self.information

    @property
    def motoring(self) -> bool:
        """Whether the motor turns."""
        return HeadInformation.MOTORING in self.information

    @property
    def motor_on(self) -> bool:
        """Whether the motor has power."""
        return HeadInformation.MOTOR_ON in self.information

    @property
    def direction(self) -> bool:
        """Which way the motor turns, as the head's bit says it."""
        return HeadInformation.DIRECTION in self.information

    @property
    def in_scan(self) -> bool:
        """Whether the head is scanning."""
        return HeadInformation.IN_SCAN in self.information

    @property
    def no_parameters(self) -> bool:
        """Whether the head waits for mtHeadCommand."""
        return HeadInformation.NO_PARAMETERS in self.information

    @property
    def sent_configuration(self) -> bool:
        """Whether the head has told its configuration."""
        return HeadInformation.SENT_CONFIGURATION in self.information

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the payload; PacketError if its size is wrong."""
        require(len(frame.payload) == _ALIVE.size, "alive: wrong size")
        notice, time_ms, bearing, information = _ALIVE.unpack(frame.payload)
        return cls(HeadInformation(information), time_ms, bearing, notice)

    def frame(self) -> Frame:
        """Return the packet; PacketError where a number does not fit."""
        fields = pack(_ALIVE, self.notice, self.time_ms, self.bearing, self.information)
        return Frame.from_head(MessageType.ALIVE, fields)


@dataclass(frozen=True, slots=True)
class VersionData:
    """mtVersionData: the answer to mtSendVersion."""

    software: int
    information: int
    serial: int
    program_length: int
    checksum: int
    node: int = HEAD

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the payload; PacketError if its size is wrong."""
        require(len(frame.payload) == _VERSION.size, "version data: wrong size")
        return cls(*_VERSION.unpack(frame.payload))

    def frame(self) -> Frame:
        """Return the packet; PacketError where a number does not fit."""
        fields = pack(
            _VERSION,
            self.software,
            self.information,
            self.serial,
            self.program_length,
            self.checksum,
            self.node,
        )
        return Frame.from_head(MessageType.VERSION_DATA, fields)


@dataclass(frozen=True, slots=True)
class UserData:
    """mtBBUserData: the head's stored set-up, 161 bytes or, from a DST, 250; most are opaque."""

    data: bytes

    @classmethod
    def of(cls, full_duplex: bool) -> Self:
        """Return a DST's, empty but for the kind of its line."""
        data = bytearray(max(_USER_DATA_SIZES))
        data[_DUPLEX_OFFSET] = 0 if full_duplex else 1
        return cls(bytes(data))

    @property
    def full_duplex(self) -> bool:
        """Whether the head may send while it is sent to: RS232, as against two-wire RS485."""
        return self.data[_DUPLEX_OFFSET] == 0

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the payload; PacketError if its size is wrong."""
        require(len(frame.payload) in _USER_DATA_SIZES, "user data: wrong size")
        return cls(frame.payload)

    def frame(self) -> Frame:
        """Return the packet; PacketError if the data have a wrong size."""
        require(len(self.data) in _USER_DATA_SIZES, "user data: wrong size")
        return Frame.from_head(MessageType.USER_DATA, self.data)


@dataclass(frozen=True, slots=True)
class FpgaVersionData:
    """The 28-byte packet of type 0x39 that may follow mtBBUserData; its content is opaque."""

    data: bytes

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the payload; PacketError if its size is wrong."""
        require(len(frame.payload) == _FPGA_VERSION_SIZE, "FPGA version data: wrong size")
        return cls(frame.payload)

    def frame(self) -> Frame:
        """Return the packet; PacketError if the data have a wrong size."""
        require(len(self.data) == _FPGA_VERSION_SIZE, "FPGA version data: wrong size")
        return Frame.from_head(MessageType.FPGA_VERSION_DATA, self.data)


@dataclass(frozen=True, slots=True)
class CalibrationData:
    """The 80-byte packet of type 0x3F that may follow mtBBUserData; its content is opaque."""

    data: bytes

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the payload; PacketError if its size is wrong."""
        require(len(frame.payload) == _CALIBRATION_SIZE, "calibration data: wrong size")
        return cls(frame.payload)

    def frame(self) -> Frame:
        """Return the packet; PacketError if the data have a wrong size."""
        require(len(self.data) == _CALIBRATION_SIZE, "calibration data: wrong size")
        return Frame.from_head(MessageType.CALIBRATION_DATA, self.data)
