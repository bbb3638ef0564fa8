# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import ctypes
import resource
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from msss_graphslam.offline.freed_memory import give_back

PIECES, PIECE = 40_000, 4096
HELD = PIECES * PIECE / 2.0**20


def resident_mib() -> float:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize() / 2.0**20


@pytest.mark.skipif(
    not sys.platform.startswith("linux") or not hasattr(ctypes.CDLL(None), "malloc_trim"),
    reason="the C library keeps what it keeps",
)
def test_the_gaps_between_what_stays_go_back() -> None:
    pieces = [bytearray(PIECE) for _ in range(PIECES)]
    full = resident_mib()
    kept = pieces[:: PIECES // 4]
    pieces.clear()
    give_back()
    assert resident_mib() < full - 0.8 * HELD
    assert all(len(piece) == PIECE for piece in kept)


def test_a_c_library_that_cannot_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ctypes, "CDLL", lambda _: SimpleNamespace())
    give_back()
