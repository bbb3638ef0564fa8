# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bytes of the sonar's port: they come back with their time, and what has none says so."""

from collections.abc import Callable
from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msss_graphslam.messages import Refusal, decoding, encoding
from msss_graphslam.recordings.typestore import TYPES, decode, make

TYPE = "std_msgs/msg/UInt8MultiArray"
LAST_NS = 2**31 * 10**9 - 1
SENT = encoding.raw_bytes(make, b"@0008", 1_750_000_000_123_456_789)


@given(st.binary(max_size=300), st.integers(0, LAST_NS))
def test_bytes_and_time_come_back(data: bytes, received_ns: int) -> None:
    sent = encoding.raw_bytes(make, data, received_ns)
    read = decode(bytes(TYPES.serialize_cdr(sent, TYPE)), TYPE)
    assert decoding.raw_bytes(read) == decoding.RawBytes(received_ns, data)


def test_the_label_is_the_documented_one() -> None:
    (dimension,) = SENT.layout.dim
    assert dimension.label == "received 1750000000.123456789"
    assert (dimension.size, dimension.stride) == (5, 5)
    early = encoding.raw_bytes(make, b"", 5)
    assert early.layout.dim[0].label == "received 0.000000005"


@pytest.mark.parametrize("label", ["", "bytes", "Received 1.000000000"])
def test_a_label_of_another_kind_says_nothing(label: str) -> None:
    message = deepcopy(SENT)
    message.layout.dim[0].label = label
    assert decoding.raw_bytes(message) == decoding.RawBytes(None, b"@0008")


def test_a_message_without_dimensions_has_no_time() -> None:
    bare = make(TYPE, data=np.arange(4, dtype=np.uint8))
    assert decoding.raw_bytes(bare) == decoding.RawBytes(None, bytes(range(4)))


def test_an_offset_is_honoured() -> None:
    message = deepcopy(SENT)
    message.layout.data_offset = 5
    assert decoding.raw_bytes(message).data == b""
    message.layout.data_offset = 2
    assert decoding.raw_bytes(message).data == b"008"


def label(text: str) -> Callable[[Any], None]:
    def change(message: Any) -> None:
        message.layout.dim[0].label = text

    return change


def offset(value: int) -> Callable[[Any], None]:
    def change(message: Any) -> None:
        message.layout.data_offset = value

    return change


@pytest.mark.parametrize(
    "text",
    [
        "received",
        "received 1",
        "received 1.5",
        "received -1.000000000",
        "received 1.0000000000",
        "received 2147483648.000000000",
        "received 1.00000000\N{ARABIC-INDIC DIGIT ONE}",
        "received 1.000000000 ",
        "received nan",
    ],
)
def test_a_label_that_cannot_be_read_is_refused(text: str) -> None:
    message = deepcopy(SENT)
    label(text)(message)
    with pytest.raises(Refusal, match="raw_label_invalid"):
        decoding.raw_bytes(message)


def test_an_offset_behind_the_end_is_refused() -> None:
    message = deepcopy(SENT)
    offset(6)(message)
    with pytest.raises(Refusal, match="raw_offset_outside"):
        decoding.raw_bytes(message)


def test_a_message_that_no_port_sends_is_refused() -> None:
    message = deepcopy(SENT)
    message.data = np.zeros(1 << 20, np.uint8)
    assert len(decoding.raw_bytes(message).data) == 1 << 20
    message.data = np.zeros((1 << 20) + 1, np.uint8)
    with pytest.raises(Refusal, match="raw_too_long"):
        decoding.raw_bytes(message)
