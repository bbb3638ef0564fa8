# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""An emulated head by itself, and a host that speaks with it in its own time."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import (
    Alive,
    HeadCommand,
    HeadControl,
    HeadData,
    Packet,
    SendData,
    decode_packet,
)
from msss_graphslam.simulation.emulator.head import Head
from msss_graphslam.simulation.emulator.scanner import Nature

__all__ = ["FULL_TURN", "SECOND", "START_NS", "Host", "Pattern", "command"]

START_NS = 1_700_000_000_000_000_000
SECOND = 1_000_000_000
FULL_TURN = (
    HeadControl.EIGHT_BIT
    | HeadControl.CONTINUOUS
    | HeadControl.SCAN_RIGHT
    | HeadControl.RAW
    | HeadControl.HAS_MOTOR
)


def command(**changes: Any) -> HeadCommand:
    """Return parameters: 10 m, 200 bins, a full turn in steps of 1.8 degrees."""
    values: dict[str, Any] = {
        "control": FULL_TURN,
        "head_type": 0x11,
        "range_scale": 100,
        "left_limit": 0,
        "right_limit": 0,
        "ad_span": 81,
        "ad_low": 8,
        "gain_1": 84,
        "gain_2": 84,
        "step": 32,
        "ad_interval": 104,
        "bins": 200,
    }
    return HeadCommand(**{**values, **changes})


class Pattern:
    """What the head sees: codes that count up from the number of the ping."""

    def __init__(self) -> None:
        self.pings: list[tuple[float, float]] = []
        """Bearing [rad] and time [s] of every ping."""
        self.tuned: list[tuple[float, int, float]] = []

    def tune(self, listening: float, bins: int, step: float) -> None:
        self.tuned.append((listening, bins, step))

    def codes(self, bearing: float, time: float) -> NDArray[np.uint8]:
        self.pings.append((bearing, time))
        return ((len(self.pings) + np.arange(self.tuned[-1][1])) % 256).astype(np.uint8)


@dataclass
class Heard:
    """A packet of the head, and when its last byte was there [s after power-up]."""

    at: float
    packet: Packet


class Host:
    """Speaks with a head; times are seconds after power-up."""

    def __init__(self, nature: Nature | None = None, look: Any = None) -> None:
        self.look = look or Pattern()
        self.head = Head(self.look, nature or Nature(), START_NS)
        self.time = 0.0
        self.heard: list[Heard] = []
        self._framer = Framer()

    def wait_until(self, time: float) -> None:
        """Let the head work until then."""
        self.time = time
        for sent in self.head.due(START_NS + round(time * SECOND)):
            at = (sent.ends_ns - START_NS) / SECOND
            self.heard += [
                Heard(at, decode_packet(frame)) for frame in self._framer.feed(sent.data)
            ]

    def wait(self, seconds: float) -> None:
        self.wait_until(self.time + seconds)

    def send(self, *packets: Any, after: float = 0.0) -> None:
        """Send packets, one after the other, at one time."""
        self.wait(after)
        for packet in packets:
            self.head.receive(packet.frame().encode(), START_NS + round(self.time * SECOND))

    def set_up(self, *parameters: HeadCommand, **changes: Any) -> "Host":
        """Wait for the centre, send parameters and wait for them to be taken."""
        self.wait(3.0)
        self.send(*(parameters or (command(**changes),)))
        self.wait(1.5)
        return self

    def scan(self, beams: int) -> list[HeadData]:
        """Ask for beams as fast as they come; return that many."""
        already = len(self.of(HeadData))
        patience = self.time + 0.2 * beams + 1.0
        while len(self.of(HeadData)) < already + beams:
            assert self.time < patience, "the head is silent"
            self.send(SendData())
            self.wait(0.05)
        return [heard.packet for heard in self.of(HeadData)[already : already + beams]]  # type: ignore[misc]

    def of(self, kind: type) -> list[Heard]:
        """Return what was heard of that kind."""
        return [heard for heard in self.heard if isinstance(heard.packet, kind)]

    @property
    def alives(self) -> list[tuple[float, int]]:
        """The times and the information of all alives."""
        return [
            (heard.at, int(heard.packet.information))
            for heard in self.heard
            if isinstance(heard.packet, Alive)
        ]
