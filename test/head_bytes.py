# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a Micron's port brings: packets of a head that turns steadily, with their receipts."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.micron_stream import head_data
from msss_graphslam.messages import encoding
from msss_graphslam.micron.packets import TURN, HeadData
from msss_graphslam.micron.timing import reply_delay
from msss_graphslam.recordings.typestore import make

__all__ = ["PERIOD_NS", "START_NS", "packet", "packets", "raw_messages"]

START_NS = 1_700_000_000_000_000_000
PERIOD_NS = 42_660_000
STEP = 32
BAUDRATE = 115200


def packet(index: int, bins: int = 40) -> HeadData:
    """Return the index-th beam of a head that turns by 1.8 degrees to starboard."""
    codes = np.random.default_rng(index).integers(0, 256, bins).astype(np.uint8)
    beam = head_data(codes.tobytes(), (TURN // 2 + index * STEP) % TURN)
    return replace(beam, range_scale=100, ad_interval=521, step=STEP)


def packets(count: int = 50, start_ns: int = START_NS) -> Iterator[tuple[bytes, int]]:
    """Yield each packet's bytes, and when the last of them has arrived [ns]."""
    for index in range(count):
        beam = packet(index)
        delay_ns = round(reply_delay(beam, BAUDRATE) * 1e9)
        yield beam.frame().encode(), start_ns + index * PERIOD_NS + delay_ns


def raw_messages(
    pieces: Iterable[tuple[bytes, int]], *, labelled: bool = True
) -> Iterator[tuple[str, Any, int]]:
    """Yield topic, message and log time of the bytes."""
    for data, received_ns in pieces:
        message = encoding.raw_bytes(make, data, received_ns)
        if not labelled:
            message.layout.dim = []
        yield "/sonar/raw", message, received_ns
