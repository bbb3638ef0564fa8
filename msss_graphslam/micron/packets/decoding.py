# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From a frame to the packet that it holds."""

from dataclasses import dataclass

from msss_graphslam.micron.frame import HEAD, HOST, Frame, MessageType
from msss_graphslam.micron.packets.head_command import (
    GAINS_FORM,
    REVERSE_FORM,
    GainsCommand,
    HeadCommand,
    ReverseScan,
)
from msss_graphslam.micron.packets.head_data import HeadData
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

__all__ = ["Command", "Packet", "Reply", "Unknown", "decode_packet"]


@dataclass(frozen=True, slots=True)
class Unknown:
    """A packet of a type that is not read here."""

    content: Frame

    def frame(self) -> Frame:
        """Return the packet as it came."""
        return self.content


Reply = HeadData | Alive | VersionData | UserData | FpgaVersionData | CalibrationData
Command = (
    HeadCommand
    | GainsCommand
    | ReverseScan
    | SendData
    | SendVersion
    | SendUserData
    | Reboot
    | StopAlives
)
Packet = Reply | Command | Unknown

_REPLIES: dict[int, type[Reply]] = {
    MessageType.HEAD_DATA: HeadData,
    MessageType.ALIVE: Alive,
    MessageType.VERSION_DATA: VersionData,
    MessageType.USER_DATA: UserData,
    MessageType.FPGA_VERSION_DATA: FpgaVersionData,
    MessageType.CALIBRATION_DATA: CalibrationData,
}
_COMMANDS: dict[int, type[Command]] = {
    MessageType.SEND_DATA: SendData,
    MessageType.SEND_VERSION: SendVersion,
    MessageType.SEND_USER_DATA: SendUserData,
    MessageType.REBOOT: Reboot,
    MessageType.STOP_ALIVES: StopAlives,
}
_FORMS: dict[int, type[Command]] = {GAINS_FORM: GainsCommand, REVERSE_FORM: ReverseScan}


def decode_packet(frame: Frame) -> Packet:
    """Return what a frame of either direction holds.

    Raises
    ------
    PacketError
        If its type is known and its content breaks the protocol.
    """
    kind = _kind(frame)
    return Unknown(frame) if kind is None else kind.decode(frame)


def _kind(frame: Frame) -> type[Reply] | type[Command] | None:
    """Return the class that reads the frame, or None where none does."""
    if (frame.source, frame.destination) == (HEAD, HOST):
        return _REPLIES.get(frame.type)
    if (frame.source, frame.destination) != (HOST, HEAD):
        return None
    if frame.type == MessageType.HEAD_COMMAND:
        return _FORMS.get(frame.payload[0] if frame.payload else -1, HeadCommand)
    return _COMMANDS.get(frame.type)
