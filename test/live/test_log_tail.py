# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is read of a log that grows."""

from pathlib import Path

import pytest

from msss_graphslam.live.log_tail import LogTail, warning_in


def test_only_new_whole_lines_are_given(tmp_path: Path) -> None:
    path = tmp_path / "node.log"
    path.write_bytes(b"one\ntw")
    tail = LogTail(path)
    assert list(tail.lines()) == ["one"]
    assert list(tail.lines()) == []
    with path.open("ab") as log:
        log.write(b"o\n\nthree\n")
    assert list(tail.lines()) == ["two", "three"]
    assert tail.last == "three"


def test_bytes_that_are_no_text_are_read_all_the_same(tmp_path: Path) -> None:
    path = tmp_path / "node.log"
    path.write_bytes(b"\xff\x00\xfe\nplain\n")
    assert list(LogTail(path).lines())[1] == "plain"


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("[WARN] [1763840000.123456789] [front_end]: late", "warning: late"),
        ("[ERROR] [1763840000.1] [ns.front_end]: a [b]: c", "error: a [b]: c"),
        ("[FATAL] [1763840000.1] [front_end]: gone", "error: gone"),
        ("[INFO] [1763840000.1] [front_end]: ready", None),
        ("says [WARN] [1.0] [x]: quoted", None),
        ("", None),
    ],
)
def test_warnings_and_errors_are_shown_and_nothing_else(line: str, shown: str | None) -> None:
    assert warning_in(line) == shown
