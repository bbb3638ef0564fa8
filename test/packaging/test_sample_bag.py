# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The sample bag is the one that its README describes."""

import hashlib
from pathlib import Path

import pytest

BAGS = Path(__file__).parents[2] / "bags"


@pytest.fixture
def file() -> Path:
    (path,) = (BAGS / "pond").glob("*.mcap")
    return path


def test_the_checksum_is_the_one_noted(file: Path) -> None:
    checksum = hashlib.sha256(file.read_bytes()).hexdigest()
    assert f"`{checksum}`" in (BAGS / "README.md").read_text(encoding="utf-8")


def test_it_is_small_enough_for_git(file: Path) -> None:
    assert file.stat().st_size <= 10_000_000
