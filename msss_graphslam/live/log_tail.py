# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is new in a log file, and which of its lines a person must see."""

import re
from collections.abc import Iterator
from pathlib import Path

__all__ = ["LogTail", "warning_in"]

_WARNING = re.compile(r"\[(WARN|ERROR|FATAL)\] \[[\d.]+\] \[[^\]]*\]: (.*)")
"""A line of rclpy's log: level, time, logger, text."""

_LONGEST_LINE = 65_536


class LogTail:
    """Reads the lines that were added to a file since the last look."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._offset = 0
        self._rest = b""
        self.last = ""

    def lines(self) -> Iterator[str]:
        """Yield the new lines; one that is not ended yet is kept for later."""
        with self._path.open("rb") as file:
            file.seek(self._offset)
            content = file.read()
        self._offset += len(content)
        *whole, rest = (self._rest + content).split(b"\n")
        self._rest = rest[:_LONGEST_LINE]
        for line in whole:
            text = line.decode("utf-8", errors="replace").rstrip()
            if text:
                self.last = text
                yield text


def warning_in(line: str) -> str | None:
    """Return a warning or an error as a person reads it, or None for any other line."""
    found = _WARNING.match(line)
    if found is None:
        return None
    level = {"WARN": "warning"}.get(found[1], "error")
    return f"{level}: {found[2]}"
