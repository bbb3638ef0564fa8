# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Packets of every type: any that the protocol allows (Hypothesis), or drawn from a generator."""

from dataclasses import fields, replace

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from benchmarks.micron_stream import head_data, payload
from msss_graphslam.micron.packets import (
    TURN,
    Alive,
    CalibrationData,
    Command,
    FpgaVersionData,
    Gains,
    GainsCommand,
    HeadCommand,
    HeadControl,
    HeadData,
    HeadInformation,
    HeadStatus,
    Reboot,
    Reply,
    ReverseScan,
    SendData,
    SendUserData,
    SendVersion,
    StopAlives,
    UserData,
    VersionData,
)

MOST_BYTES = 1500
ALIVE_HEADER = Alive(HeadInformation(0x4A)).frame().encode()[:13]

BYTE, WORD, LONG = (st.integers(0, 2**bits - 1) for bits in (8, 16, 32))
HEAD_CONTROL = WORD.map(HeadControl)
# @ and line feed are what a careless reader of packets stumbles over.
DATA_BYTE = st.one_of(st.sampled_from(b"@\n0A\x02\xff"), BYTE)


def sized(size: int) -> SearchStrategy[bytes]:
    return st.binary(min_size=size, max_size=size)


HEAD_DATA = st.builds(
    HeadData,
    device_type=BYTE,
    status=BYTE.map(HeadStatus),
    sweep=BYTE,
    control=HEAD_CONTROL,
    range_scale=WORD,
    transmit=LONG,
    gain=BYTE,
    slope=WORD,
    ad_span=BYTE,
    ad_low=BYTE,
    heading_offset=WORD,
    ad_interval=WORD,
    left_limit=WORD,
    right_limit=WORD,
    step=BYTE,
    bearing=st.integers(0, TURN - 1),
    data=st.one_of(
        st.lists(DATA_BYTE, min_size=1, max_size=80).map(bytes),
        st.integers(1, MOST_BYTES).map(lambda size: b"\n@" * (size // 2) + b"@" * (size % 2)),
    ),
)
REPLIES: SearchStrategy[Reply] = st.one_of(
    HEAD_DATA,
    st.builds(Alive, BYTE.map(HeadInformation), LONG, WORD, BYTE),
    st.builds(VersionData, BYTE, BYTE, WORD, LONG, WORD, BYTE),
    st.builds(UserData, st.one_of(sized(161), sized(250))),
    st.builds(FpgaVersionData, sized(14)),
    st.builds(CalibrationData, sized(66)),
)
GAINS = st.builds(
    Gains,
    **{field.name: WORD if field.name.startswith("slope") else BYTE for field in fields(Gains)},
)
_BYTES = {"head_type", "ad_span", "ad_low", "gain_1", "gain_2", "motor_time", "step"}
_BYTES |= {"major_axis", "control_2"}
_LONGS = {"transmit_1", "transmit_2", "receive_1", "receive_2"}
HEAD_COMMAND = st.builds(
    HeadCommand,
    **{
        field.name: BYTE if field.name in _BYTES else LONG if field.name in _LONGS else WORD
        for field in fields(HeadCommand)
    }
    | {"control": HEAD_CONTROL, "gains": st.none() | GAINS},
)
COMMANDS: SearchStrategy[Command] = st.one_of(
    HEAD_COMMAND,
    st.builds(GainsCommand, GAINS),
    st.builds(SendData, LONG),
    st.sampled_from([ReverseScan(), SendVersion(), SendUserData(), Reboot(), StopAlives()]),
)


def drawn_packets(random: np.random.Generator, count: int, kind: int = 1) -> list[bytes]:
    """Draw packets as a line carries them: mostly beams of one size, with ``payload``'s kind."""
    bins = int(random.integers(1, 500))
    others = [
        Alive(HeadInformation(0x8A), int(random.integers(1 << 32)), 3200, 0),
        VersionData(0x31, 0x11, 0, 0xB012, 0x2AEB),
        SendData(int(random.integers(1 << 32))),
        StopAlives(),
        UserData(random.bytes(250)),
    ]
    packets: list[bytes] = []
    for _ in range(count):
        if random.random() < 0.3:
            packets.append(others[int(random.integers(len(others)))].frame().encode())
        else:
            packets.append(beam(payload(random, bins, kind)))
    return packets


def beam(data: bytes, **changed: int) -> bytes:
    """Return the packet of a beam with these data."""
    return replace(head_data(data), **changed).frame().encode()
