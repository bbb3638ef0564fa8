# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss live`` as a process of its own, with a probe beside it."""

import os
import random
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic

from benchmarks.live_probe import Probe, probing

__all__ = ["LiveNodes", "replaying", "running"]

_LONGEST_END = 60.0
_STEP = 0.2
_SETTLING = 5.0


class LiveNodes:
    """The nodes of one ``msss live``; ``probe`` hears them."""

    def __init__(self, process: subprocess.Popen[bytes], probe: Probe) -> None:
        self.process = process
        self.probe = probe

    @property
    def are_running(self) -> bool:
        """Whether ``msss live`` has not ended."""
        return self.process.poll() is None

    def listen_until(self, topic: str) -> None:
        """Go on until something comes on the topic; RuntimeError if the nodes end before."""
        while not self.probe.arrivals[topic].stamps:
            self._listen()

    def settle(self, topic: str) -> None:
        """Go on until the topic speaks and the start is over; forget what came until then."""
        self.listen_until(topic)
        self.listen_for(_SETTLING)
        for arrivals in self.probe.arrivals.values():
            arrivals.clear()

    def listen_for(self, seconds: float) -> None:
        """Go on for a time; RuntimeError if the nodes end before."""
        until = monotonic() + seconds
        while monotonic() < until:
            self._listen()

    def listen_to_the_end(self, look: Callable[[], object] = lambda: None) -> None:
        """Go on until the nodes have saved and ended; RuntimeError if that failed.

        ``look`` is called five times a second.
        """
        looked = monotonic()
        while self.are_running:
            self.probe.spin(_STEP)
            if monotonic() - looked >= _STEP:
                looked = monotonic()
                look()
        if self.process.returncode:
            raise RuntimeError(f"msss live ended with {self.process.returncode}")

    def _listen(self) -> None:
        if not self.are_running:
            raise RuntimeError(f"msss live ended early, with {self.process.returncode}")
        self.probe.spin(_STEP)


@contextmanager
def running(bag: Path | None, rate: float, output: Path) -> Iterator[LiveNodes]:
    """Run the nodes in a domain of their own, on the bag if there is one; end them at the exit."""
    os.environ["ROS_DOMAIN_ID"] = str(random.randrange(1, 100))  # noqa: S311 - no secret
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    command = [sys.executable, "-m", "msss_graphslam", "live", "--quiet"]
    command += ["--out", str(output)]
    if bag is not None:
        command += ["--replay", str(bag), "--rate", f"{rate:g}"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)  # noqa: S603
    try:
        with probing() as probe:
            yield LiveNodes(process, probe)
    finally:
        _end(process)


@contextmanager
def replaying(bag: Path, rate: float, start: float) -> Iterator[None]:
    """Replay the bag from ``start`` [s] on into nodes that run; the replay ends at the exit."""
    values = {"bag": bag, "rate": rate, "start_offset": start, "conclude": "false"}
    command = [sys.executable, "-m", "msss_graphslam.nodes.bag_replay", "--ros-args"]
    for name, value in values.items():
        command += ["-p", f"{name}:={value}"]
    process = subprocess.Popen(command)  # noqa: S603
    try:
        yield
    finally:
        _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.wait(_LONGEST_END)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
