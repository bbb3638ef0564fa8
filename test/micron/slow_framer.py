# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The rules for a packet once more, plainly: each place of a whole stream is tried in turn.

Independent of the framer but for the likeness of damaged headers.
"""

from msss_graphslam.micron.traces import reaches_into_next

ALLOWED = {
    (0x02, 0xFF, 1): [25],
    (0x02, 0xFF, 2): list(range(46, 1546)),
    (0x02, 0xFF, 4): [22],
    (0x02, 0xFF, 6): [175, 264],
    (0x02, 0xFF, 57): [28],
    (0x02, 0xFF, 63): [80],
    (0xFF, 0x02, 16): [14],
    (0xFF, 0x02, 19): [15, 31, 66, 82],
    (0xFF, 0x02, 23): [14],
    (0xFF, 0x02, 24): [14],
    (0xFF, 0x02, 25): [18],
    (0xFF, 0x02, 66): [14],
}


def slow_packets(stream: bytes) -> list[bytes]:
    packets, start = [], 0
    while start < len(stream):
        size = _size_of_header(stream, start)
        packet = stream[start : start + size]
        if size and len(packet) == size and _is_whole(packet):
            packets.append(packet)
            start += size
        else:
            start += 1
    return packets


def _size_of_header(stream: bytes, start: int) -> int:
    """Return the promised size, 0 where there is no valid header."""
    header = stream[start : start + 13]
    if len(header) < 13:
        return 0
    length = header[5] + 256 * header[6]
    size = length + 6
    source, destination, count, kind = header[7:11]
    good = (
        header[:5] == b"@" + f"{length:04X}".encode()
        and size in ALLOWED.get((source, destination, kind), [])
        and count == (0 if kind == 2 else length - 5)
        and header[11:] == b"\x80\x02"
    )
    return size if good else 0


def _is_whole(packet: bytes) -> bool:
    size, kind = len(packet), packet[10]
    inner = any(_size_of_header(packet, place) for place in range(1, size))
    if packet[-1] != 0x0A or inner:
        return False
    if kind == 2 and (
        packet[13] + 256 * packet[14] != size - 14 or packet[42] + 256 * packet[43] != size - 45
    ):
        return False
    if kind == 19 and packet[13] != {15: 0x0F, 31: 0x1E, 66: 1, 82: 0x1D}[size]:
        return False
    return packet[7] == 0xFF or not reaches_into_next(packet)
