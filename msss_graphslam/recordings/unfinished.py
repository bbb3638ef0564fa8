# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a recording that was cut off has left, put where a person finds it."""

from collections.abc import Iterator
from itertools import count
from pathlib import Path

__all__ = ["set_aside"]


def set_aside(path: Path) -> Path | None:
    """Rename what an earlier, killed BagWriter left of ``path``; return the new name, if any.

    ``msss salvage`` reads it.
    """
    left = path.with_name(f".{path.name}.part")
    if not left.exists():
        return None
    kept = next(name for name in _names(path) if not name.exists())
    left.rename(kept)
    if kept.is_dir():
        for file in kept.glob(".*.mcap.part"):
            file.rename(kept / file.name.removeprefix(".").removesuffix(".part"))
    return kept


def _names(path: Path) -> Iterator[Path]:
    suffix = ".mcap" if path.suffix == ".mcap" else ""
    stem = path.name.removesuffix(".mcap")
    return (path.with_name(f"{stem}.unfinished-{number}{suffix}") for number in count(1))
