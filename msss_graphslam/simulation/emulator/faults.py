# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What can be wrong with a head and its cable, to order."""

from dataclasses import dataclass

import numpy as np

from msss_graphslam.errors import UserError
from msss_graphslam.simulation.streams import stream

__all__ = ["Faults", "Noise", "Span"]

_LONGEST_BURST = 60
_BITS = 8


@dataclass(frozen=True, slots=True)
class Span:
    """A time span: ``start`` and ``duration`` [s]."""

    start: float
    duration: float

    def __post_init__(self) -> None:
        if not (self.start >= 0.0 and self.duration > 0.0):
            raise UserError(f"{self.start:g}:{self.duration:g}: no time span after the start")

    def holds(self, time: float) -> bool:
        """Whether ``time`` [s] lies in it."""
        return self.start <= time < self.start + self.duration


@dataclass(frozen=True, slots=True)
class Faults:
    """The faults to order; times in seconds after the emulator's start.

    ``garbage`` is the share of packets with a burst of random bytes before them; ``lost`` and
    ``flipped`` are the shares of bytes, both ways, that get lost or have one bit flipped. With
    ``split`` > 0 packets arrive in pieces of up to so many bytes. At ``resets`` the head loses its
    power for a moment, at ``motor_errors`` its bearing; in ``silences`` nothing comes from it,
    while ``unplugged`` the port is gone. Raises UserError where a value makes no sense.
    """

    garbage: float = 0.0
    lost: float = 0.0
    flipped: float = 0.0
    split: int = 0
    resets: tuple[float, ...] = ()
    motor_errors: tuple[float, ...] = ()
    silences: tuple[Span, ...] = ()
    unplugged: tuple[Span, ...] = ()

    def __post_init__(self) -> None:
        for name in ("garbage", "lost", "flipped"):
            share = getattr(self, name)
            if not 0.0 <= share <= 1.0:
                raise UserError(f"{name} = {share!r}: must be a share from 0 to 1")
        if self.split < 0:
            raise UserError(f"split = {self.split}: must not be negative")

    def silent(self, time: float) -> bool:
        """Whether nothing comes from the head at ``time`` [s]."""
        return any(span.holds(time) for span in self.silences)

    def plugged(self, time: float) -> bool:
        """Whether the port is there at ``time`` [s]."""
        return not any(span.holds(time) for span in self.unplugged)

    def changes(self) -> tuple[float, ...]:
        """Return the times [s] at which something happens, in order."""
        edges = [at for span in self.unplugged for at in (span.start, span.start + span.duration)]
        return tuple(sorted([*self.resets, *self.motor_errors, *edges]))


class Noise:
    """The line's disturbances; the same ``seed`` and bytes give the same ones."""

    def __init__(self, faults: Faults, seed: int, direction: str) -> None:
        self._faults = faults
        self._generator = stream(seed, f"line {direction}")

    def on(self, packet: bytes) -> bytes:
        """Return what arrives of a packet, garbage before it included."""
        sent = self._burst() + packet
        if not (self._faults.lost or self._faults.flipped):
            return sent
        values = np.frombuffer(sent, dtype=np.uint8)
        flipped = self._generator.random(len(values)) < self._faults.flipped
        bits = np.uint8(1) << self._generator.integers(0, _BITS, len(values), dtype=np.uint8)
        arrives = self._generator.random(len(values)) >= self._faults.lost
        return np.where(flipped, values ^ bits, values).astype(np.uint8)[arrives].tobytes()

    def pieces(self, data: bytes) -> list[bytes]:
        """Return the data as it is read: whole, or in pieces."""
        longest = self._faults.split
        if not longest:
            return [data] if data else []
        pieces = []
        while data:
            size = int(self._generator.integers(1, longest, endpoint=True))
            pieces.append(data[:size])
            data = data[size:]
        return pieces

    def _burst(self) -> bytes:
        if not self._faults.garbage or self._generator.random() >= self._faults.garbage:
            return b""
        return self._generator.bytes(
            int(self._generator.integers(1, _LONGEST_BURST, endpoint=True))
        )
