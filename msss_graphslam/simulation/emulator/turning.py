# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where the transducer points from beam to beam; bearings in 1/16 gradian, clockwise."""

from dataclasses import dataclass

from msss_graphslam.micron.packets import TURN, Sweep

__all__ = ["AHEAD", "Turning", "Way"]

AHEAD = 3200


@dataclass(frozen=True, slots=True)
class Way:
    """The transducer's way: a full turn again and again, or to and fro between two limits.

    ``left`` and ``right`` are the limits, seen clockwise from left to right; ``step`` is positive.
    """

    left: int
    right: int
    step: int
    continuous: bool

    @property
    def width(self) -> int:
        """How far the right limit lies behind the left one."""
        return (self.right - self.left) % TURN

    def holds(self, bearing: int) -> bool:
        """Whether the transducer may point to ``bearing``."""
        return self.continuous or (bearing - self.left) % TURN <= self.width


@dataclass(slots=True)
class Turning:
    """The motor: ``bearing`` of the next beam, whether it goes on ``clockwise``, the ``sweep``.

    A DST cuts the last step before a limit short, and on the limit says already the sense of the
    way back. A head that ``turns_early`` (recorded: device type 2) turns where the next step would
    go beyond, and shows this bearing twice, once in each sense; it says nothing of limits.
    """

    turns_early: bool = False
    bearing: int = AHEAD
    clockwise: bool = True
    sweep: Sweep = Sweep.NORMAL

    def begin(self, way: Way, clockwise: bool) -> None:
        """Take up a way: from here, or from the limit where it starts."""
        self.clockwise = clockwise
        self.sweep = Sweep.NORMAL
        if not way.holds(self.bearing):
            self.bearing = way.left if clockwise else way.right

    def advance(self, way: Way) -> None:
        """Turn to the next bearing."""
        step = way.step if self.clockwise else -way.step
        self.sweep = Sweep.NORMAL
        if way.continuous:
            self.bearing = (self.bearing + step) % TURN
            return
        offset = (self.bearing - way.left) % TURN
        if self.turns_early and not 0 <= offset + step <= way.width:
            self.clockwise = not self.clockwise
            return
        self._advance_to(offset + step, way)

    def _advance_to(self, offset: int, way: Way) -> None:
        if not self.turns_early and offset >= way.width:
            self.sweep, self.clockwise = Sweep.RIGHT_LIMIT, False
        elif not self.turns_early and offset <= 0:
            self.sweep, self.clockwise = Sweep.LEFT_LIMIT, True
        self.bearing = (way.left + min(max(offset, 0), way.width)) % TURN
