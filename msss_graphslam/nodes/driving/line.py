# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which line leads to the head, who speaks on it, and what to do where it does not open."""

from collections import Counter
from pathlib import Path

from msss_graphslam.config.groups import Micron
from msss_graphslam.core.types import Beam
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.raw_log import RawBeams
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.transports.file import RecordedFile
from msss_graphslam.micron.transports.link import Link
from msss_graphslam.micron.transports.serial_port import SerialPort
from msss_graphslam.micron.transports.tcp import TcpLine
from msss_graphslam.micron.transports.transport import Transport

__all__ = ["FileDriver", "advice_for", "link_to", "speaker_for"]

_ADVICE = {
    "no file": "the parameter file must name one",
    "is not there": "is the adapter plugged in? ls -l /dev/serial/by-id shows its name",
    "not permitted": "sudo usermod -aG dialout $USER, then log in again",
    "another program": "fuser -v PORT names it; ModemManager does that, too",
    "refused": "does the serial server run, and is tcp_port its port?",
    "timed out": "is the server switched on, and host its address?",
    "no route": "is the network up?",
    "name resolution": "is the network up, and host right?",
    "not known": "host must be a name or an address that this machine can reach",
}


class FileDriver:
    """Reads what a head has sent; as HeadDriver, but that there is nobody to talk to."""

    def __init__(self, micron: Micron) -> None:
        self._beams = RawBeams(micron.sound_speed, micron.inverted, micron.baudrate)
        self.next_ns: int | None = None
        self.state = "reading"
        self.missing = 0

    @property
    def refused(self) -> Counter[str]:
        """What could not be used so far, by reason."""
        return self._beams.refused

    @property
    def skipped_bytes(self) -> int:
        """Bytes so far that belong to no packet."""
        return self._beams.skipped_bytes

    @property
    def period(self) -> float:
        """The time [s] between two beams as observed; 0 before the first."""
        return self._beams.period

    def opened(self, now_ns: int) -> None:
        """Begin: the line is open."""

    def closed(self, now_ns: int) -> None:
        """End: the line is closed."""

    def feed(self, data: bytes, now_ns: int) -> list[Beam]:
        """Return the beams that these bytes, read at ``now_ns``, complete."""
        return self._beams.feed(data, now_ns)

    def due(self, now_ns: int) -> list[bytes]:
        """Return nothing."""
        del now_ns
        return []


def speaker_for(micron: Micron) -> HeadDriver | FileDriver:
    """Return who speaks on the line; raises ParameterError where no head can do what is asked."""
    return FileDriver(micron) if micron.source == "file" else HeadDriver(HeadSettings(micron))


def link_to(micron: Micron) -> Link:
    """Return the line that the parameters name, not open yet."""
    return Link(_transport(micron))


def _transport(micron: Micron) -> Transport:
    if micron.source == "tcp":
        return TcpLine(micron.host, micron.tcp_port)
    if micron.source == "file":
        return RecordedFile(Path(micron.file), micron.baudrate)
    return SerialPort(micron.port, micron.baudrate)


def advice_for(error: str) -> str:
    """Return what to do about a line that does not open; empty where nobody knows."""
    return next((advice for sign, advice in _ADVICE.items() if sign in error.lower()), "")
