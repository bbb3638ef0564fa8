# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""ROS 1 bags, read with the message definitions that they carry."""

import struct
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Reader, ReaderError
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore

from msss_graphslam.errors import UserError
from msss_graphslam.messages import Refusal
from msss_graphslam.messages.topics import Topic
from msss_graphslam.recordings.conversion.foreign import ForeignMessage

__all__ = ["convert_type", "has_type", "stamp_of"]

_MAGIC = b"#ROSBAG V2.0"
_DAMAGE = (ReaderError, OSError, ValueError, KeyError, IndexError, AssertionError, struct.error)
_BAD_DEFINITION = (TypesysError, ValueError, KeyError)


def has_type(path: Path, type_name: str) -> bool:
    """Whether the file is a ROS 1 bag with a topic of this type (``package/msg/Name``)."""
    with path.open("rb") as stream:
        if stream.read(len(_MAGIC)) != _MAGIC:
            return False
    with _opened(path) as bag:
        return any(connection.msgtype == type_name for connection in bag.connections)


def convert_type(
    path: Path,
    type_name: str,
    topic: Topic,
    conversion: Callable[[Any], Any],
    refusals: Counter[str],
) -> Iterator[ForeignMessage]:
    """Yield every message of the type, converted, under the topic and as received.

    What ``conversion`` refuses is counted. Raises UserError where the bag is damaged.
    """
    with _opened(path) as bag:
        chosen = [c for c in bag.connections if c.msgtype == type_name]
        read = _deserialiser(path, chosen)
        for _, log_ns, data in bag.messages(chosen):
            try:
                message = conversion(read(data))
            except SerdeError:
                refusals[f"{topic.label}_undecodable"] += 1
            except Refusal as refusal:
                refusals[refusal.reason] += 1
            else:
                yield ForeignMessage(topic, message, log_ns)


def stamp_of(message: Any) -> int:
    """Return the header's stamp [ns]."""
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


@contextmanager
def _opened(path: Path) -> Iterator[Reader]:
    try:
        with Reader(path) as bag:
            yield bag
    except _DAMAGE as error:
        raise UserError(
            f"{path}: the ROS 1 bag is damaged ({error}); repair it by `rosbag reindex` or"
            " `rosbag fix`"
        ) from error


def _deserialiser(path: Path, connections: list[Connection]) -> Callable[[bytes], Any]:
    first = connections[0]
    types = get_typestore(Stores.EMPTY)
    try:
        types.register(get_types_from_msg(first.msgdef.data, first.msgtype))
    except _BAD_DEFINITION as error:
        raise UserError(
            f"{path}: the definition of {first.msgtype} in the bag cannot be read ({error})"
        ) from error
    return lambda data: types.deserialize_ros1(data, first.msgtype)
