# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The time of receipt of raw bytes that were recorded without one. No ROS."""

from msss_graphslam.messages import Refusal, decoding, encoding, topics
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.typestore import TYPES, UndecodableError, decode, make

__all__ = ["receipt_ns", "with_receipt"]

_TYPE = topics.SONAR_RAW.type_name


def with_receipt(data: bytes, log_ns: int) -> bytes:
    """Return a serialised message of ``sonar/raw`` that says when its bytes came.

    One that does so already stays as it is, and so does one that cannot be read: its listener
    refuses and counts it. Otherwise it is the time of the log.
    """
    try:
        piece = decoding.raw_bytes(decode(data, _TYPE))
    except (UndecodableError, Refusal):
        return data
    if piece.received_ns is not None:
        return data
    return bytes(TYPES.serialize_cdr(encoding.raw_bytes(make, piece.data, log_ns), _TYPE))


def receipt_ns(raw: RawMessage) -> int:
    """Return when the bytes of a message of ``sonar/raw`` came, by its label or by the log."""
    try:
        received_ns = decoding.raw_bytes(decode(raw.data, _TYPE)).received_ns
    except (UndecodableError, Refusal):
        return raw.log_ns
    return raw.log_ns if received_ns is None else received_ns
