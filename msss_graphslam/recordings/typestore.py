# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The message types of ROS 2 Jazzy, for bags that are read and written without ROS."""

import struct
from functools import cache
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore

__all__ = ["TYPES", "UndecodableError", "decode", "make"]

TYPES = get_typestore(Stores.ROS2_JAZZY)

_DECODING_ERRORS = (
    SerdeError,
    ValueError,
    LookupError,
    ArithmeticError,
    MemoryError,
    struct.error,
)


class UndecodableError(Exception):
    """The bytes are no message of the type."""


def make(type_name: str, **fields: Any) -> Any:
    """Make a message, for instance of ``sensor_msgs/msg/LaserScan``; other fields are zero."""
    kind, defaults = _constructor(type_name)
    if len(fields) == len(defaults):
        return kind(**fields)
    missing = {name: _zero(node) for name, node in defaults.items() if name not in fields}
    return kind(**missing, **fields)


def decode(data: bytes, type_name: str) -> Any:
    """Return the message that the bytes (CDR) are; raises UndecodableError where they are none."""
    try:
        return TYPES.deserialize_cdr(data, type_name)
    except _DECODING_ERRORS as error:
        raise UndecodableError(str(error)) from error


@cache
def _constructor(type_name: str) -> tuple[Any, dict[str, Any]]:
    _, described = TYPES.fielddefs[type_name]
    return TYPES.types[type_name], dict(described)


def _zero(described: Any) -> Any:
    node, detail = described
    if node is Nodetype.NAME:
        return make(detail)
    if node is Nodetype.BASE:
        return _ZEROS.get(detail[0], 0)
    element, size = detail
    count = size if node is Nodetype.ARRAY else 0
    if element[0] is Nodetype.BASE and element[1][0] != "string":
        return np.zeros(count, dtype=element[1][0])
    return [_zero(element) for _ in range(count)]


_ZEROS: dict[str, Any] = {"string": "", "bool": False, "float32": 0.0, "float64": 0.0}
