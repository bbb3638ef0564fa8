# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bytes of a head that were kept in a file, as from ``cat /dev/ttyUSB0 > file``."""

import time
from contextlib import suppress
from io import BufferedReader
from pathlib import Path

from msss_graphslam.micron.frame import Frame
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import HeadData, PacketError, decode_packet
from msss_graphslam.micron.timing import STEP_ANGLE, beam_period, listening_time
from msss_graphslam.micron.transports.transport import TransportEndedError, TransportError

__all__ = ["RecordedFile"]

_PIECE = 64  # bytes; shorter than two packets of data
_LONGEST = 65536  # bytes without a packet that are given out together


class RecordedFile:
    """A file has no times: its packets come at the pace at which such a head sends them."""

    def __init__(self, path: Path, baudrate: int) -> None:
        self._path = path
        self._baudrate = baudrate
        self._file: BufferedReader | None = None
        self._framer = Framer()
        self._next = b""
        self._due = 0.0

    def open(self) -> None:
        """Begin at the file's start."""
        try:
            if not self._path.is_file():
                raise self._error("it is not there, or no file")
            self._file = self._path.open("rb")
        except (OSError, ValueError) as error:
            raise self._error(error) from error
        self._framer, self._next, self._due = Framer(), b"", time.monotonic()

    def read(self, timeout: float) -> bytes:
        """Return the bytes up to the end of the next packet when its time has come."""
        if not self._next:
            self._next = self._piece()
        wait = self._due - time.monotonic()
        if wait > 0.0:
            time.sleep(min(wait, timeout))
        if wait > timeout:
            return b""
        data, self._next = self._next, b""
        return data

    def write(self, data: bytes) -> None:
        """Nobody listens."""

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            with suppress(OSError):
                self._file.close()
        self._file = None

    def _piece(self) -> bytes:
        """Return the bytes up to the end of the next beam, and say when they are due."""
        if self._file is None:
            raise self._error("it is not open")
        data = b""
        while len(data) < _LONGEST:
            try:
                more = self._file.read(_PIECE)
            except OSError as error:
                raise self._error(error) from error
            data += more
            period = sum(map(self._period, self._framer.feed(more)))
            if period or not more:
                break
        if not data:
            raise TransportEndedError(f"file {self._path}: it is at its end")
        self._due = max(self._due, time.monotonic() - period) + period
        return data

    def _period(self, frame: Frame) -> float:
        """Return the time [s] that the head took for a beam, 0 for other packets."""
        try:
            beam = decode_packet(frame)
        except PacketError:
            return 0.0
        if not isinstance(beam, HeadData):
            return 0.0
        listening = listening_time(beam.ad_interval, beam.bins)
        return beam_period(listening, beam.step * STEP_ANGLE, len(beam.data), self._baudrate)

    def _error(self, reason: Exception | str) -> TransportError:
        return TransportError(f"file {self._path}: {reason}")
