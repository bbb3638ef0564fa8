# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of Tritech's Seanet program: whole packets with the time of their receipt."""

from collections import Counter
from collections.abc import Iterator

from msss_graphslam.messages import Refusal
from msss_graphslam.messages.topics import SONAR_PING
from msss_graphslam.micron.frame import MessageType
from msss_graphslam.micron.packets import HeadData, PacketError
from msss_graphslam.micron.reception import Reception
from msss_graphslam.recordings.conversion.foreign import (
    BeamEncoder,
    ForeignFormat,
    ForeignMessage,
)
from msss_graphslam.recordings.conversion.seanet import count_refused, reason_of, reception
from msss_graphslam.recordings.conversion.source import ForeignSource
from msss_graphslam.recordings.conversion.steady_clock import SteadyClock
from msss_graphslam.recordings.conversion.v4log_file import LogRecord, is_v4log, read_v4log

__all__ = ["V4Log"]


class V4Log(ForeignFormat):
    """Only beams are taken, those of the head that comes first where there are several.

    The times are the computer's, of its own time zone, in steps of 16 ms and set while it
    records. So the beams get the times of their transmission by the head's own regularity.
    """

    name = "v4log"
    description = "Tritech Seanet .V4LOG"

    def recognises(self, source: ForeignSource) -> bool:
        """Whether the file begins as a V4LOG does."""
        return is_v4log(source.path)

    def messages(
        self, source: ForeignSource, refusals: Counter[str], inverted: bool
    ) -> Iterator[ForeignMessage]:
        """Yield the beams."""
        head, encoder, clock = reception(inverted), BeamEncoder(), SteadyClock(refusals)
        for record in _beams_of_one_head(read_v4log(source.path, refusals), refusals):
            try:
                received_ns = clock.time(record.recorded_ns)
                yield from _converted(record, received_ns, head, encoder)
            except PacketError as error:
                refusals[reason_of(error.reason)] += 1
            except Refusal as refusal:
                refusals[refusal.reason] += 1
        count_refused(head.refused, refusals)


def _beams_of_one_head(
    records: Iterator[LogRecord], refusals: Counter[str]
) -> Iterator[LogRecord]:
    node: int | None = None
    for record in records:
        if record.frame.type != MessageType.HEAD_DATA:
            continue
        node = record.frame.node if node is None else node
        if record.frame.node == node:
            yield record
        else:
            refusals["beam_of_another_head"] += 1


def _converted(
    record: LogRecord, received_ns: int, head: Reception, encoder: BeamEncoder
) -> Iterator[ForeignMessage]:
    for beam in head.beams([HeadData.decode(record.frame)], received_ns):
        message = encoder.message(beam.stamp_ns, beam.bearing, beam.ranges, beam.intensities)
        yield ForeignMessage(SONAR_PING, message, received_ns)
