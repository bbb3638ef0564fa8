# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``$ROV,heading,roll,pitch,depth,altitude,latitude,longitude,*``: where a pilot's vehicle is.

Heading is clockwise from north, roll to starboard, pitch up [deg], depth [m]; the checksum after
the star may be missing. Position and altitude are not used.
"""

from functools import reduce
from math import radians
from operator import xor
from typing import Any, NamedTuple, Self

import numpy as np

from msss_graphslam.config.groups import Sensors
from msss_graphslam.core.compounding import wrap_angle
from msss_graphslam.core.types import Inertial
from msss_graphslam.messages import Refusal, decoding, encoding
from msss_graphslam.messages.frames import BASE_LINK
from msss_graphslam.messages.hydrostatics import pressure_at
from msss_graphslam.recordings.typestore import make

__all__ = ["RovState", "is_sentence"]

_BEGIN = b"$ROV,"
_LOWEST, _HIGHEST = (0.0, -180.0, -90.0, -10.0), (360.0, 180.0, 90.0, 11_000.0)


def is_sentence(data: bytes) -> bool:
    """Whether a datagram is text of this kind, not bytes of a head."""
    return data.startswith(_BEGIN)


class RovState(NamedTuple):
    """Angles [deg] and depth [m] as the sentence has them."""

    heading: float
    roll: float
    pitch: float
    depth: float

    @classmethod
    def of(cls, sentence: bytes) -> Self:
        """Read a sentence; raises Refusal where it is damaged."""
        body, _, checksum = sentence.rstrip(b"\r\n").partition(b"*")
        if checksum and checksum.upper() != b"%02X" % reduce(xor, body[1:]):
            raise Refusal("rov_checksum_wrong")
        try:
            state = cls(*(float(number) for number in body[len(_BEGIN) :].split(b",")[:4]))
        except (ValueError, TypeError) as error:
            raise Refusal("rov_unreadable") from error
        limits = zip(_LOWEST, state, _HIGHEST, strict=True)
        if not all(low <= value <= high for low, value, high in limits):
            raise Refusal("rov_out_of_range")
        return state

    def imu(self, stamp_ns: int) -> Any:
        """Return the attitude in ENU; rates are absent, how accurate it is is not known."""
        angles = [radians(self.roll), -radians(self.pitch), wrap_angle(radians(90 - self.heading))]
        message = encoding.imu(make, Inertial(stamp_ns, np.array(angles), None), BASE_LINK)
        decoding.inertial(message)
        return message

    def pressure(self, stamp_ns: int) -> Any:
        """Return the pressure that a run reads as this depth again, with the default density."""
        pressure = pressure_at(-self.depth, Sensors())
        message = encoding.fluid_pressure(make, stamp_ns, pressure, BASE_LINK)
        decoding.depth(message, Sensors())
        return message
