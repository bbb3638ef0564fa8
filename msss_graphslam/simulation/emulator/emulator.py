# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A head, its cable, and the faults of both, without input and output."""

from collections import deque
from dataclasses import replace

from msss_graphslam.micron.timing import transfer_time
from msss_graphslam.simulation.emulator.faults import Faults, Noise
from msss_graphslam.simulation.emulator.head import Head
from msss_graphslam.simulation.emulator.sending import Transmission, nanoseconds

__all__ = ["Emulator"]


class Emulator:
    """What stands at the driver's port.

    All times are integer nanoseconds of one clock, the caller's; ``started_ns`` is when the head
    gets its power and the vehicle sets off. The same calls give the same bytes.
    """

    def __init__(self, head: Head, faults: Faults, seed: int, started_ns: int) -> None:
        self._head = head
        self._faults = faults
        self._started_ns = started_ns
        self._to_host = Noise(faults, seed, "to the host")
        self._line_ns = started_ns
        self._powered_up_ns = started_ns
        self._to_head = Noise(replace(faults, garbage=0.0), seed, "to the head")
        self._on_the_line: deque[tuple[int, bytes]] = deque()
        self._changes = self._stamps(faults.changes())
        self._resets = self._stamps(faults.resets)
        self._errors = self._stamps(faults.motor_errors)

    @property
    def next_ns(self) -> int:
        """When ``due`` has to be called again, at the latest."""
        times = [self._head.next_ns, *self._changes[:1]]
        if self._on_the_line:
            times.append(self._on_the_line[0][0])
        return min(times)

    def plugged(self, now_ns: int) -> bool:
        """Whether the port is there."""
        return self._faults.plugged(self._seconds(now_ns))

    def receive(self, data: bytes, now_ns: int) -> None:
        """Take what the driver has sent."""
        self._advance(now_ns)
        if self.plugged(now_ns):
            self._head.receive(self._to_head.on(data), now_ns)
            self._cut_after_restart()

    def due(self, now_ns: int) -> list[bytes]:
        """Return what has come from the head by now, in the pieces to be read."""
        self._advance(now_ns)
        pieces = []
        while self._on_the_line and self._on_the_line[0][0] <= now_ns:
            at, piece = self._on_the_line.popleft()
            seconds = self._seconds(at)
            if self._faults.plugged(seconds) and not self._faults.silent(seconds):
                pieces.append(piece)
        return pieces

    def _advance(self, now_ns: int) -> None:
        """Let happen what happens up to now."""
        while self._changes and self._changes[0] <= now_ns:
            self._run_head(self._changes[0])
            self._change(self._changes.pop(0))
        self._run_head(now_ns)

    def _run_head(self, now_ns: int) -> None:
        for transmission in self._head.due(now_ns):
            self._put(transmission)

    def _change(self, at_ns: int) -> None:
        if self._resets[:1] == [at_ns]:
            self._resets.pop(0)
            self._head.restart(at_ns)
            self._cut_after_restart()
        if self._errors[:1] == [at_ns]:
            self._errors.pop(0)
            self._head.lose_sync()

    def _cut_after_restart(self) -> None:
        """Drop what a head that has just lost its power had not sent yet."""
        at_ns = self._head.powered_up_ns
        if at_ns != self._powered_up_ns:
            while self._on_the_line and self._on_the_line[-1][0] > at_ns:
                self._on_the_line.pop()
            self._line_ns = at_ns
            self._powered_up_ns = at_ns

    def _put(self, transmission: Transmission) -> None:
        """Put a packet on the line: whole at the time of its last byte, or in pieces before."""
        left = len(arriving := self._to_host.on(transmission.data))
        for piece in self._to_host.pieces(arriving):
            left -= len(piece)
            early_ns = nanoseconds(transfer_time(left, self._head.baudrate))
            # Garbage takes its time, too, but nothing overtakes what was sent before.
            self._line_ns = max(self._line_ns, transmission.ends_ns - early_ns)
            self._on_the_line.append((self._line_ns, piece))

    def _stamps(self, times: tuple[float, ...]) -> list[int]:
        return [self._started_ns + nanoseconds(at) for at in sorted(times)]

    def _seconds(self, now_ns: int) -> float:
        return (now_ns - self._started_ns) * 1e-9
