# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Definitions of foreign messages: from the bag, else from the documentation of their package."""

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection, MessageDefinitionFormat
from rosbags.serde import SerdeError
from rosbags.typesys import (
    Stores,
    TypesysError,
    get_types_from_idl,
    get_types_from_msg,
    get_typestore,
)
from rosbags.typesys.store import Typestore

from msss_graphslam.errors import UserError

__all__ = ["DOCUMENTED", "Undecodable", "deserialiser"]

DOCUMENTED = {
    "SonarEcho": """
std_msgs/Header header
float32 angle
uint8 gain
uint16 number_of_samples
uint16 transmit_frequency
uint16 speed_of_sound
uint8 range
uint8[] intensities
"""
}
"""By the last part of the name; rosbag2 wrote no definitions into sqlite3 before ROS 2 Iron."""

_UNDECODABLE = (SerdeError, ValueError, LookupError, ArithmeticError, MemoryError, struct.error)
_IDL_SEPARATOR = "=" * 80 + "\n"


class Undecodable(Exception):  # noqa: N818 - not an error of the program
    """The bytes are no message of the type."""


def deserialiser(path: Path, connection: Connection, *, is_ros1: bool) -> Callable[[bytes], Any]:
    """Return what turns the bytes of a topic's messages into messages, or raises Undecodable.

    Raises UserError where no definition is known.
    """
    try:
        types = _types(connection)
    except (TypesysError, ValueError, KeyError, AssertionError) as error:
        what = " ".join(str(error).split())
        raise UserError(
            f"{path}: the definition of {connection.msgtype} cannot be read ({what})"
        ) from error
    read = types.deserialize_ros1 if is_ros1 else types.deserialize_cdr

    def message(data: bytes) -> Any:
        try:
            return read(data, connection.msgtype)
        except _UNDECODABLE as error:
            raise Undecodable(str(error)) from error

    return message


def _types(connection: Connection) -> Typestore:
    name, definition = connection.msgtype, connection.msgdef
    types = get_typestore(Stores.EMPTY)
    if definition.format == MessageDefinitionFormat.MSG:
        types.register(get_types_from_msg(definition.data, name))
    elif definition.format == MessageDefinitionFormat.IDL:
        for part in definition.data.split(_IDL_SEPARATOR):
            text = part.split("\n", 1)[1] if part.startswith("IDL: ") else part
            types.register(get_types_from_idl(text) if text.strip() else {})
    else:
        types = get_typestore(Stores.ROS2_JAZZY)
        if name not in types.fielddefs:
            documented = DOCUMENTED[name.rsplit("/", 1)[-1]]
            types.register(get_types_from_msg(documented, name))
    return types
