# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The head: takes the driver's bytes, and says which bytes go back, and when."""

from collections import Counter
from typing import Protocol

from msss_graphslam.micron.frame import Frame
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import (
    Alive,
    GainsCommand,
    HeadCommand,
    HeadInformation,
    Packet,
    PacketError,
    Reboot,
    ReverseScan,
    SendData,
    SendUserData,
    SendVersion,
    StopAlives,
    UserData,
    VersionData,
    decode_packet,
)
from msss_graphslam.simulation.emulator.scanner import Nature, Scanner
from msss_graphslam.simulation.emulator.sending import Sender, Transmission, nanoseconds
from msss_graphslam.simulation.emulator.view import Look
from msss_graphslam.simulation.emulator.waking import (
    ALIVE_PERIOD,
    BOOTING,
    CENTRING,
    CONFIGURED,
    READY,
    waking,
)

__all__ = ["Head"]

_VERSION = VersionData(
    software=0x31, information=0x11, serial=0, program_length=0xB012, checksum=0x2AEB
)
_ANSWERING_NS = 5_000_000
_SETTING_UP_NS = 100_000_000
_ALIVE_NS = nanoseconds(ALIVE_PERIOD)
_NEVER_NS = 2**62


class _HasFrame(Protocol):
    def frame(self) -> Frame: ...


class Head:
    """A Micron's head without input and output.

    It looks at ``look``; all times are nanoseconds of the caller's clock, that of the power-up
    ``started_ns`` also that of the vehicle's launch. ``powered_up_ns`` is when it last got its
    power; ``ignored`` counts the packets that it does not obey, by reason.
    """

    def __init__(self, look: Look, nature: Nature, started_ns: int) -> None:
        self.baudrate = nature.baudrate
        self.ignored: Counter[str] = Counter()
        self._nature = nature
        self._scanner = Scanner(look, nature, started_ns)
        self._sender = Sender(nature.baudrate)
        self.restart(started_ns)

    def restart(self, now_ns: int) -> None:
        """Lose the power for a moment: everything begins anew."""
        self.powered_up_ns = now_ns
        self._framer = Framer()
        self._scanner.restart()
        self._sender.stop()
        self._alive_ns = now_ns + nanoseconds(BOOTING)
        self._alives_stopped = False
        self._new_parameters = False

    def lose_sync(self) -> None:
        """Lose the motor's position; see Scanner."""
        self._scanner.lose_sync()

    @property
    def next_ns(self) -> int:
        """When ``due`` will have something new, if nothing is received before."""
        ping_ns = self._scanner.next_ns
        return self._alive_ns if ping_ns is None else min(self._alive_ns, ping_ns)

    def receive(self, data: bytes, now_ns: int) -> None:
        """Take what arrives from the driver; a head that boots is deaf."""
        if now_ns < self.powered_up_ns + nanoseconds(BOOTING):
            return
        for frame in self._framer.feed(data):
            try:
                self._obey(decode_packet(frame), now_ns)
            except PacketError as error:
                self.ignored[error.reason] += 1

    def due(self, now_ns: int) -> list[Transmission]:
        """Return what was begun to be sent up to now; its last byte may come later."""
        while self.next_ns <= now_ns:
            ping_ns = self._scanner.next_ns
            if ping_ns is not None and ping_ns <= self._alive_ns:
                reply, ready_ns = self._scanner.ping()
                self._rest_until(self._send(reply, ready_ns))
            else:
                self._say_alive(self._alive_ns)
        return self._sender.take()

    def _obey(self, packet: Packet, now_ns: int) -> None:
        match packet:
            case Reboot():
                self.restart(now_ns)
            case SendVersion():
                self._send(_VERSION, now_ns + _ANSWERING_NS)
            case SendUserData():
                self._send(UserData.of(self._nature.full_duplex), now_ns + _ANSWERING_NS)
            case StopAlives():
                self._alives_stopped = True
                self._alive_ns = _NEVER_NS
            case SendData() | HeadCommand() | GainsCommand() | ReverseScan():
                self._scan(packet, now_ns)
            case _:
                self.ignored["no command"] += 1

    def _scan(
        self, packet: SendData | HeadCommand | GainsCommand | ReverseScan, now_ns: int
    ) -> None:
        if now_ns < self.powered_up_ns + nanoseconds(CENTRING):
            self.ignored["not centred"] += 1
        elif isinstance(packet, SendData):
            if self._scanner.request(now_ns):
                self._rest_until(now_ns)
            else:
                self.ignored["no parameters"] += 1
        elif not self._scanner.take(packet, now_ns):
            self.ignored["parameters without sense"] += 1
        elif isinstance(packet, HeadCommand):
            self._new_parameters = True
            if not self._alives_stopped:
                self._alive_ns = now_ns + _SETTING_UP_NS

    def _rest_until(self, now_ns: int) -> None:
        """Put off the next alive: a head that scans sends none."""
        if not self._alives_stopped:
            self._alive_ns = now_ns + _ALIVE_NS

    def _say_alive(self, now_ns: int) -> None:
        since_ns = now_ns - self.powered_up_ns
        information = self._information(since_ns * 1e-9)
        unset = HeadInformation.NO_PARAMETERS in information
        alive = Alive(
            information,
            time_ms=since_ns // 1_000_000,
            bearing=self._scanner.turning.bearing,
            notice=0x80 if unset else 0,
        )
        self._send(alive, now_ns)
        self._alive_ns = now_ns + _ALIVE_NS

    def _information(self, since_power_up: float) -> HeadInformation:
        if self._scanner.programme is None:
            return waking(since_power_up)
        if self._new_parameters:
            self._new_parameters = False
            return CONFIGURED
        return READY

    def _send(self, packet: _HasFrame, from_ns: int) -> int:
        return self._sender.send(packet.frame().encode(), from_ns)
