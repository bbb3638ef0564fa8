# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The sample bag is the one that its README describes."""

import hashlib
from pathlib import Path

BAGS = Path(__file__).parents[2] / "bags"
FILE = next((BAGS / "pond").glob("*.mcap"))


def test_the_checksum_is_the_one_noted() -> None:
    checksum = hashlib.sha256(FILE.read_bytes()).hexdigest()
    assert f"`{checksum}`" in (BAGS / "README.md").read_text(encoding="utf-8")


def test_it_is_small_enough_for_git() -> None:
    assert FILE.stat().st_size <= 10_000_000
