# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A head at the end of a line: one step reads, writes and follows the line's ups and downs."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from msss_graphslam.core.types import Beam
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.transports.link import Link

__all__ = ["HeadPort", "Received"]


@dataclass(frozen=True, slots=True)
class Received:
    """What a step has brought: the bytes as read, when [ns], and the beams in them."""

    data: bytes
    received_ns: int
    beams: list[Beam]


class HeadPort:
    """Ties a link and a driver together, on a clock [ns] that also makes the stamps."""

    def __init__(
        self, link: Link, driver: HeadDriver, clock: Callable[[], int] = time.time_ns
    ) -> None:
        self.link = link
        self.driver = driver
        self._clock = clock
        self._was_open = False

    def step(self, longest: float) -> Received:
        """Do what is due and wait for bytes, no longer than ``longest`` [s] if all is well."""
        now_ns = self._clock()
        self._write(now_ns)
        due_ns = self.driver.next_ns
        wait = longest if due_ns is None else min(longest, max(due_ns - now_ns, 0) * 1e-9)
        data = self.link.read(wait)
        received_ns = self._clock()
        self._follow(received_ns)
        beams = self.driver.feed(data, received_ns) if data else []
        self._write(received_ns)
        return Received(data, received_ns, beams)

    def close(self) -> None:
        """Close the line."""
        self.link.close()
        self._follow(self._clock())

    def _write(self, now_ns: int) -> None:
        for packet in self.driver.due(now_ns):
            self.link.write(packet)
        self._follow(now_ns)

    def _follow(self, now_ns: int) -> None:
        """Tell the driver when the line has been opened or lost."""
        if self.link.is_open == self._was_open:
            return
        self._was_open = self.link.is_open
        if self._was_open:
            self.driver.opened(now_ns)
        else:
            self.driver.closed(now_ns)
