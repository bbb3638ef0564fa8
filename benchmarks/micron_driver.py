# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the driver costs at 25 beams/s of 400 bins: CPU time of the real node, by Linux' account.

    python -m benchmarks.micron_driver [--seconds 20]

The head is emulated, on a pseudo-terminal. In the second row its bytes come as a real line brings
them, a few every millisecond, and nobody answers; in the third they are recorded ones.
"""

import os
import subprocess
import sys
import time
from argparse import ArgumentParser
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.live_usage import cpu_seconds, memory
from benchmarks.micron_feeding import BAUDRATE, BINS, RATE, feed_a_terminal, feed_a_topic
from benchmarks.tables import Table

__all__ = ["main"]

_LIMIT = 5.0
_STARTING = 90.0
_EMULATOR = "from msss_graphslam.simulation.emulator.main import main; main()"
_SETTINGS = {"bins": BINS, "step_deg": 1.6875, "range_m": 20.0, "baudrate": 230400}


def main() -> None:
    """Print the table."""
    parser = ArgumentParser(
        prog="python -m benchmarks.micron_driver", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--seconds", type=float, default=20.0, help="length of each measurement")
    seconds = parser.parse_args().seconds
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    cases = {
        "an emulated head, whole packets": _emulated,
        "a line of 115200 Bd, byte by byte": _trickled,
        "recorded bytes (source topic)": _recorded,
    }
    rows = [(name, *_measured(case, seconds)) for name, case in cases.items()]
    header = ("bytes from", "beams/s", f"CPU [% of one core] (<= {_LIMIT:g})", "PSS [MiB]")
    print(Table("The driver of the head", header, rows).markdown())


Case = Callable[[ExitStack, Path], int]
"""Starts a driver and what feeds it; returns the driver's process number."""


def _measured(case: Case, seconds: float) -> list[str]:
    with TemporaryDirectory() as folder, ExitStack() as stack:
        process = case(stack, Path(folder))
        beams = stack.enter_context(_ear())
        _await(lambda: beams() > RATE)
        begun, used, heard = time.monotonic(), cpu_seconds(process), beams()
        while time.monotonic() - begun < seconds:
            beams()
        spent = time.monotonic() - begun
        share = 100.0 * (cpu_seconds(process) - used) / spent
        rate = (beams() - heard) / spent
        return [f"{rate:.1f}", f"{share:.1f}", f"{memory(process).pss:.0f}"]


def _emulated(stack: ExitStack, folder: Path) -> int:
    port = folder / "head"
    arguments = ["--pty", str(port), "--baudrate", str(_SETTINGS["baudrate"])]
    _start(stack, [sys.executable, "-c", _EMULATOR, *arguments])
    return _driver(stack, port=port, **_SETTINGS)


def _trickled(stack: ExitStack, folder: Path) -> int:
    del folder
    slower = {**_SETTINGS, "baudrate": BAUDRATE}
    return _driver(stack, port=stack.enter_context(feed_a_terminal()), **slower)


def _recorded(stack: ExitStack, folder: Path) -> int:
    del folder
    process = _driver(stack, source="topic")
    stack.enter_context(feed_a_topic())
    return process


def _driver(stack: ExitStack, **parameters: object) -> int:
    command = [sys.executable, "-m", "msss_graphslam.nodes.micron_driver", "--ros-args"]
    for name, value in parameters.items():
        command += ["-p", f"{name}:={value}"]
    return _start(stack, command)


def _start(stack: ExitStack, command: list[str]) -> int:
    process = subprocess.Popen(  # noqa: S603
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )

    def end() -> None:
        process.terminate()
        process.wait()

    stack.callback(end)
    return process.pid


@contextmanager
def _ear() -> Iterator[Callable[[], int]]:
    """Give a function that listens for a moment and returns how many beams have come."""
    import rclpy

    from msss_graphslam.messages import topics
    from msss_graphslam.ros.messages import message_class
    from msss_graphslam.ros.qos import profile_of
    from msss_graphslam.ros.visiting import visitor

    with visitor("benchmark_ear", "") as node:
        heard: list[bytes] = []
        kind = message_class(topics.SONAR_PING.type_name)
        profile = profile_of(topics.SONAR_PING)
        node.create_subscription(kind, topics.SONAR_PING.name, heard.append, profile, raw=True)
        executor = rclpy.executors.SingleThreadedExecutor(context=node.context)
        executor.add_node(node)

        def count() -> int:
            executor.spin_once(timeout_sec=0.05)
            return len(heard)

        yield count
        executor.shutdown()


def _await(condition: Callable[[], bool]) -> None:
    until = time.monotonic() + _STARTING
    while not condition():
        if time.monotonic() > until:
            raise TimeoutError("no beams")


if __name__ == "__main__":
    main()
