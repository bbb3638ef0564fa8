# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What every transport can do."""

from typing import Protocol

__all__ = ["Transport", "TransportEndedError", "TransportError"]


class TransportError(Exception):
    """The line cannot be opened, or is lost; the message says in one line why."""


class TransportEndedError(TransportError):
    """There is nothing more to come, however often it is opened again."""


class Transport(Protocol):
    """A line to the head. Every method may raise TransportError, after which it is to be closed.

    A line that is closed can be opened again.
    """

    def open(self) -> None:
        """Open the line; what was in it before is not read."""

    def read(self, timeout: float) -> bytes:
        """Return the bytes that are there, waiting ``timeout`` [s] for the first of them."""

    def write(self, data: bytes) -> None:
        """Send the bytes."""

    def close(self) -> None:
        """Close the line, without an error if it is closed or lost."""
