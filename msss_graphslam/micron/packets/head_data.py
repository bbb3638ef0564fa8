# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""mtHeadData: one beam."""

import struct
from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any, Self

from msss_graphslam.micron.frame import Frame, MessageType
from msss_graphslam.micron.packets.control import HeadControl, HeadStatus
from msss_graphslam.micron.packets.layout import pack, require

__all__ = ["TURN", "HeadData", "Sweep"]

TURN = 6400
"""Steps of a turn: the unit of bearings is 1/16 gradian."""
_FIELDS = struct.Struct("<HBBBHHIBHBBHHHHBHH")


class Sweep(IntEnum):
    """Where in its sector a beam lies."""

    NORMAL = 0
    LEFT_LIMIT = 1
    RIGHT_LIMIT = 2
    CENTRE = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class HeadData:
    """One beam as the head sent it, in the protocol's units.

    ``range_scale`` is a label [dm, the top two bits a unit]: ``ad_interval`` [640 ns] between two
    bins is what was measured. ``left_limit``, ``right_limit``, ``step`` and ``bearing`` are
    1/16 gradian, 3200 is straight ahead. ``gain`` 0..210 and ``ad_span``, ``ad_low`` 0..255 span
    80 dB. ``transmit`` is the frequency times 2^32 / 32 MHz. ``data`` holds a bin a byte if
    ``control`` has EIGHT_BIT, else two. ``sweep`` is a :class:`Sweep`, or what else a head says.
    """

    device_type: int
    status: HeadStatus
    sweep: int
    control: HeadControl
    range_scale: int
    transmit: int
    gain: int
    slope: int
    ad_span: int
    ad_low: int
    heading_offset: int
    ad_interval: int
    left_limit: int
    right_limit: int
    step: int
    bearing: int
    data: bytes

    @property
    def bins(self) -> int:
        """How many bins the beam has."""
        return len(self.data) * (1 if HeadControl.EIGHT_BIT in self.control else 2)

    @classmethod
    def decode(cls, frame: Frame) -> Self:
        """Read the payload.

        Raises
        ------
        PacketError
            If it is too short or has no bins, its sizes differ, or its bearing is beyond a turn.
        """
        payload = frame.payload
        require(len(payload) >= _FIELDS.size, "head data: too short")
        total, *numbers, data_size = _FIELDS.unpack_from(payload)
        data = payload[_FIELDS.size :]
        require(total == len(payload), "head data: its size disagrees with the packet's")
        require(bool(data), "head data: no bins")
        require(data_size == len(data), "head data: its bins disagree with the packet's size")
        named: dict[str, Any] = dict(zip(_NAMES, numbers, strict=True))
        require(named["bearing"] < TURN, "head data: the bearing is beyond a turn")
        named["status"] = HeadStatus(named["status"])
        named["control"] = HeadControl(named["control"])
        return cls(**named, data=data)

    def frame(self) -> Frame:
        """Return the packet; PacketError where a number does not fit."""
        numbers = [getattr(self, name) for name in _NAMES]
        size = _FIELDS.size + len(self.data)
        fields = pack(_FIELDS, size, *numbers, len(self.data))
        return Frame.from_head(MessageType.HEAD_DATA, fields + self.data)


_NAMES = tuple(field.name for field in fields(HeadData))[:-1]
