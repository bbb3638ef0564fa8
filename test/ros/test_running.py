# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A node as a process: it starts or says why not, goes on, and ends when it is told to."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

pytest.importorskip("rclpy")

pytestmark = pytest.mark.slow

_NODE = """
import sys, time
from msss_graphslam.errors import UserError
from msss_graphslam.ros.node import SlamNode, run

class Vehicle(SlamNode):
    def __init__(self):
        super().__init__("vehicle")
        {construction}
        self.create_timer(0.05, self.work)

    def work(self):
        print("working", flush=True)
        {work}

    def on_shutdown(self):
        print("written", flush=True)
        {shutdown}

sys.exit(run(Vehicle))
"""

Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Return what starts a node of the statements given, in a process of its own."""
    processes: list[subprocess.Popen[str]] = []

    def started(
        *arguments: str, construction: str = "pass", work: str = "pass", shutdown: str = "pass"
    ) -> subprocess.Popen[str]:
        script = tmp_path / "vehicle.py"
        script.write_text(_NODE.format(construction=construction, work=work, shutdown=shutdown))
        processes.append(
            subprocess.Popen(
                [sys.executable, str(script), *arguments],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
            )
        )
        return processes[-1]

    yield started
    for process in processes:
        process.kill()
        process.communicate()


def _line(process: "subprocess.Popen[str]", text: str) -> None:
    """Read on until the line."""
    assert process.stdout is not None
    assert any(line.strip() == text for line in process.stdout)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_node_cleanly(start: Start, number: signal.Signals) -> None:
    process = start()
    _line(process, "working")
    process.send_signal(number)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (0, "")
    assert out.splitlines()[-1] == "written"


def test_a_signal_does_not_break_into_a_callback(start: Start) -> None:
    process = start(work="time.sleep(0.5); print('whole', flush=True)")
    _line(process, "working")
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (0, "")
    assert out.splitlines()[-2:] == ["whole", "written"]


_STUCK = """
        import signal
        print("stuck", flush=True)
        for _ in range(1000):
            if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
                break
            time.sleep(0.01)
        print("asked", flush=True)
        time.sleep(1000)
"""


@pytest.mark.parametrize("place", ["work", "shutdown"])
def test_the_second_signal_ends_at_once(start: Start, place: str) -> None:
    process = start(**{place: _STUCK})
    _line(process, "stuck" if place == "work" else "working")
    process.send_signal(signal.SIGINT)
    _line(process, "asked")
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=30)
    assert process.returncode == -signal.SIGINT


def test_an_exception_ends_nothing_and_is_told_once(start: Start) -> None:
    process = start(work="1 / 0")
    for _ in range(5):
        _line(process, "working")
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 0
    assert err.count("Traceback") == 1
    assert "ZeroDivisionError" in err


def test_a_shutdown_that_fails_is_told(start: Start) -> None:
    process = start(shutdown="raise OSError('disk full')")
    _line(process, "working")
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert "disk full" in err


def test_a_node_that_cannot_start_says_why_in_one_line(start: Start) -> None:
    process = start(construction="raise UserError('output: cannot be written')")
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out) == (1, "")
    assert err.splitlines() == ["Vehicle: output: cannot be written"]


def test_a_parameter_file_that_is_missing_is_named(start: Start) -> None:
    process = start("--ros-args", "--params-file", "no_such.yaml")
    _, err = process.communicate(timeout=30)
    assert process.returncode == 1
    assert "no_such.yaml" in err.splitlines()[-1]
    assert "Traceback" not in err
