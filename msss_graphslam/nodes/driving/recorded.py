# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The bytes of a head as ``sonar/raw`` brings them: a replay."""

from collections import Counter
from collections.abc import Mapping

from msss_graphslam.config.groups import Micron
from msss_graphslam.messages import decoding, encoding, topics
from msss_graphslam.messages.decoding import RawBytes
from msss_graphslam.micron.raw_log import RawBeams
from msss_graphslam.nodes.arrived import take_arrived
from msss_graphslam.nodes.driving.pings import Pings
from msss_graphslam.nodes.quiet import Quiet
from msss_graphslam.ros.diagnostics import Finding
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode

__all__ = ["RecordedHead"]

# A replay is told so often how far its bytes are taken [ns of their receipt].
_PROGRESS_NS = 50_000_000
_LONG_AGO = -(2**62)


class RecordedHead:
    """Subscribes to ``sonar/raw`` and publishes the beams in it, and how far it has come."""

    def __init__(self, node: SlamNode, pings: Pings, micron: Micron) -> None:
        self._node = node
        self._pings = pings
        self._micron = micron
        self._past: Counter[str] = Counter()
        self._past_skipped = 0
        self._quiet = Quiet()
        self._beams = self._anew()
        self._taken = node.offer(topics.RAW_TAKEN)
        self._told_ns = _LONG_AGO
        self._input = node.listen(
            topics.SONAR_RAW, decoding.raw_bytes, self._take, single=True, required=True
        )

    @property
    def refused(self) -> Counter[str]:
        """What could not be used so far, by reason."""
        return self._past + self._beams.refused

    @property
    def rows(self) -> Mapping[str, str | int | float]:
        """Further rows for the diagnostics."""
        return {"skipped_bytes": self._past_skipped + self._beams.skipped_bytes}

    def finding(self) -> Finding | None:
        """Return what is wrong now; silence is told by the input itself."""
        return None

    def configure(self, micron: Micron) -> None:
        """Decode with other parameters from the next beam on."""
        before, self._micron = self._micron, micron
        if _decoding(before) != _decoding(micron):
            self.reset()

    def reset(self) -> None:
        """Start anew: the next bytes may be of another time."""
        self._past = self.refused
        self._past_skipped += self._beams.skipped_bytes
        self._beams = self._anew()
        self._told_ns = _LONG_AGO

    def unfinished(self) -> str:
        """Return what is still to be worked off before a save; empty if nothing is."""
        take_arrived([self._input])
        return "" if self._quiet.is_reached() else "input still comes in"

    def close(self) -> None:
        """End; nothing is published afterwards."""
        self._node.ignore(self._input)
        self._taken.close()

    def _anew(self) -> RawBeams:
        return RawBeams(*_decoding(self._micron))

    def _take(self, piece: RawBytes) -> None:
        received_ns = piece.received_ns
        if received_ns is None:
            received_ns = self._node.get_clock().now().nanoseconds
        for beam in self._beams.feed(piece.data, received_ns):
            self._pings.publish(beam, self._beams.period)
        if abs(received_ns - self._told_ns) >= _PROGRESS_NS:
            self._told_ns = received_ns
            self._taken.publish(encoding.moment(make, received_ns))
        self._quiet.note()


def _decoding(micron: Micron) -> tuple[float, bool, int]:
    """Return the parameters by which bytes become beams."""
    return micron.sound_speed, micron.inverted, micron.baudrate
