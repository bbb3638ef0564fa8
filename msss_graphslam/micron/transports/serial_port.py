# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The head on a serial port."""

import errno
import select
import termios
from contextlib import suppress

import serial

from msss_graphslam.micron.transports.transport import TransportError

__all__ = ["SerialPort"]

_FAULTS = (OSError, ValueError, termios.error)  # pyserial lets all of them through
_PIECE = 4096
_WRITING = 1.0  # s
_REASONS = {
    errno.ENOENT: "it is not there",
    errno.EACCES: "not permitted: its group (dialout) must be one of the user's",
    errno.EAGAIN: "another program uses it",
    errno.EBUSY: "another program uses it",
}


class SerialPort:
    """A serial port with 8 data bits, no parity, 1 stop bit, for this program alone."""

    def __init__(self, port: str, baudrate: int) -> None:
        self._name = port
        self._baudrate = baudrate
        self._port: serial.Serial | None = None

    def open(self) -> None:
        """Open the port and throw away what it has received before."""
        try:
            self._port = serial.Serial(
                self._name, self._baudrate, timeout=0, write_timeout=_WRITING, exclusive=True
            )
        except _FAULTS as error:
            raise self._error(error) from error

    def read(self, timeout: float) -> bytes:
        """Return the bytes that are there, waiting ``timeout`` [s] for the first of them."""
        port = self._opened()
        try:
            if not select.select([port.fileno()], [], [], timeout)[0]:
                return b""
            return bytes(port.read(_PIECE))
        except _FAULTS as error:
            raise self._error(error) from error

    def write(self, data: bytes) -> None:
        """Send the bytes."""
        port = self._opened()
        try:
            port.write(data)
        except _FAULTS as error:
            raise self._error(error) from error

    def close(self) -> None:
        """Close the port."""
        if self._port is not None:
            with suppress(*_FAULTS):
                self._port.close()
        self._port = None

    def _opened(self) -> serial.Serial:
        if self._port is None:
            raise TransportError(f"serial port {self._name}: it is not open")
        return self._port

    def _error(self, error: Exception) -> TransportError:
        number = getattr(error, "errno", None)
        reason = _REASONS.get(number if number is not None else -1, str(error))
        return TransportError(f"serial port {self._name}: {reason}")
