# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""mtHeadCommand: how the head shall scan, whole or in part."""

import struct
from dataclasses import dataclass, fields
from typing import Any, Self

from msss_graphslam.micron.frame import Frame, MessageType
from msss_graphslam.micron.packets.control import HeadControl
from msss_graphslam.micron.packets.layout import pack, require

__all__ = ["Gains", "GainsCommand", "HeadCommand", "ReverseScan"]

SHORT_FORM, REVERSE_FORM, LONG_FORM, GAINS_FORM = 0x01, 0x0F, 0x1D, 0x1E
_BODY = struct.Struct("<HBIIIIHHHHBBBBHHBBHHHHHBBH")
_GAINS = struct.Struct("<BBBBBBBBHHHH")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """The block of gains for both channels at the end of the long form (V3B)."""

    ad_span_1: int
    ad_span_2: int
    ad_low_1: int
    ad_low_2: int
    gain_1: int
    gain_2: int
    set_point_1: int = 0
    set_point_2: int = 0
    slope_1: int = 0x5A
    slope_2: int = 0x7D
    slope_delay_1: int = 0
    slope_delay_2: int = 0

    @classmethod
    def unpack(cls, data: bytes) -> Self:
        """Read the 16 bytes of the block."""
        return cls(**dict(zip(_GAIN_NAMES, _GAINS.unpack(data), strict=True)))

    def pack(self) -> bytes:
        """Return the 16 bytes of the block; PacketError where a number does not fit."""
        return pack(_GAINS, *(getattr(self, name) for name in _GAIN_NAMES))


@dataclass(frozen=True, slots=True, kw_only=True)
class HeadCommand:
    """All parameters of a scan, in the protocol's units: see :class:`HeadData`.

    A DST ignores the frequencies ``transmit`` and ``receive``, ``pulse_length`` [us] and the
    slopes; they are given as other drivers send them. ``motor_time`` [10 us]; ``lockout`` [us];
    ``bins`` and ``ad_interval`` [640 ns] make the range, ``range_scale`` [dm] is its label.
    Without ``gains`` it is the short form of a head with one channel.
    """

    control: HeadControl
    head_type: int
    transmit_1: int = 0x02999999
    transmit_2: int = 0x05666666
    receive_1: int = 0x063D70A3
    receive_2: int = 0x090A3D70
    pulse_length: int = 40
    range_scale: int
    left_limit: int
    right_limit: int
    ad_span: int
    ad_low: int
    gain_1: int
    gain_2: int
    slope_1: int = 0x5A
    slope_2: int = 0x7D
    motor_time: int = 25
    step: int
    ad_interval: int
    bins: int
    ad_buffer: int = 1000
    lockout: int = 100
    minor_axis: int = 1600
    major_axis: int = 1
    control_2: int = 0
    scan_z: int = 0
    gains: Gains | None = None

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the short or the long form; PacketError if form and size disagree."""
        form, body = frame.payload[:1], frame.payload[1 : 1 + _BODY.size]
        block = frame.payload[1 + _BODY.size :]
        size = {SHORT_FORM: 0, LONG_FORM: _GAINS.size}.get(form[0] if form else -1)
        require(size is not None, "head command: unknown form")
        require(len(body) == _BODY.size and len(block) == size, "head command: wrong size")
        named: dict[str, Any] = dict(zip(_BODY_NAMES, _BODY.unpack(body), strict=True))
        named["control"] = HeadControl(named["control"])
        return cls(**named, gains=Gains.unpack(block) if block else None)

    def frame(self) -> Frame:
        """Return the packet; PacketError where a number does not fit."""
        body = pack(_BODY, *(getattr(self, name) for name in _BODY_NAMES))
        if self.gains is None:
            payload = bytes([SHORT_FORM]) + body
        else:
            payload = bytes([LONG_FORM]) + body + self.gains.pack()
        return Frame.to_head(MessageType.HEAD_COMMAND, payload)


@dataclass(frozen=True, slots=True)
class GainsCommand:
    """The form of mtHeadCommand that changes the gains alone."""

    gains: Gains

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the payload; PacketError if form or size are wrong."""
        require(frame.payload[:1] == bytes([GAINS_FORM]), "gains command: unknown form")
        require(len(frame.payload) == 1 + _GAINS.size, "gains command: wrong size")
        return cls(Gains.unpack(frame.payload[1:]))

    def frame(self) -> Frame:
        """Return the packet; PacketError where a number does not fit."""
        return Frame.to_head(MessageType.HEAD_COMMAND, bytes([GAINS_FORM]) + self.gains.pack())


@dataclass(frozen=True, slots=True)
class ReverseScan:
    """The form of mtHeadCommand that turns the scan's direction round."""

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the payload; PacketError if it is not that form."""
        require(frame.payload == bytes([REVERSE_FORM]), "reverse command: wrong size")
        return cls()

    def frame(self) -> Frame:
        """Return the packet."""
        return Frame.to_head(MessageType.HEAD_COMMAND, bytes([REVERSE_FORM]))


_BODY_NAMES = tuple(field.name for field in fields(HeadCommand))[:-1]
_GAIN_NAMES = tuple(field.name for field in fields(Gains))
