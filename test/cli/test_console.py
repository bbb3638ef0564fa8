# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the console writes, and where."""

import json

import pytest

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode

Captured = pytest.CaptureFixture[str]


def test_progress_in_a_pipe_is_a_line_a_tenth_and_a_stage(capsys: Captured) -> None:
    with Console().progress() as progress:
        for step in range(1001):
            progress(step / 1000, "first" if step < 500 else "second")
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "  0 % first"
    assert lines[-1] == "100 % second"
    assert len(lines) == 11


def test_quiet_shows_errors_only(capsys: Captured) -> None:
    console = Console(quiet=True)
    with console.progress() as progress:
        progress(0.5, "half")
    console.remark("remark")
    console.result({"a": 1}, lambda: console.line("result"))
    console.error("error")
    assert capsys.readouterr() == ("", "error\n")


def test_json_is_the_result_alone(capsys: Captured) -> None:
    console = Console(quiet=True, as_json=True)
    console.result({"a": [1.5, None]}, lambda: console.line("result"))
    assert json.loads(capsys.readouterr().out) == {"a": [1.5, None]}


def test_a_number_that_is_not_finite_is_never_json() -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        Console(as_json=True).result({"a": float("nan")}, lambda: None)


def test_an_error_is_one_line(capsys: Captured) -> None:
    Console().error("first\nsecond  third")
    assert capsys.readouterr().err == "first second third\n"


def test_brackets_are_no_markup(capsys: Captured) -> None:
    console = Console()
    console.line("in [0, 1] [bold]")
    console.table(["[m]", "x"], [["[red]", "1"]])
    out = capsys.readouterr().out
    assert "in [0, 1] [bold]" in out
    assert "[m]" in out
    assert "[red]" in out


def test_numbers_stand_to_the_right_and_words_to_the_left(capsys: Captured) -> None:
    Console().table(["name", "figure"], [["a", "1"], ["bb", "-22.5"], ["ccc", ""]])
    rows = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    first = next(row for row in rows if " a " in row)
    second = next(row for row in rows if " bb " in row)
    assert first.index("a") == second.index("bb")
    assert len(first) == len(second)


def test_a_long_line_is_not_broken_in_a_pipe(capsys: Captured) -> None:
    Console().line("word " * 100)
    assert capsys.readouterr().out.count("\n") == 1


def test_lost_data_set_the_exit_code(capsys: Captured) -> None:
    assert Console().lost("") is ExitCode.CLEAN
    assert capsys.readouterr().err == ""
    assert Console().lost("3 x beam_without_bins") is ExitCode.DATA_LOST
    assert capsys.readouterr().err == "lost or refused: 3 x beam_without_bins\n"
