# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Every packet both ways, and the byte strings that public drivers send."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from micron.example_packets import EXAMPLE_COMMAND, EXAMPLE_GAINS, SIZES
from micron.packet_makers import COMMANDS, REPLIES

from msss_graphslam.micron.frame import Frame, MessageType
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import (
    Alive,
    Command,
    GainsCommand,
    HeadInformation,
    Packet,
    Reboot,
    ReverseScan,
    SendData,
    SendUserData,
    SendVersion,
    StopAlives,
    UserData,
    VersionData,
    decode_packet,
)

FIXED: list[tuple[Command, str]] = [
    (SendVersion(), "40 30 30 30 38 08 00 FF 02 03 17 80 02 0A"),
    (SendUserData(), "40 30 30 30 38 08 00 FF 02 03 18 80 02 0A"),
    (Reboot(), "40 30 30 30 38 08 00 FF 02 03 10 80 02 0A"),
    (StopAlives(), "40 30 30 30 38 08 00 FF 02 03 42 80 02 0A"),
    (SendData(0x04030201), "40 30 30 30 43 0C 00 FF 02 07 19 80 02 01 02 03 04 0A"),
    (ReverseScan(), "40 30 30 30 39 09 00 FF 02 04 13 80 02 0F 0A"),
]
EXAMPLE_BYTES = bytes.fromhex(
    "40 30 30 34 43 4C 00 FF 02 47 13 80 02 1D 01 23 02 99 99 99 02 66 66 66 05 A3 70 3D 06 70 3D"
    "0A 09 28 00 3C 00 01 00 FF 18 51 08 54 54 5A 00 7D 00 19 10 8D 00 5A 00 E8 03 97 03 40 06 01"
    "00 00 00 50 51 09 08 54 54 00 00 5A 00 7D 00 00 00 00 00 0A"
)


@given(st.one_of(REPLIES, COMMANDS))
def test_both_ways(packet: Packet) -> None:
    frame = packet.frame()
    assert decode_packet(frame) == packet
    (received,) = Framer().feed(frame.encode())
    assert received == frame
    sizes = SIZES.get(MessageType(frame.type))
    assert frame.size in sizes if sizes else frame.size == 45 + len(frame.payload) - 31


@pytest.mark.parametrize(("packet", "text"), FIXED)
def test_the_commands_that_all_drivers_send(packet: Command, text: str) -> None:
    assert packet.frame().encode() == bytes.fromhex(text)
    assert [decode_packet(frame) for frame in Framer().feed(bytes.fromhex(text))] == [packet]


def test_the_head_command_of_a_public_driver() -> None:
    assert EXAMPLE_COMMAND.frame().encode() == EXAMPLE_BYTES
    assert [decode_packet(f) for f in Framer().feed(EXAMPLE_BYTES)] == [EXAMPLE_COMMAND]


def test_the_short_forms_of_the_head_command() -> None:
    short = replace(EXAMPLE_COMMAND, gains=None).frame().encode()
    assert len(short) == 66
    assert short[:14] == bytes.fromhex("40 30 30 33 43 3C 00 FF 02 37 13 80 02 01")
    assert short[14:65] == EXAMPLE_BYTES[14:65]
    gains = GainsCommand(EXAMPLE_GAINS).frame().encode()
    assert gains[:14] == bytes.fromhex("40 30 30 31 39 19 00 FF 02 14 13 80 02 1E")
    assert gains[14:] == EXAMPLE_BYTES[65:]


def test_a_real_version() -> None:
    frame = Frame.from_head(1, bytes.fromhex("31 11 00 00 12 B0 00 00 EB 2A 02"))
    assert decode_packet(frame) == VersionData(0x31, 0x11, 0, 0xB012, 0x2AEB, node=2)


@pytest.mark.parametrize(
    ("information", "true"),
    [
        (0x5D, {"recentring", "motoring", "motor_on", "direction", "no_parameters"}),
        (0x4D, {"recentring", "motoring", "motor_on", "no_parameters"}),
        (0x4A, {"centred", "motor_on", "no_parameters"}),
        (0xCA, {"centred", "motor_on", "no_parameters", "sent_configuration"}),
        (0x8A, {"centred", "motor_on", "sent_configuration"}),
        (0x20, {"in_scan"}),
    ],
)
def test_the_heads_state_is_read_from_the_lowest_bit(information: int, true: set[str]) -> None:
    alive = Alive(HeadInformation(information))
    names = {name for name in dir(Alive) if isinstance(getattr(Alive, name), property)}
    assert {name for name in names if getattr(alive, name)} == true


def test_fields_of_an_alive() -> None:
    frame = Alive(HeadInformation(0x4A), time_ms=0x01020304, bearing=3200, notice=0x80).frame()
    assert frame.payload == bytes.fromhex("80 04 03 02 01 80 0C 4A")


@pytest.mark.parametrize("full_duplex", [False, True])
@pytest.mark.parametrize("size", [161, 250])
def test_user_data_say_whether_both_may_talk(full_duplex: bool, size: int) -> None:
    packet = UserData.of(full_duplex).frame().encode()
    assert (len(packet), packet[146] == 0) == (264, full_duplex)
    assert UserData(bytes(133) + bytes([not full_duplex]) + bytes(size - 134)).full_duplex == (
        full_duplex
    )
