# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Small scripts in the place of nodes, and waiting for what they do."""

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

from msss_graphslam.live.process import Command

__all__ = ["NODE", "is_alive", "stand_in", "wait_until"]

NODE = """
import os, signal, sys, time
def end(number, frame):
    print("got", signal.Signals(number).name)
    sys.exit(0)
signal.signal(signal.SIGINT, end)
signal.signal(signal.SIGTERM, end)
print("pid", os.getpid())
while True:
    time.sleep(0.02)
"""
"""Says its pid, and ends with 0 on SIGINT and SIGTERM, as a node does."""

_PATIENCE = 30.0


def stand_in(name: str, script: str = NODE, *, returns: bool = True) -> Command:
    """Return the command of a script under a node's name."""
    return Command(name, (sys.executable, "-u", "-c", script), returns=returns)


def wait_until(condition: Callable[[], bool], look: Callable[[], None] = lambda: None) -> None:
    """Wait for a condition, looking after the processes meanwhile; fail if it never comes."""
    until = time.monotonic() + _PATIENCE
    while not condition():
        assert time.monotonic() < until, "it never came"
        look()
        time.sleep(0.01)


def is_alive(pid: int) -> bool:
    """Whether there is a process of this pid that is no zombie."""
    try:
        os.kill(pid, 0)
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except (ProcessLookupError, FileNotFoundError):
        return False
    return state != "Z"
