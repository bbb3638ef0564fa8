# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""rclpy's message classes by name, filled fast and safely.

rclpy serialises a numpy scalar as 0.0 without a word, and takes a sequence element by element; so
numbers are converted to ``float`` and ``int``, and arrays handed over in one piece.
"""

import importlib
from array import array
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

__all__ = ["available", "make", "message_class"]

Converter = Callable[[Any], Any]

# The type codes by which rclpy stores sequences of numbers.
_CODES = {
    "float": "f",
    "double": "d",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
}


@cache
def message_class(type_name: str) -> Any:
    """Return the class of ``package/msg/Type`` or ``package/srv/Type``.

    Raises ImportError or AttributeError where it is not installed.
    """
    package, kind, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)


def available(type_name: str) -> bool:
    """Whether the message type is installed."""
    try:
        message_class(type_name)
    except (ImportError, AttributeError):
        return False
    return True


def make(type_name: str, **fields: Any) -> Any:
    """Make an rclpy message; numpy arrays may be given, other fields keep their defaults.

    Raises TypeError for a field that the type does not have.
    """
    kind, converters = _described(type_name)
    try:
        converted = {name: converters[name](value) for name, value in fields.items()}
    except KeyError as error:
        raise TypeError(f"{type_name} has no field {error}") from None
    return kind(**converted)


@cache
def _described(type_name: str) -> tuple[Any, dict[str, Converter]]:
    kind = message_class(type_name)
    described = kind.get_fields_and_field_types()
    return kind, {name: _converter(field) for name, field in described.items()}


def _converter(described: str) -> Converter:
    """Return what makes a value fit a field, described as in ``sequence<uint8>``."""
    if described.startswith("sequence<"):
        element = described[len("sequence<") : -1].partition(",")[0]
        return _sequence_of(_CODES[element]) if element in _CODES else list
    element, bracket, _ = described.partition("[")
    if bracket:
        return _fixed_array(_CODES[element]) if element in _CODES else list
    if element in ("float", "double"):
        return float
    if element == "boolean":
        return bool
    return int if element in _CODES else _unchanged


def _sequence_of(code: str) -> Converter:
    dtype = np.dtype(code)

    def convert(values: Any) -> "array[Any]":
        if isinstance(values, array) and values.typecode == code:
            return values
        if isinstance(values, bytes | bytearray) and code == "B":
            return array(code, bytes(values))
        return array(code, np.asarray(values, dtype=dtype).tobytes())

    return convert


def _fixed_array(code: str) -> Converter:
    def convert(values: Any) -> Any:
        return np.array(values, dtype=code, order="C").reshape(-1)

    return convert


def _unchanged(value: Any) -> Any:
    return value
