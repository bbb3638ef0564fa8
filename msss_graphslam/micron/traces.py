# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Traces of another packet's header at the end of one.

Where bytes were lost, a packet reaches into the next one, and if a line feed happens to stand at
its end, its sizes cannot tell. Whole headers inside it are found by their form. A damaged one, or
one that the end cuts off, is found here, by its likeness: as the line feed of the packet before
and the header of a reply, with few bytes wrong, missing or too many.

The search is that of Wu and Manber, "Fast text searching allowing errors", 1992: the bit ``i`` of
``states[e]`` says that the first i + 1 symbols end here with at most e errors.
"""

import re
from collections.abc import Iterable, Sequence

__all__ = ["reaches_into_next"]

_DIGITS = b"0123456789ABCDEF"
_HIGH = bytes(range(7))
_HEADER = [
    b"\n",
    b"@",
    b"0",
    _DIGITS[:7],
    _DIGITS,
    _DIGITS,
    bytes(range(256)),
    _HIGH,
    b"\x02",
    b"\xff",
    b"\x00\x0b\x0e\x11\x45\xa4\xfd",
    b"\x01\x02\x04\x06\x39\x3f",
    b"\x80",
    b"\x02",
]
"""The bytes that may stand at each place of a reply's header, a line feed before it."""
_TAIL = 64
"""How far from the end a header may begin: no more bytes than that are lost one by one."""
_ERRORS_ALLOWED = {8: 0, 9: 1, 10: 1, 11: 2, 12: 2, 13: 2, 14: 3}
"""How many errors leave so many symbols, cut off by the packet's end, still recognisable.

Fewer are no proof: the digits, ``@`` and a line feed are likely echoes.
"""
_SAME_LENGTH_ERRORS, _BESIDE_A_BOUNDARY = {6: 2}, {6: 3}
"""How many errors leave the six symbols up to a length of xx0A recognisable.

The lower half of such a length is a line feed itself, and beams of one setting have all the same.
The digits alone are likely echoes: one error more is allowed beside a line feed or ``@``.
"""
_OTHER_LENGTH = re.compile(rb"\n@0[0-6]0A\Z")


def _masks(symbols: Sequence[bytes]) -> list[int]:
    """Return for each byte (256) the places, as bits, where it may stand."""
    return [
        sum(1 << place for place, allowed in enumerate(symbols) if byte in allowed)
        for byte in range(256)
    ]


def _ends(errors_allowed: dict[int, int]) -> list[int]:
    """Return for each number of errors the prefixes, as bits, that are recognised with it."""
    most = max(errors_allowed.values())
    return [
        sum(1 << size - 1 for size, allowed in errors_allowed.items() if allowed == errors)
        for errors in range(most + 1)
    ]


_HEADER_MASKS = _masks(_HEADER)
_HEADER_ENDS = _ends(_ERRORS_ALLOWED)
_WHOLE = 1 << len(_HEADER) - 1
_SAME_LENGTH = {
    digit: _masks([b"\n", b"@", b"0", bytes([digit]), b"0", b"A"]) for digit in _DIGITS[:7]
}
_SAME_LENGTH_ENDS = _ends(_SAME_LENGTH_ERRORS)
_BOUNDARY_ENDS = _ends(_BESIDE_A_BOUNDARY)


def reaches_into_next(packet: bytes) -> bool:
    """Say whether the end of a reply, a whole packet by its sizes, looks like the next one's."""
    text = packet[max(13, len(packet) - _TAIL) : -1]
    return _found(text, _HEADER_MASKS, _HEADER_ENDS, _WHOLE) or _cut_in_length(packet, text[-8:])


def _cut_in_length(packet: bytes, text: bytes) -> bool:
    """Say whether the packet's line feed looks like a part of the next one's length."""
    if packet[5:6] == b"\n":
        at_boundary = b"\n" in text or b"@" in text
        ends = _BOUNDARY_ENDS if at_boundary else _SAME_LENGTH_ENDS
        return _found(text, _SAME_LENGTH[packet[2]], ends, 0)
    return _OTHER_LENGTH.search(text) is not None


def _found(text: Iterable[int], masks: Sequence[int], ends: Sequence[int], whole: int) -> bool:
    """Say whether ``whole`` stands anywhere in the text, or a prefix in ``ends`` at its end."""
    most = len(ends) - 1
    states = [(1 << errors) - 1 for errors in range(most + 1)]
    for byte in text:
        _advance(states, masks[byte])
        if states[most] & whole:
            return True
    return any(state & recognised for state, recognised in zip(states, ends, strict=True))


def _advance(states: list[int], mask: int) -> None:
    """Read one byte: right, or wrong, or one too many, or with one missing before it."""
    before = states[0]
    states[0] = after = (before << 1 | 1) & mask
    for errors in range(1, len(states)):
        old = states[errors]
        after = (old << 1 | 1) & mask | before | before << 1 | after << 1 | 1
        states[errors], before = after, old
