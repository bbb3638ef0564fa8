# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Long work is told at each tenth, and when something else is done."""

from msss_graphslam.nodes.tenths import Tenths


def test_each_tenth_and_each_kind_of_work_is_told_once() -> None:
    said: list[str] = []
    tell = Tenths(said.append)
    for share, what in ((0.0, "maps"), (0.05, "maps"), (0.1, "maps"), (0.1, "files"), (1.0, "f")):
        tell(share, what)
    assert said == [
        "saving 0 %: maps",
        "saving 10 %: maps",
        "saving 10 %: files",
        "saving 100 %: f",
    ]
