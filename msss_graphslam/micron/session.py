# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The conversation with a head: from an open line to beam after beam, and back after a fault.

It knows neither port nor clock: packets and times go in, bytes to be written come out.
"""

from collections import Counter

from msss_graphslam.micron.exchange import Exchange
from msss_graphslam.micron.packets import (
    Alive,
    HeadData,
    HeadStatus,
    Packet,
    UserData,
    VersionData,
)
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.stages import HeadState, Stage, stage_of

__all__ = ["Session"]

_REBOOT_TAKES_NS = 500_000_000  # what the head says sooner it has said before it rebooted
_MOST_ATTEMPTS = 3  # to configure the head, without a beam as asked for
_MOST_DIFFERING = 10  # beams in a row of other settings than asked for


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
        self._exchange = Exchange()
        self._attempts = self._differing = 0
        self._has_scanned = self._in_turn = False

    @property
    def beams_a_request(self) -> int:
        """How many beams the head sends for each request."""
        return self._exchange.requests.a_request_brings

    @property
    def next_ns(self) -> int | None:
        """When ``due`` wants to be called again; None while the line is closed."""
        return None if self.state is HeadState.CLOSED else self._exchange.next_ns

    def opened(self, now_ns: int) -> None:
        """Begin the conversation: the line is open."""
        self._exchange.see(now_ns)
        self._attempts = 0
        self._enter(HeadState.RESUMING if self._has_scanned else HeadState.REBOOTING)

    def closed(self, now_ns: int) -> None:
        """End the conversation: the line is closed, by whomever."""
        self._exchange.see(now_ns)
        self._break_turn()
        self._exchange.take()
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
        self._exchange.see(now_ns)
        if self.state is not HeadState.CLOSED and self._exchange.is_overdue:
            self._run_out()
        return self._exchange.take()

    def receive(self, packet: Packet, now_ns: int) -> None:
        """Take in what the head has sent."""
        self._exchange.see(now_ns)
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
        self._exchange.renew(self._stage)
        if self._exchange.requests.answered():
            self._exchange.send(self._stage)
        elif self._exchange.requests.listening:
            self._exchange.wait(self.settings.listening_pause)
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
            case HeadState.REBOOTING if self._exchange.age_ns >= _REBOOT_TAKES_NS:
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
            if self._exchange.requests.heard_out():
                self._exchange.send(self._stage)
                return
            self.counts["timeouts"] += 1
            self._exchange.requests.go_on()
        if self._exchange.repeat(self._stage):
            return
        if self._stage.otherwise is HeadState.CONFIGURING:
            self._configure()
        else:
            self._enter(self._stage.otherwise)

    def _enter(self, state: HeadState) -> None:
        if state is HeadState.SCANNING and self.state is HeadState.CONFIGURING:
            self._exchange.requests.find_out()
        self.state = state
        self._differing = 0
        if state in (HeadState.REBOOTING, HeadState.CONFIGURING):
            self.counts[f"{state}"] += 1
        self._exchange.begin(self._stage)

    @property
    def _stage(self) -> Stage:
        return stage_of(self.state, self.settings)

    def _break_turn(self) -> None:
        if self._in_turn:
            self.counts["partial_turns"] += 1
        self._in_turn = False
