# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Packets that the protocol does not allow are refused with a reason, never with another error."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from micron.example_packets import EXAMPLE_COMMAND, EXAMPLE_GAINS, SIZES
from micron.packet_makers import BYTE

from benchmarks.micron_stream import head_data
from msss_graphslam.micron.frame import HEAD, HOST, Frame, MessageType
from msss_graphslam.micron.packets import (
    Alive,
    CalibrationData,
    Command,
    FpgaVersionData,
    HeadData,
    HeadInformation,
    Packet,
    PacketError,
    Reply,
    SendData,
    Unknown,
    UserData,
    VersionData,
    decode_packet,
)


@pytest.mark.parametrize("bearing", [6400, 65535])
def test_a_bearing_beyond_a_turn_is_refused(bearing: int) -> None:
    assert decode_packet(head_data(b"a", bearing=6399).frame())
    with pytest.raises(PacketError, match="bearing"):
        decode_packet(head_data(b"a", bearing=bearing).frame())


@pytest.mark.parametrize("place", [0, 1, 29, 30])
def test_a_beam_whose_sizes_differ_is_refused(place: int) -> None:
    payload = bytearray(head_data(b"abc").frame().payload)
    payload[place] ^= 1
    with pytest.raises(PacketError, match="head data") as refusal:
        HeadData.decode(Frame.from_head(2, bytes(payload)))
    assert refusal.value.reason == str(refusal.value)


def test_a_beam_without_bins_is_refused() -> None:
    with pytest.raises(PacketError, match="no bins"):
        HeadData.decode(head_data(b"").frame())


@pytest.mark.parametrize("size", [0, 1, 7, 30, 33, 51, 53, 67, 69, 160, 249, 251])
@pytest.mark.parametrize("kind", [kind for kind in MessageType if kind != MessageType.HEAD_DATA])
def test_wrong_sizes_are_refused(kind: MessageType, size: int) -> None:
    sizes = SIZES[kind]
    if size + 14 in sizes:
        return
    for frame in (Frame.from_head(kind, bytes(size)), Frame.to_head(kind, bytes(size))):
        if isinstance(packet_or_refusal(frame), Unknown):
            continue
        assert isinstance(packet_or_refusal(frame), str)


@given(st.builds(Frame, BYTE, st.binary(max_size=300), st.just(HEAD), st.just(HOST)))
def test_no_reply_breaks_the_decoder(frame: Frame) -> None:
    assert packet_or_refusal(frame)


@given(st.builds(Frame, st.just(19), st.binary(max_size=90), st.just(HOST), st.just(HEAD)))
def test_no_command_breaks_the_decoder(frame: Frame) -> None:
    assert packet_or_refusal(frame)


def packet_or_refusal(frame: Frame) -> Packet | str:
    try:
        return decode_packet(frame)
    except PacketError as refusal:
        return refusal.reason


@pytest.mark.parametrize(
    "frame", [Frame.from_head(19, b""), Frame.to_head(2, b""), Frame(4, b"", 1, 2)]
)
def test_other_packets_stay_as_they_are(frame: Frame) -> None:
    assert decode_packet(frame) == Unknown(frame)
    assert Unknown(frame).frame() == frame


@pytest.mark.parametrize(
    "packet",
    [
        replace(EXAMPLE_COMMAND, bins=65536),
        replace(EXAMPLE_COMMAND, step=256),
        replace(EXAMPLE_COMMAND, gains=replace(EXAMPLE_GAINS, gain_1=-1)),
        SendData(-1),
        SendData(2**32),
        head_data(bytes(65536)),
        Alive(HeadInformation(0), bearing=-1),
        VersionData(256, 0, 0, 0, 0),
        UserData(bytes(160)),
        FpgaVersionData(bytes(13)),
        CalibrationData(bytes(67)),
    ],
)
def test_what_does_not_fit_is_refused(packet: Reply | Command) -> None:
    with pytest.raises(PacketError):
        packet.frame()


def test_a_frame_too_long_for_its_length_is_refused() -> None:
    assert len(Frame.from_head(2, bytes(65535 - 8)).encode()) == 65535 + 6
    with pytest.raises(ValueError, match="no packet can carry"):
        Frame.from_head(2, bytes(65536 - 8)).encode()
    with pytest.raises(ValueError, match="no packet can carry"):
        Frame.from_head(4, bytes(253)).encode()


def test_a_frame_may_say_another_count() -> None:
    assert Frame(4, bytes(8), HEAD, HOST, count=9).encode()[9] == 9
