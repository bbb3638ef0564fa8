# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The command line: help for every command, and one clear line for a wrong one."""

import pytest
from command_line import msss

COMMANDS = ("simulate", "run", "live", "compare", "evaluate", "inspect", "convert", "salvage")


def test_help_names_every_command() -> None:
    done = msss("--help")
    assert done.returncode == 0
    listed = {line.split()[0] for line in done.stdout.splitlines() if line.startswith("    ")}
    assert set(COMMANDS) <= listed


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(command: str) -> None:
    done = msss(command, "--help")
    assert done.returncode == 0
    assert done.stdout.startswith(f"usage: msss {command}")
    assert "--quiet" in done.stdout
    assert "--json" in done.stdout


def test_the_version_is_the_packages() -> None:
    from msss_graphslam import __version__

    assert msss("--version").stdout.split() == ["msss_graphslam", __version__]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "required: COMMAND"),
        (("swim",), "invalid choice: 'swim'"),
        (("run", "bag"), "required: --out"),
        (("run", "--out", "out"), "required: BAG"),
        (("run", "bag", "--out", "out", "--fast"), "unrecognized arguments: --fast"),
        (
            ("run", "bag", "--out", "out", "--estimator", "chen2051"),
            "unknown estimator 'chen2051'; did you mean 'chen2015'?",
        ),
        (
            ("run", "bag", "--out", "out", "--set", "sonar.mont_x=1"),
            "unknown parameter 'sonar.mont_x'; did you mean 'sonar.mount_x'?",
        ),
        (
            ("run", "bag", "--out", "out", "--set", "sonar.mount_yaw=7"),
            "sonar.mount_yaw = 7.0: must lie in [-3.15, 3.15]",
        ),
        (
            ("compare", "bag", "--out", "out", "--set", "sonar.mount_x=left"),
            "sonar.mount_x = 'left': must be of type float",
        ),
        (("inspect", "bag", "--set", "sonar.mount_x"), "must have the form group.name=value"),
        (("simulate", "ocean", "--seed", "1", "--out", "out"), "invalid choice: 'ocean'"),
        (("simulate", "pond", "--seed", "-1", "--out", "out"), "must be a whole number from 0 on"),
        (("simulate", "pond", "--seed", "one", "--out", "out"), "must be a whole number from 0"),
        (("simulate", "pond", "--seed", "1", "--out", "o", "--noise", "much"), "invalid"),
        (("evaluate", "run"), "required: --ground-truth"),
    ],
)
def test_a_wrong_command_is_one_line_and_exit_code_2(
    arguments: tuple[str, ...], said: str
) -> None:
    done = msss(*arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert said in done.stderr
    assert "--help" in done.stderr
