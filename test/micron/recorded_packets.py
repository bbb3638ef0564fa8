# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Real packets, where the recordings of others lie beside the repository."""

import struct
from collections.abc import Iterator
from pathlib import Path

import pytest

from msss_graphslam.micron.frame import Frame

FOLDER = Path(__file__).parents[3] / "shared" / "data" / "pysonar_seanet"
UDP_LOG = FOLDER / "UdpHubLog_4001_2017_11_02_09_00_03.csv"
SEANET_LOG = FOLDER / "90degree scan target moving in.V4LOG"
HEX_TEXT = FOLDER / "example_mtHeadData_packets.hex"
HEAD_PORT = "4002"


def needed(path: Path) -> Path:
    """Return the path, or skip the test that asks for it."""
    if not path.exists():
        pytest.skip(f"the recording {path.name} of others is not beside the repository")
    return path


def udp_datagrams() -> Iterator[bytes]:
    """Yield what the head's port brought: a fragment of its stream each."""
    for line in needed(UDP_LOG).read_text(encoding="ascii").splitlines():
        _, _, port, content = line.split(";", 3)
        if port == HEAD_PORT:
            yield bytes.fromhex(content)


def seanet_frames() -> Iterator[Frame]:
    """Yield the records' packets, which lack ``@``, lengths, count and line feed."""
    data = needed(SEANET_LOG).read_bytes()
    position, _, _, end = struct.unpack_from("<IIII", data, 0x28)
    while position < end:
        (size,) = struct.unpack_from("<H", data, position)
        source, destination, kind, sequence, node = data[position + 10 : position + 15]
        payload = data[position + 15 : position + size]
        yield Frame(kind, payload, source, destination, sequence, node)
        position += size


def hex_packets() -> list[bytes]:
    """Return the packets that are written out as text."""
    data = bytes.fromhex(needed(HEX_TEXT).read_text(encoding="ascii"))
    return [data[start : start + 839] for start in range(0, len(data), 839)]
