# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The executable ``micron_emulator``."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from emulated_lines import driven, read

from msss_graphslam.micron.transports.serial_port import SerialPort
from msss_graphslam.simulation.emulator.main import main

START = "from msss_graphslam.simulation.emulator.main import main; raise SystemExit(main())"


def executable(*arguments: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-c", START, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parents[2],
    )


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_executable_serves_until_it_is_ended(number: signal.Signals, tmp_path: Path) -> None:
    link = tmp_path / "head"
    process = executable("--pty", str(link), "--world", "pond", "--seed", "3", "--split", "100")
    assert process.stdout is not None
    assert process.stdout.readline() == f"micron_emulator: a head in the pond at {link}\n"
    driver = driven(SerialPort(str(link), 115200))
    beams = read(driver, 30)
    driver.close()
    assert max(beam.intensities.max() for beam in beams) > 100.0
    process.send_signal(number)
    assert process.communicate(timeout=20.0) == ("", "")
    assert process.returncode == 0
    assert not link.is_symlink()


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ([], "one of the arguments --pty --tcp is required"),
        (["--pty", "a", "--tcp", "1"], "not allowed with"),
        (["--tcp", "65536"], "above 65535"),
        (["--tcp", "0", "--world", "ocean"], "invalid choice"),
        (["--tcp", "0", "--seed", "-1"], "seed"),
        (["--tcp", "0", "--baudrate", "0"], "must be positive"),
        (["--tcp", "0", "--unplug", "5"], "must be seconds"),
        (["--tcp", "0", "--silence", "5:-1"], "no time span"),
        (["--tcp", "0", "--reset", "soon"], "must be seconds"),
    ],
)
def test_a_wrong_command_line_is_said(
    arguments: list[str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2
    assert complaint in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--tcp", "0", "--lost", "2"], "must be a share from 0 to 1"),
        (["--pty", "/proc/none/head"], "cannot be made"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(arguments: list[str], complaint: str) -> None:
    output, errors = (process := executable(*arguments)).communicate(timeout=60.0)
    assert process.returncode == 1
    assert output == ""
    assert errors.startswith("micron_emulator: ")
    assert complaint in errors
    assert errors.count("\n") == 1
