# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where a driver finds the emulated head: a pseudo-terminal, or a TCP port."""

import os
import select
import socket
import tty
from contextlib import suppress
from pathlib import Path
from typing import Protocol

from msss_graphslam.errors import UserError

__all__ = ["Port", "PseudoTerminal", "TcpPort"]

_CHUNK = 4096


class Port(Protocol):
    """A port that can be unplugged. A driver that is not there, or too slow, loses bytes."""

    @property
    def name(self) -> str:
        """What a driver opens."""

    @property
    def plugged(self) -> bool:
        """Whether the port is there."""

    def plug(self) -> None:
        """Make the port appear; raises UserError where it cannot."""

    def unplug(self) -> None:
        """Make the port disappear."""

    def read(self, timeout: float) -> bytes:
        """Return what the driver has sent; wait for it up to ``timeout`` [s]."""

    def write(self, data: bytes) -> None:
        """Send to the driver."""


class PseudoTerminal:
    """A pseudo-terminal under the name ``link``, for drivers that open a serial port."""

    def __init__(self, link: Path) -> None:
        self._link = link
        self._ends: tuple[int, int] | None = None

    @property
    def name(self) -> str:
        """The link's path."""
        return str(self._link)

    @property
    def plugged(self) -> bool:
        """Whether the port is there."""
        return self._ends is not None

    def plug(self) -> None:
        """Open a terminal, and let the link lead to it; an older link is replaced."""
        if self._link.exists() and not self._link.is_symlink():
            raise UserError(f"{self._link}: is there already, and is no link")
        head, driver = os.openpty()
        self._ends = head, driver
        tty.setraw(driver)
        os.set_blocking(head, False)
        try:
            self._link.unlink(missing_ok=True)
            self._link.symlink_to(os.ttyname(driver))
        except OSError as error:
            self._close()
            raise UserError(f"{self._link}: cannot be made ({error.strerror})") from error

    def unplug(self) -> None:
        """Hang up, and take the link away."""
        if self._ends is None:
            return
        if self._link.is_symlink() and str(self._link.readlink()) == os.ttyname(self._ends[1]):
            self._link.unlink()
        self._close()

    def read(self, timeout: float) -> bytes:
        """Return what the driver has sent; wait for it up to ``timeout`` [s]."""
        if self._ends is None or not _readable([self._ends[0]], timeout):
            return b""
        return os.read(self._ends[0], _CHUNK)

    def write(self, data: bytes) -> None:
        """Send to the driver; what does not fit into the terminal's buffer is lost."""
        if self._ends is not None:
            with suppress(BlockingIOError):
                os.write(self._ends[0], data)

    def _close(self) -> None:
        for end in self._ends or ():
            os.close(end)
        self._ends = None


class TcpPort:
    """A port of this machine for one driver at a time, as a serial server offers it."""

    def __init__(self, number: int, host: str = "127.0.0.1") -> None:
        self._address = host, number
        self._server: socket.socket | None = None
        self._driver: socket.socket | None = None

    @property
    def name(self) -> str:
        """Host and port; with number 0 the one that the system has chosen, once plugged."""
        host, number = self._address
        return f"{host}:{number}"

    @property
    def plugged(self) -> bool:
        """Whether the port is there."""
        return self._server is not None

    def plug(self) -> None:
        """Listen."""
        try:
            self._server = socket.create_server(self._address, backlog=1)
        except OSError as error:
            raise UserError(f"{self.name}: cannot listen there ({error.strerror})") from error
        self._address = self._server.getsockname()[:2]

    def unplug(self) -> None:
        """Hang up, and refuse connections."""
        self._hang_up()
        if self._server is not None:
            self._server.close()
            self._server = None

    def read(self, timeout: float) -> bytes:
        """Return what the driver has sent; wait for it, or for a driver, up to ``timeout`` [s]."""
        waiting = self._driver or self._server
        if not _readable([] if waiting is None else [waiting], timeout):
            return b""
        if self._driver is None:
            self._accept()
            return b""
        try:
            data = self._driver.recv(_CHUNK)
        except BlockingIOError:
            return b""
        except OSError:
            data = b""
        if not data:
            self._hang_up()
        return data

    def write(self, data: bytes) -> None:
        """Send to the driver, if one is connected; what it does not take is lost."""
        if self._driver is not None:
            try:
                self._driver.send(data)
            except BlockingIOError:
                pass
            except OSError:
                self._hang_up()

    def _accept(self) -> None:
        if self._server is None:
            return
        with suppress(OSError):  # A driver may have gone again by now.
            self._driver, _ = self._server.accept()
            self._driver.setblocking(False)
            self._driver.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _hang_up(self) -> None:
        if self._driver is not None:
            self._driver.close()
            self._driver = None


def _readable(files: list[int] | list[socket.socket], timeout: float) -> bool:
    """Whether one of them can be read within ``timeout`` [s]; where there is none, wait."""
    return bool(select.select(files, [], [], max(timeout, 0.0))[0])
