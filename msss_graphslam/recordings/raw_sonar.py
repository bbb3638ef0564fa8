# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Beams of a recording that has only the bytes of the head's port."""

from collections import Counter
from dataclasses import replace

import numpy as np

from msss_graphslam.config.groups import Micron
from msss_graphslam.core.types import Beam
from msss_graphslam.messages import Refusal, decoding, encoding, topics
from msss_graphslam.messages.order import StampOrder
from msss_graphslam.messages.refusal import in_one_word
from msss_graphslam.micron.raw_log import RawBeams
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.source import message_of
from msss_graphslam.recordings.typestore import make

__all__ = ["RawSonar"]


class RawSonar:
    """Turns the messages of ``sonar/raw`` into beams, as the driver does in a replay.

    A message without a time of receipt has that of the log.
    """

    topic = topics.SONAR_RAW

    def __init__(self, micron: Micron) -> None:
        self._beams = RawBeams(micron.sound_speed, micron.inverted, micron.baudrate)
        self._order = StampOrder()
        self._counted: Counter[str] = Counter()

    def records_of(self, raw: RawMessage, refusals: Counter[str]) -> list[Beam]:
        """Return the beams that are complete with this message; count what is refused."""
        try:
            piece = decoding.raw_bytes(message_of(raw, self.topic))
        except Refusal as refusal:
            refusals[refusal.reason] += 1
            return []
        received_ns = raw.log_ns if piece.received_ns is None else piece.received_ns
        found = self._beams.feed(piece.data, received_ns)
        self._count(refusals)
        return [beam for beam in map(_as_published, found) if self._admitted(beam, refusals)]

    def _count(self, refusals: Counter[str]) -> None:
        refused = self._beams.refused
        for reason, count in (refused - self._counted).items():
            refusals[in_one_word(reason)] += count
        self._counted = refused

    def _admitted(self, beam: Beam, refusals: Counter[str]) -> bool:
        try:
            self._order.check(beam.stamp_ns)
        except Refusal as refusal:
            refusals[refusal.reason] += 1
            return False
        return True


def _as_published(beam: Beam) -> Beam:
    """Return the beam as it arrives over the topic, where ranges and bearing have 32 bits."""
    bearing = float(np.float32(beam.bearing))
    return decoding.beam(encoding.laser_scan(make, replace(beam, bearing=bearing), "", 0.0))
