# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a head may send in a while, made up: a greeting, then beams of one setting."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.micron.packets import (
    TURN,
    Alive,
    CalibrationData,
    FpgaVersionData,
    HeadControl,
    HeadData,
    HeadInformation,
    HeadStatus,
    Reply,
    UserData,
    VersionData,
)

__all__ = ["Sent", "head_data", "payload", "sent_bytes"]

_BEAMS = 500
_HOSTILE_BINS = (227, 235, 483, 491, 739, 747)
"""Bins with which one of the packet's two sizes has a line feed as its lower byte."""


@dataclass(frozen=True, slots=True)
class Sent:
    """The bytes of many packets, and where each one starts and ends."""

    data: NDArray[np.uint8]
    starts: NDArray[np.intp]
    ends: NDArray[np.intp]


def sent_bytes(random: np.random.Generator) -> Sent:
    """Return the packets of one setting: an hour is many of these, each with other bins."""
    hostile = random.random() < 0.02
    bins = int(random.choice(_HOSTILE_BINS) if hostile else random.integers(5, 801))
    kind = int(random.integers(3))
    packets = [reply.frame().encode() for reply in _greeting(random)]
    for number in range(_BEAMS):
        if random.random() < 0.01:
            packets.append(_alive(random).frame().encode())
        beam = head_data(payload(random, bins, kind), bearing=32 * number % TURN)
        packets.append(beam.frame().encode())
    sizes = np.array([len(packet) for packet in packets], dtype=np.intp)
    ends = np.cumsum(sizes)
    return Sent(np.frombuffer(b"".join(packets), dtype=np.uint8), ends - sizes, ends)


def payload(random: np.random.Generator, bins: int, kind: int) -> bytes:
    """Return the bins of a beam: echoes (0), any bytes (1), or ``@`` and line feeds (2)."""
    if kind == 0:
        echoes = random.normal(30.0, 20.0, bins) + 100.0 * (random.random(bins) < 0.02)
        return echoes.clip(0, 255).astype(np.uint8).tobytes()
    if kind == 1:
        return random.bytes(bins)
    return random.choice(np.frombuffer(b"@\n", dtype=np.uint8), bins).tobytes()


def head_data(data: bytes, bearing: int = 3200) -> HeadData:
    """Return a beam of 8 bits a bin with the settings of a 50 m range."""
    control = HeadControl.EIGHT_BIT | HeadControl.CONTINUOUS | HeadControl.SCAN_RIGHT
    return HeadData(
        device_type=0x11,
        status=HeadStatus.EIGHT_BIT_DATA,
        sweep=0,
        control=control | HeadControl.RAW | HeadControl.HAS_MOTOR | HeadControl.REPLY_ASL,
        range_scale=500,
        transmit=0x05333333,
        gain=58,
        slope=115,
        ad_span=135,
        ad_low=34,
        heading_offset=0,
        ad_interval=133,
        left_limit=1,
        right_limit=TURN - 1,
        step=32,
        bearing=bearing,
        data=data,
    )


def _alive(random: np.random.Generator) -> Alive:
    ready = HeadInformation.MOTOR_ON | HeadInformation.SENT_CONFIGURATION
    return Alive(ready, int(random.integers(1 << 27)), int(random.integers(TURN)))


def _greeting(random: np.random.Generator) -> list[Reply]:
    """Return what a head says before it scans."""
    return [
        _alive(random),
        VersionData(0x31, 0x11, 0, 0xB012, 0x2AEB),
        UserData(random.bytes(250)),
        CalibrationData(random.bytes(66)),
        FpgaVersionData(random.bytes(14)),
        UserData(random.bytes(161)),
    ]
