# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How line and head are, in rows and in words that say what to do."""

from collections import Counter
from collections.abc import Callable
from time import monotonic

from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.stages import HeadState
from msss_graphslam.micron.transports.link import Link
from msss_graphslam.nodes.driving.line import FileDriver, advice_for
from msss_graphslam.nodes.driving.pings import Pings
from msss_graphslam.ros.diagnostics import Finding, Level

__all__ = ["LineHealth"]

_SILENT = 5.0  # s; a head that is there says so every second, but for a reboot of 2.5 s
_LONGEST_START = 45.0  # s; reboot, search for the centre, questions
_NO_BEAM = 2.0  # s, and
_PERIODS = 5.0
_ENOUGH = 200  # bytes, to tell a wrong speed from a disturbance
_FOREIGN = 0.9
_RECENT = 10.0  # s

_EVENTS = {
    "resets": "the head was reset: is its supply steady?",
    "motor_errors": "the head lost its bearing, it gets its parameters anew",
    "timeouts": "the head has left requests without an answer",
    "parameters_not_taken": "the head does not do what it is told: is head_type right?",
}
_WIRES = "check its supply, the wires (receive and transmit, A and B) and baudrate"


class LineHealth:
    """Watches one line; the caller sees to it that it is used by one thread at a time."""

    def __init__(self, link: Link, pings: Pings, clock: Callable[[], float] = monotonic) -> None:
        self._link = link
        self._pings = pings
        self._clock = clock
        self._bytes = self._bytes_before = self._skipped_before = 0
        self._opened = self._last_bytes = self._scanning = clock()
        self._counts: Counter[str] = Counter()
        self._event = ("", 0.0)

    def opened(self, speaker: HeadDriver | FileDriver) -> None:
        """Note that the line is open, again or for the first time."""
        self._opened = self._last_bytes = self._scanning = self._clock()
        self._bytes_before = self._bytes
        self._skipped_before = _skipped(speaker)

    def received(self, size: int) -> None:
        """Note bytes."""
        if size:
            self._bytes += size
            self._last_bytes = self._clock()

    def rows(self, speaker: HeadDriver | FileDriver) -> dict[str, str | int | float]:
        """Return the rows for the diagnostics."""
        rows: dict[str, str | int | float] = {
            "port": "open" if self._link.is_open else self._link.error,
            "port/openings": self._link.openings,
            "port/failures": self._link.failures,
            "bytes": self._bytes,
            "head": str(speaker.state),
        }
        if isinstance(speaker, FileDriver):
            return rows | {"skipped_bytes": speaker.skipped_bytes}
        status = speaker.status
        rows |= {"skipped_bytes": status.skipped_bytes, "beam_period_s": status.period}
        rows |= {"beams_a_request": status.beams_a_request}
        rows |= {f"head/{name}": 0 for name in _EVENTS} | {"head/partial_turns": 0}
        rows |= {f"head/{name}": count for name, count in status.counts.items()}
        rows |= {f"stamps/{name}": count for name, count in status.restarts.items()}
        if status.version is not None:
            rows |= {
                "head/serial": status.version.serial,
                "head/software": status.version.software,
            }
        return rows

    def finding(self, speaker: HeadDriver | FileDriver) -> Finding | None:
        """Return what is wrong now, the worst of it."""
        if self._link.ended:
            return Finding(Level.WARN, self._link.error)
        if not self._link.is_open:
            advice = advice_for(self._link.error)
            text = "; ".join(filter(None, [self._link.error, advice, "it is tried again"]))
            return Finding(Level.ERROR, text)
        if isinstance(speaker, FileDriver):
            return None
        return self._silence(speaker) or self._start(speaker) or self._events(speaker)

    def _silence(self, speaker: HeadDriver) -> Finding | None:
        now = self._clock()
        if now - self._last_bytes > _SILENT:
            silence = f"nothing comes from the head for {now - self._last_bytes:.0f} s"
            return Finding(Level.ERROR, f"{silence}: {_WIRES}")
        since_open = self._bytes - self._bytes_before
        skipped = _skipped(speaker) - self._skipped_before
        if since_open > _ENOUGH and skipped > _FOREIGN * since_open:
            text = "bytes come, but no packets of a head: is baudrate right, and this its port?"
            return Finding(Level.ERROR, text)
        return None

    def _start(self, speaker: HeadDriver) -> Finding | None:
        """Tell of a head that does not scan, or says so and sends nothing."""
        now = self._clock()
        if speaker.state is HeadState.SCANNING:
            self._scanning = now
            silence = min(self._pings.silence, now - self._opened)
            if silence > max(_NO_BEAM, _PERIODS * speaker.status.period):
                return Finding(Level.ERROR, f"no beam for {silence:.0f} s")
            return None
        waited = now - self._scanning
        level = Level.WARN if waited < _LONGEST_START else Level.ERROR
        return Finding(level, f"head: {speaker.state}, not scanning for {waited:.0f} s")

    def _events(self, speaker: HeadDriver) -> Finding | None:
        """Tell of what has happened lately."""
        counts = speaker.status.counts
        for name, text in _EVENTS.items():
            if counts[name] > self._counts[name]:
                self._event = text, self._clock()
        self._counts = counts
        text, at = self._event
        return Finding(Level.WARN, text) if text and self._clock() - at < _RECENT else None


def _skipped(speaker: HeadDriver | FileDriver) -> int:
    if isinstance(speaker, FileDriver):
        return speaker.skipped_bytes
    return speaker.status.skipped_bytes
