# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A head that answers at once and by the book, as small as tests of the session can do with."""

from dataclasses import dataclass, field, replace

from benchmarks.micron_stream import head_data
from msss_graphslam.core.types import Beam
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.packets import (
    TURN,
    Alive,
    HeadCommand,
    HeadData,
    HeadInformation,
    Reboot,
    SendData,
    SendUserData,
    SendVersion,
    UserData,
    VersionData,
    decode_packet,
)

START_NS = 1_750_000_000_000_000_000
SECOND = 1_000_000_000
ALIVE_NS = SECOND
RECENTRING, READY, SENT, SET_UP = (HeadInformation(i) for i in (0x5D, 0x4A, 0xCA, 0x8A))


@dataclass
class ScriptedHead:
    """Sends ``replies`` beams a request, each ``period_ns`` after the one before.

    ``mute`` heads hear, but say nothing; ``heard`` are the commands so far.
    """

    replies: int = 1
    period_ns: int = 43_000_000
    centring_ns: int = 3 * SECOND
    mute: bool = False
    takes_parameters: bool = True
    heard: list[object] = field(default_factory=list)
    command: HeadCommand | None = None
    beams_sent: int = 0

    def __post_init__(self) -> None:
        self._framer = Framer()
        self._outgoing: list[tuple[int, bytes]] = []
        self.restart(START_NS)

    def restart(self, now_ns: int) -> None:
        self.command = None
        self.bearing = TURN // 2
        self._outgoing = []
        self.ready_ns = now_ns + self.centring_ns
        self._alive_ns = now_ns + ALIVE_NS // 2
        self._free_ns = now_ns

    def heard_of(self, kind: type) -> list[object]:
        return [packet for packet in self.heard if isinstance(packet, kind)]

    @property
    def next_ns(self) -> int:
        return min([self._alive_ns, *(when for when, _ in self._outgoing)])

    def receive(self, data: bytes, now_ns: int) -> None:
        for frame in self._framer.feed(data):
            packet = decode_packet(frame)
            self.heard.append(packet)
            self._obey(packet, now_ns)

    def due(self, now_ns: int) -> list[bytes]:
        if now_ns >= self._alive_ns:
            self._alive_ns = now_ns + ALIVE_NS
            self._say(Alive(self._information(now_ns)), now_ns)
        ready = sorted(item for item in self._outgoing if item[0] <= now_ns)
        self._outgoing = [item for item in self._outgoing if item[0] > now_ns]
        return [] if self.mute else [data for _, data in ready]

    def beam(self) -> HeadData:
        command = self.command
        assert command is not None
        self.bearing = (self.bearing + command.step) % TURN
        self.beams_sent += 1
        echoes = bytes((self.beams_sent + i) % 256 for i in range(command.bins))
        return replace(
            head_data(echoes),
            control=command.control,
            ad_interval=command.ad_interval,
            step=command.step,
            left_limit=command.left_limit,
            right_limit=command.right_limit,
            bearing=self.bearing,
        )

    def _obey(self, packet: object, now_ns: int) -> None:
        match packet:
            case Reboot():
                self.restart(now_ns)
            case SendVersion():
                self._say(VersionData(0x31, 0x11, 7, 0, 0), now_ns + 1_000_000)
            case SendUserData():
                self._say(UserData.of(self.replies == 2), now_ns + 1_000_000)
            case HeadCommand() if self.takes_parameters and now_ns >= self.ready_ns:
                self.command, self._outgoing = packet, []
                self._alive_ns = now_ns + ALIVE_NS // 10
            case SendData() if self.command is not None:
                self._alive_ns = now_ns + ALIVE_NS
                for _ in range(self.replies):
                    self._free_ns = max(self._free_ns, now_ns) + self.period_ns
                    self._say(self.beam(), self._free_ns)

    def _say(self, packet: Alive | VersionData | UserData | HeadData, when_ns: int) -> None:
        self._outgoing.append((when_ns, packet.frame().encode()))

    def _information(self, now_ns: int) -> HeadInformation:
        if now_ns < self.ready_ns:
            return RECENTRING
        return READY if self.command is None else SET_UP


class Bench:
    """A driver and a head on one clock, without a line between them."""

    def __init__(self, driver: HeadDriver, head: ScriptedHead) -> None:
        self.driver, self.head = driver, head
        self.now_ns = START_NS
        self.beams: list[tuple[int, Beam]] = []
        self.connected = True

    def run(self, seconds: float) -> None:
        """Let time pass."""
        end_ns = self.now_ns + round(seconds * SECOND)
        while self.now_ns < end_ns:
            for packet in self.driver.due(self.now_ns):
                if self.connected:
                    self.head.receive(packet, self.now_ns)
            soonest = [end_ns, self.driver.next_ns or end_ns, self.head.next_ns]
            self.now_ns = max(min(soonest), self.now_ns + 1_000_000)
            for data in self.head.due(self.now_ns):
                if self.connected:
                    self.feed(data)

    def feed(self, data: bytes) -> None:
        for beam in self.driver.feed(data, self.now_ns):
            self.beams.append((self.now_ns, beam))

    def since(self, start_ns: int) -> list[tuple[int, Beam]]:
        """Return the beams that came after that time."""
        return [item for item in self.beams if item[0] > start_ns]
