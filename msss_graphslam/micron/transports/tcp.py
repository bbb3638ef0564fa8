# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The head behind a serial server: its bytes over TCP as they are."""

import select
import socket
from contextlib import suppress

from msss_graphslam.micron.transports.transport import TransportError

__all__ = ["TcpLine"]

_CONNECTING = 2.0  # s
_WRITING = 1.0  # s
_PIECE = 65536
_OPTIONS = [
    (socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1),
    (socket.IPPROTO_TCP, socket.TCP_NODELAY, 1),
]
# A server that is gone without a word is missed after 4 s. Not every system has these.
_KEEPALIVE = {"TCP_KEEPIDLE": 1, "TCP_KEEPINTVL": 1, "TCP_KEEPCNT": 3, "TCP_USER_TIMEOUT": 4000}


class TcpLine:
    """A connection to a serial server that passes all bytes through."""

    def __init__(self, host: str, port: int) -> None:
        self._address = host, port
        self._socket: socket.socket | None = None

    def open(self) -> None:
        """Connect."""
        try:
            self._socket = socket.create_connection(self._address, timeout=_CONNECTING)
            self._socket.settimeout(_WRITING)
            for option in _options():
                self._socket.setsockopt(*option)
        except (OSError, UnicodeError) as error:
            raise self._error(error) from error

    def read(self, timeout: float) -> bytes:
        """Return the bytes that are there, waiting ``timeout`` [s] for the first of them."""
        line = self._opened()
        try:
            if not select.select([line], [], [], timeout)[0]:
                return b""
            data = line.recv(_PIECE)
        except (OSError, ValueError) as error:
            raise self._error(error) from error
        if not data:
            raise self._error("the server has ended the connection")
        return data

    def write(self, data: bytes) -> None:
        """Send the bytes."""
        line = self._opened()
        try:
            line.sendall(data)
        except OSError as error:
            raise self._error(error) from error

    def close(self) -> None:
        """End the connection."""
        if self._socket is not None:
            with suppress(OSError):
                self._socket.close()
        self._socket = None

    def _opened(self) -> socket.socket:
        if self._socket is None:
            raise self._error("it is not connected")
        return self._socket

    def _error(self, reason: Exception | str) -> TransportError:
        host, port = self._address
        return TransportError(f"serial server {host}, port {port}: {reason}")


def _options() -> list[tuple[int, int, int]]:
    known = [(name, value) for name, value in _KEEPALIVE.items() if hasattr(socket, name)]
    keepalive = [(socket.IPPROTO_TCP, getattr(socket, name), value) for name, value in known]
    return _OPTIONS + keepalive
