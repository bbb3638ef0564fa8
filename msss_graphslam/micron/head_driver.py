# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A live head: bytes in, beams and bytes out."""

from collections import Counter
from dataclasses import dataclass

from msss_graphslam.core.types import Beam
from msss_graphslam.micron.packets import VersionData
from msss_graphslam.micron.reception import Reception
from msss_graphslam.micron.session import Session
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.stages import HeadState

__all__ = ["DriverStatus", "HeadDriver"]


@dataclass(frozen=True, slots=True)
class DriverStatus:
    """How the head is, for the diagnostics.

    ``period`` [s] is observed, 0 before the first beam. ``version`` and ``full_duplex`` are None
    until the head has told them. ``counts`` are the session's events, ``refused`` what the head
    sent that made no beam, ``restarts`` of the stamps, each by reason.
    """

    state: HeadState
    period: float
    version: VersionData | None
    full_duplex: bool | None
    beams_a_request: int
    skipped_bytes: int
    counts: Counter[str]
    refused: Counter[str]
    restarts: Counter[str]


class HeadDriver:
    """Session and reception of one head; it knows neither port nor clock, and no other thread."""

    def __init__(self, settings: HeadSettings) -> None:
        parameters = settings.parameters
        self._session = Session(settings)
        self._reception = Reception(
            parameters.sound_speed, parameters.inverted, parameters.baudrate
        )

    @property
    def settings(self) -> HeadSettings:
        """What the head is told."""
        return self._session.settings

    @property
    def state(self) -> HeadState:
        """How far the conversation has come."""
        return self._session.state

    @property
    def next_ns(self) -> int | None:
        """When ``due`` wants to be called again; None while the line is closed."""
        return self._session.next_ns

    @property
    def missing(self) -> int:
        """Bytes that the packet that has begun lacks, 0 where none has."""
        return self._reception.missing

    @property
    def status(self) -> DriverStatus:
        """How the head is."""
        return DriverStatus(
            state=self._session.state,
            period=self._reception.period,
            version=self._session.version,
            full_duplex=self._session.full_duplex,
            beams_a_request=self._session.beams_a_request,
            skipped_bytes=self._reception.skipped_bytes,
            counts=Counter(self._session.counts),
            refused=self._reception.refused,
            restarts=Counter(self._reception.restarts),
        )

    def opened(self, now_ns: int) -> None:
        """Begin: the line is open."""
        self._session.opened(now_ns)

    def closed(self, now_ns: int) -> None:
        """End: the line is closed, by whomever; what came of a packet is given up."""
        self._session.closed(now_ns)
        self._reception.break_off()

    def configure(self, settings: HeadSettings) -> None:
        """Have the head scan by other settings from now on, on the same line."""
        self._session.configure(settings)
        self._reception.sound_speed = settings.parameters.sound_speed
        self._reception.inverted = settings.parameters.inverted

    def feed(self, data: bytes, now_ns: int) -> list[Beam]:
        """Return the beams that these bytes, read at ``now_ns``, complete."""
        packets = self._reception.packets(data)
        for packet in packets:
            self._session.receive(packet, now_ns)
        return self._reception.beams(packets, now_ns)

    def due(self, now_ns: int) -> list[bytes]:
        """Return the packets to be written now."""
        return self._session.due(now_ns)
