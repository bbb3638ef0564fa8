# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The conversation with a head: from an open line to beam after beam, and back after a fault.

It knows neither port nor clock: packets and times go in, bytes to be written come out.
"""

from collections import Counter, deque

from msss_graphslam.micron.packets import (
    Alive,
    HeadData,
    HeadStatus,
    Packet,
    SendData,
    UserData,
    VersionData,
)
from msss_graphslam.micron.requests import Requests
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.stages import HeadState, stage_of

__all__ = ["Session"]

_REBOOT_TAKES_NS = 500_000_000  # what the head says sooner it has said before it rebooted
_MOST_ATTEMPTS = 3  # to configure the head, without a beam as asked for
_MOST_DIFFERING = 10  # beams in a row of other settings than asked for
_DAY_MS = 86_400_000
_MOST_WAITING = 16  # packets to be written


class Session:
    """One head's state, with the times of all calls on one clock [ns].

    Whatever the head sends and however late, the session goes on: each state has a limit of time
    and a state that follows. ``counts`` says what went wrong. The head is rebooted when the line
    is opened for the first time; later it is asked first whether it still scans. It is not
    rebooted at the end: a head transmits only when asked.
    """

    def __init__(self, settings: HeadSettings) -> None:
        self.settings = settings
        self.state = HeadState.CLOSED
        self.counts: Counter[str] = Counter()
        self.version: VersionData | None = None
        self.full_duplex: bool | None = None
        self._requests = Requests()
        self._waiting: deque[bytes] = deque(maxlen=_MOST_WAITING)
        self._now_ns = self._entered_ns = self._deadline_ns = 0
        self._tries = self._attempts = self._differing = 0
        self._has_scanned = self._in_turn = False

    @property
    def beams_a_request(self) -> int:
        """How many beams the head sends for each request."""
        return self._requests.a_request_brings

    @property
    def next_ns(self) -> int | None:
        """When ``due`` wants to be called again; None while the line is closed."""
        if self.state is HeadState.CLOSED:
            return None
        return self._now_ns if self._waiting else self._deadline_ns

    def opened(self, now_ns: int) -> None:
        """Begin the conversation: the line is open."""
        self._see(now_ns)
        self._attempts = 0
        self._enter(HeadState.RESUMING if self._has_scanned else HeadState.REBOOTING)

    def closed(self, now_ns: int) -> None:
        """End the conversation: the line is closed, by whomever."""
        self._see(now_ns)
        self._break_turn()
        self._waiting.clear()
        self.state = HeadState.CLOSED

    def configure(self, settings: HeadSettings) -> None:
        """Have the head scan by other settings from now on."""
        same = settings.command == self.settings.command
        self.settings = settings
        if not same and self.state in (
            HeadState.RESUMING,
            HeadState.CONFIGURING,
            HeadState.SCANNING,
        ):
            self._attempts = 0
            self._configure()

    def due(self, now_ns: int) -> list[bytes]:
        """Return the packets to be written now."""
        self._see(now_ns)
        if self.state is not HeadState.CLOSED and now_ns >= self._deadline_ns:
            self._run_out()
        packets = list(self._waiting)
        self._waiting.clear()
        return packets

    def receive(self, packet: Packet, now_ns: int) -> None:
        """Take in what the head has sent."""
        self._see(now_ns)
        match packet:
            case _ if self.state is HeadState.CLOSED:
                self.counts["unexpected_packets"] += 1
            case HeadData():
                self._take_beam(packet)
            case Alive():
                self._take_alive(packet)
            case VersionData():
                self._take_version(packet)
            case UserData():
                self._take_user_data(packet)
            case _:
                self.counts["unexpected_packets"] += 1

    def _take_beam(self, beam: HeadData) -> None:
        if self.state not in (HeadState.SCANNING, HeadState.RESUMING):
            self.counts["unexpected_beams"] += 1
        elif HeadStatus.MOTOR_ERROR in beam.status:
            self.counts["motor_errors"] += 1
            self._configure()
        elif HeadStatus.POWER_LOSS in beam.status:
            self.counts["resets"] += 1
            self._configure()
        elif self.state is HeadState.RESUMING:
            self._enter(HeadState.SCANNING)
            self._in_turn = True
        else:
            self._go_on(beam)

    def _go_on(self, beam: HeadData) -> None:
        """Ask for the next beam."""
        self._has_scanned = self._in_turn = True
        self._tries = stage_of(self.state, self.settings).tries
        if self._requests.answered():
            self._send()
        elif self._requests.listening:
            self._wait(self.settings.listening_pause)
        if self.settings.matches(beam):
            self._attempts = self._differing = 0
            return
        self._differing += 1
        if self._differing == _MOST_DIFFERING and self._attempts < _MOST_ATTEMPTS:
            self.counts["parameters_not_taken"] += 1
            self._configure()

    def _take_alive(self, alive: Alive) -> None:
        lost = alive.no_parameters and not alive.sent_configuration
        match self.state:
            case HeadState.REBOOTING if self._now_ns - self._entered_ns >= _REBOOT_TAKES_NS:
                self._centre(alive)
            case HeadState.CENTRING:
                self._centre(alive)
            case HeadState.CONFIGURING if not (alive.no_parameters or alive.recentring):
                self._enter(HeadState.SCANNING)
            case HeadState.RESUMING | HeadState.SCANNING if lost or alive.recentring:
                self._take_reset(alive)
            case HeadState.IDENTIFYING | HeadState.ASKING_DUPLEX | HeadState.CONFIGURING:
                if alive.recentring:
                    self._take_reset(alive)

    def _take_reset(self, alive: Alive) -> None:
        self.counts["resets"] += 1
        self._break_turn()
        self._centre(alive)

    def _centre(self, alive: Alive) -> None:
        """Wait until the motor has found its zero, then go on."""
        if alive.centred and not alive.recentring:
            self._enter(HeadState.IDENTIFYING)
        elif self.state is not HeadState.CENTRING:
            self._enter(HeadState.CENTRING)

    def _take_version(self, version: VersionData) -> None:
        self.version = version
        if self.state is HeadState.IDENTIFYING:
            self._enter(HeadState.ASKING_DUPLEX)

    def _take_user_data(self, user_data: UserData) -> None:
        self.full_duplex = user_data.full_duplex
        if self.state is HeadState.ASKING_DUPLEX:
            self._configure()

    def _configure(self) -> None:
        """Send the parameters; a head that has not followed them three times is rebooted."""
        self._break_turn()
        self._attempts += 1
        if self._attempts <= _MOST_ATTEMPTS:
            self._enter(HeadState.CONFIGURING)
            return
        self._attempts = 0
        self._enter(HeadState.REBOOTING)

    def _run_out(self) -> None:
        """Try again, or go on to what follows when the head does not answer."""
        if self.state is HeadState.SCANNING:
            if self._requests.heard_out():
                self._send()
                return
            self.counts["timeouts"] += 1
            self._requests.go_on()
        self._tries -= 1
        if self._tries > 0:
            self._send()
            return
        otherwise = stage_of(self.state, self.settings).otherwise
        if otherwise is HeadState.CONFIGURING:
            self._configure()
        else:
            self._enter(otherwise)

    def _enter(self, state: HeadState) -> None:
        if state is HeadState.SCANNING and self.state is HeadState.CONFIGURING:
            self._requests.find_out()
        self.state = state
        self._differing = 0
        self._tries = stage_of(state, self.settings).tries
        self._entered_ns = self._now_ns
        if state in (HeadState.REBOOTING, HeadState.CONFIGURING):
            self.counts[f"{state}"] += 1
        self._send()

    def _send(self) -> None:
        """Have the state's packet written, and wait for an answer."""
        stage = stage_of(self.state, self.settings)
        self._wait(stage.patience)
        match stage.request:
            case None:
                return
            case SendData():
                self._requests.asked()
                request = SendData(self._now_ns // 1_000_000 % _DAY_MS)
            case request:
                pass
        self._waiting.append(request.frame().encode())

    def _wait(self, seconds: float) -> None:
        self._deadline_ns = self._now_ns + round(seconds * 1e9)

    def _break_turn(self) -> None:
        if self._in_turn:
            self.counts["partial_turns"] += 1
        self._in_turn = False

    def _see(self, now_ns: int) -> None:
        """Follow the clock; where it was set back, what was waited for has not moved away."""
        back = self._now_ns - now_ns
        if back > 0:
            self._deadline_ns -= back
            self._entered_ns -= back
        self._now_ns = now_ns
