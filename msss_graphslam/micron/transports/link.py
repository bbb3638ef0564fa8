# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A line that comes back: cable out, cable in, and on it goes."""

import time
from collections.abc import Callable

from msss_graphslam.micron.transports.transport import (
    Transport,
    TransportEndedError,
    TransportError,
)

__all__ = ["Link"]

_FIRST_PAUSE, _LONGEST_PAUSE = 0.5, 5.0  # s from one attempt to the next


class Link:
    """A transport whose faults do not get out: it is opened again, sooner at first.

    ``error`` says why the line is closed, and is empty while it is open; ``openings`` and
    ``failures`` count. There is never another line in place of the one that is missing.
    """

    def __init__(
        self,
        transport: Transport,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.is_open = False
        self.ended = False
        self.error = "not opened yet"
        self.openings = 0
        self.failures = 0
        self._transport = transport
        self._clock, self._sleep = clock, sleep
        self._pause = _FIRST_PAUSE
        self._last_failure = ""
        self._attempted = clock() - _LONGEST_PAUSE

    def read(self, timeout: float) -> bytes:
        """Return the bytes that are there; wait ``timeout`` [s] for them, or for the line."""
        if self.is_open:
            try:
                data = self._transport.read(timeout)
            except TransportError as error:
                self._lose(error)
                return b""
            if data:
                self._pause = _FIRST_PAUSE  # the line works
            return data
        wait = self._attempted + self._pause - self._clock()
        if self.ended or wait > 0.0:
            self._sleep(timeout if self.ended else min(wait, timeout))
        else:
            self._open()
        return b""

    def write(self, data: bytes) -> None:
        """Send the bytes; without a line they are lost."""
        if not self.is_open:
            return
        try:
            self._transport.write(data)
        except TransportError as error:
            self._lose(error)

    def close(self) -> None:
        """Close the line; the next read opens it again."""
        self._transport.close()
        self.is_open = False
        self.error = "closed"

    def _open(self) -> None:
        self._attempted = self._clock()
        try:
            self._transport.open()
        except TransportError as error:
            self._fail(error)
            return
        self.is_open, self.error = True, ""
        self.openings += 1

    def _lose(self, error: TransportError) -> None:
        self._attempted = self._clock()
        self._fail(error)

    def _fail(self, error: TransportError) -> None:
        """Close the line; wait longer than the last time, unless it is something else now."""
        self._transport.close()
        self.is_open = False
        self.ended = isinstance(error, TransportEndedError)
        self.failures += 1
        self.error = str(error)
        again = self.error == self._last_failure
        self._pause = min(2.0 * self._pause, _LONGEST_PAUSE) if again else _FIRST_PAUSE
        self._last_failure = self.error
