# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What processes use, as Linux tells it in /proc."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Memory", "cpu_seconds", "cpu_ticks", "memory", "memory_of", "nodes_of"]

_PROC = Path("/proc")
_TICKS_A_SECOND = os.sysconf("SC_CLK_TCK")
_MODULES = "msss_graphslam.nodes."


@dataclass(frozen=True, slots=True)
class Memory:
    """Resident memory [MiB]: ``rss`` counts shared pages in every process, ``pss`` once in all."""

    rss: float
    pss: float


def nodes_of(parent: int) -> Mapping[str, int]:
    """Return the process number of each node that this process has started, by its name."""
    found = {}
    for process in _descendants(parent):
        name = _node_name((_PROC / str(process) / "cmdline").read_bytes())
        if name:
            found[name] = process
    return found


def cpu_seconds(process: int) -> float:
    """Return the CPU time [s] that the process has taken so far."""
    text = (_PROC / str(process) / "stat").read_text(encoding="utf-8")
    return cpu_ticks(text) / _TICKS_A_SECOND


def cpu_ticks(stat: str) -> int:
    """Return user and system time [ticks] of a ``stat``; the name in it may hold anything."""
    fields = stat.rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


def memory(process: int) -> Memory:
    """Return what the process holds now."""
    return memory_of((_PROC / str(process) / "smaps_rollup").read_text(encoding="utf-8"))


def memory_of(rollup: str) -> Memory:
    """Return what a ``smaps_rollup`` tells."""
    rows = dict(line.split(":", 1) for line in rollup.splitlines()[1:])
    rss, pss = (int(rows[name].split()[0]) / 1024.0 for name in ("Rss", "Pss"))
    return Memory(rss, pss)


def _descendants(parent: int) -> list[int]:
    tasks = (_PROC / str(parent) / "task").glob("*/children")
    children = [int(word) for task in tasks for word in task.read_text().split()]
    return children + [process for child in children for process in _descendants(child)]


def _node_name(command_line: bytes) -> str:
    for word in command_line.decode(errors="replace").split("\0"):
        if word.startswith(_MODULES):
            return word.removeprefix(_MODULES)
    return ""
