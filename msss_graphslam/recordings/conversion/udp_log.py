# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A log of UDP datagrams (UdpHubLog): the bytes of a head's line, and an ROV's position.

A line is ``2017.11.02 08.58.46.723;10.3.0.40;4002;0F 11 ...``: local time, sender, its port, and
the datagram in hexadecimal.
"""

import re
from collections import Counter
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from msss_graphslam.messages import Refusal
from msss_graphslam.messages.topics import IMU, PRESSURE, SONAR_PING
from msss_graphslam.micron.reception import Reception
from msss_graphslam.recordings.conversion.foreign import (
    BeamEncoder,
    ForeignFormat,
    ForeignMessage,
)
from msss_graphslam.recordings.conversion.rov_sentence import RovState, is_sentence
from msss_graphslam.recordings.conversion.seanet import count_refused, reception
from msss_graphslam.recordings.conversion.source import ForeignSource
from msss_graphslam.recordings.conversion.steady_clock import SteadyClock

__all__ = ["UdpLog"]

_LINE = re.compile(
    rb"(\d{4}\.\d\d\.\d\d \d\d\.\d\d\.\d\d\.\d{3});([^;\s]+;\d{1,5});((?:[0-9A-Fa-f]{2} )*"
    rb"[0-9A-Fa-f]{2})\s*"
)
_TIME = "%Y.%m.%d %H.%M.%S.%f"
_LONGEST_LINE = 1 << 18  # a datagram has 64 KiB at most, three characters each
_LINES_TO_RECOGNISE = 3


class Datagram(NamedTuple):
    """What came from a port at a time [ns]; the clock is that of the place."""

    recorded_ns: int
    sender: bytes
    data: bytes


class UdpLog(ForeignFormat):
    """The head whose beam comes first is taken; ``$ROV`` gives attitude and depth."""

    name = "udp_log"
    description = "UDP log (UdpHubLog csv) with SeaNet packets and $ROV lines"

    def recognises(self, source: ForeignSource) -> bool:
        """Whether one of the first lines is a datagram."""
        if not source.path.is_file():
            return False
        with source.path.open("rb") as stream:
            lines = [stream.readline(_LONGEST_LINE) for _ in range(_LINES_TO_RECOGNISE)]
        return any(_LINE.fullmatch(line) for line in lines)

    def messages(
        self, source: ForeignSource, refusals: Counter[str], inverted: bool
    ) -> Iterator[ForeignMessage]:
        """Yield the beams, and the attitude and pressure of each ``$ROV`` line."""
        clock, heads = SteadyClock(refusals), _Heads(inverted, refusals)
        for datagram in _datagrams(source.path, refusals):
            try:
                received_ns = clock.time(datagram.recorded_ns)
                if is_sentence(datagram.data):
                    yield from _rov_messages(RovState.of(datagram.data), received_ns)
                else:
                    yield from heads.messages(datagram.sender, datagram.data, received_ns)
            except Refusal as refusal:
                refusals[refusal.reason] += 1
        heads.finish()


class _Heads:
    """The lines to heads, by sender; only one of them is used."""

    def __init__(self, inverted: bool, refusals: Counter[str]) -> None:
        self._inverted = inverted
        self._refusals = refusals
        self._lines: dict[bytes, Reception] = {}
        self._chosen: bytes | None = None
        self._encoder = BeamEncoder()

    def messages(self, sender: bytes, data: bytes, received_ns: int) -> Iterator[ForeignMessage]:
        if sender not in self._lines:
            self._lines[sender] = reception(self._inverted)
        line = self._lines[sender]
        for beam in line.beams(line.packets(data), received_ns):
            self._chosen = self._chosen or sender
            if sender != self._chosen:
                self._refusals["beam_of_another_head"] += 1
                continue
            try:
                message = self._encoder.message(
                    beam.stamp_ns, beam.bearing, beam.ranges, beam.intensities
                )
            except Refusal as refusal:
                self._refusals[refusal.reason] += 1
            else:
                yield ForeignMessage(SONAR_PING, message, received_ns)

    def finish(self) -> None:
        for line in self._lines.values():
            count_refused(line.refused, self._refusals)


def _rov_messages(state: RovState, received_ns: int) -> Iterator[ForeignMessage]:
    yield ForeignMessage(IMU, state.imu(received_ns), received_ns)
    yield ForeignMessage(PRESSURE, state.pressure(received_ns), received_ns)


def _datagrams(path: Path, refusals: Counter[str]) -> Iterator[Datagram]:
    with path.open("rb") as stream:
        while line := stream.readline(_LONGEST_LINE):
            datagram = _datagram(line)
            if datagram is not None:
                yield datagram
            elif line.strip():
                refusals["line_unreadable"] += 1


def _datagram(line: bytes) -> Datagram | None:
    found = _LINE.fullmatch(line)
    if found is None:
        return None
    time, sender, data = found.groups()
    try:
        moment = datetime.strptime(time.decode("ascii"), _TIME).replace(tzinfo=UTC)
    except ValueError:
        return None
    recorded_ns = round(moment.timestamp() * 1e3) * 1_000_000
    return Datagram(recorded_ns, sender, bytes.fromhex(data.decode("ascii")))
