# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""ROS 1 and rosbag2 bags, read with the message definitions that they carry."""

from abc import abstractmethod
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from rosbags.interfaces import Connection

from msss_graphslam.messages import Refusal
from msss_graphslam.messages.topics import SONAR_PING, Topic
from msss_graphslam.recordings.conversion.definitions import Undecodable, deserialiser
from msss_graphslam.recordings.conversion.foreign import (
    BeamEncoder,
    ForeignFormat,
    ForeignMessage,
)
from msss_graphslam.recordings.conversion.source import ForeignSource

__all__ = ["BeamBags", "Conversion", "convert_beams", "convert_messages", "has_type"]


class Conversion(NamedTuple):
    """What becomes of the messages of a topic: raises Refusal for one that is not used."""

    connection: Connection
    topic: Topic
    convert: Callable[[Any], Any]


class BeamBags(ForeignFormat):
    """Bags of a driver that publishes one beam a message, ``type_name`` being the end of its type.

    ``decoder`` returns what makes a beam of such a message, which may raise Refusal.
    """

    type_name: str

    @abstractmethod
    def decoder(self, source: ForeignSource, encoder: BeamEncoder) -> Callable[[Any], Any]:
        """Return what encodes the beam of a message of this bag."""

    def recognises(self, source: ForeignSource) -> bool:
        """Whether the bag holds such messages."""
        return has_type(source, self.type_name)

    def messages(
        self, source: ForeignSource, refusals: Counter[str], inverted: bool
    ) -> Iterator[ForeignMessage]:
        """Yield the beams."""
        decode = self.decoder(source, BeamEncoder(inverted))
        return convert_beams(source, self.type_name, decode, refusals)


def has_type(source: ForeignSource, type_name: str) -> bool:
    """Whether it is a bag with a topic of this type, by the end of its name."""
    return bool(_of_type(source, type_name))


def convert_beams(
    source: ForeignSource,
    type_name: str,
    beam: Callable[[Any], Any],
    refusals: Counter[str],
) -> Iterator[ForeignMessage]:
    """Yield the messages of a type, by the end of its name, converted into beams."""
    found = _of_type(source, type_name)
    chosen = [Conversion(connection, SONAR_PING, beam) for connection in found]
    return convert_messages(source, chosen, refusals)


def convert_messages(
    source: ForeignSource, conversions: Sequence[Conversion], refusals: Counter[str]
) -> Iterator[ForeignMessage]:
    """Yield the messages of these topics, converted, as received.

    What cannot be read or is refused is counted. Raises UserError where the bag is damaged, or
    no definition of a message is known.
    """
    chosen = {entry.connection.id: entry for entry in conversions}
    readers = {
        number: deserialiser(source.path, entry.connection, is_ros1=source.is_ros1)
        for number, entry in chosen.items()
    }
    recorded = [entry.connection for entry in conversions]
    for connection, log_ns, data in source.messages(recorded):
        entry = chosen[connection.id]
        try:
            message = entry.convert(readers[connection.id](data))
        except (Undecodable, AttributeError):  # or a field of another definition
            refusals[f"{entry.topic.label}_undecodable"] += 1
        except Refusal as refusal:
            refusals[refusal.reason] += 1
        else:
            yield ForeignMessage(entry.topic, message, log_ns)


def _of_type(source: ForeignSource, type_name: str) -> list[Connection]:
    return [entry for entry in source.connections if entry.msgtype.endswith(type_name)]
