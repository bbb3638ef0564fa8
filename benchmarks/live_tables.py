# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of ``python -m benchmarks.live``. No ROS."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.live_figures import Percentiles
from benchmarks.live_usage import Memory
from benchmarks.tables import Table

__all__ = [
    "Latency",
    "NodeUsage",
    "Replay",
    "Traffic",
    "bandwidth_table",
    "latency_table",
    "replay_cost_table",
    "replay_table",
    "usage_table",
]

CPU_BAR = 35.0
MEMORY_BAR = 600.0
RATE_BAR = 20.0

TOPSIDE = (
    "scan/beams",
    "graph/tried",
    "graph/poses",
    "graph/correction",
    "pose",
    "diagnostics",
)
"""What crosses the link where the back end runs topside and the rest on the vehicle."""


@dataclass(frozen=True, slots=True)
class NodeUsage:
    """What a node uses: ``cpu`` [% of one core] and memory; ``counted`` towards the bars."""

    cpu: float
    memory: Memory
    counted: bool = True


@dataclass(frozen=True, slots=True)
class Latency:
    """A latency's name, times and bars [s]; None where there is none."""

    name: str
    times: Percentiles
    median_bar: float | None = None
    p99_bar: float | None = None


@dataclass(frozen=True, slots=True)
class Replay:
    """A replay ``asked`` for at a rate (0: as fast as it goes), and how it went.

    ``rate`` is mission seconds a second from the first to the last odometry, ``whole`` the
    command's time [s]; ``lost`` messages; ``equal`` whether the trajectory is the offline run's.
    ``cpu`` is what each node took [s] for ``mission`` [s] of the bag.
    """

    asked: float
    rate: float
    whole: float
    lost: int
    equal: bool
    mission: float
    cpu: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Traffic:
    """``messages`` and ``size`` [bytes] on a topic in all."""

    messages: int
    size: int


def usage_table(title: str, usage: Mapping[str, NodeUsage]) -> Table:
    """Return a row a node, and the sum of those that count with the bars beside it."""
    counted = [node for node in usage.values() if node.counted]
    cpu = sum(node.cpu for node in counted)
    rss = sum(node.memory.rss for node in counted)
    pss = sum(node.memory.pss for node in counted)
    rows = [
        [
            name if node.counted else f"{name} (not counted)",
            f"{node.cpu:.1f}",
            f"{node.memory.rss:.0f}",
            f"{node.memory.pss:.0f}",
        ]
        for name, node in usage.items()
    ]
    rows.append(
        [
            "all nodes",
            _within(cpu, CPU_BAR, f"{cpu:.1f}"),
            _within(rss, MEMORY_BAR, f"{rss:.0f}"),
            _within(pss, MEMORY_BAR, f"{pss:.0f}"),
        ]
    )
    header = [
        "node",
        f"CPU [% of one core] (≤ {CPU_BAR:g})",
        f"RSS [MiB] (≤ {MEMORY_BAR:g})",
        f"PSS [MiB] (≤ {MEMORY_BAR:g})",
    ]
    return Table(title, header, rows)


def latency_table(title: str, latencies: Sequence[Latency]) -> Table:
    """Return a row a latency, with its bars."""
    rows = [
        [
            latency.name,
            str(latency.times.count),
            _milliseconds(latency.times.median, latency.median_bar),
            _milliseconds(latency.times.p99, latency.p99_bar),
        ]
        for latency in latencies
    ]
    return Table(title, ["from, to", "number", "median [ms]", "p99 [ms]"], rows)


def replay_table(replays: Sequence[Replay]) -> Table:
    """Return a row a replay."""
    rows = [
        [
            _asked(replay),
            # What is asked for is reached but for a moment at the start.
            _mark(replay.rate >= 0.99 * RATE_BAR, f"{replay.rate:.1f}"),
            f"{replay.whole:.1f}",
            _mark(replay.lost == 0, str(replay.lost)),
            "yes" if replay.equal else "no (missed)",
        ]
        for replay in replays
    ]
    header = [
        "rate asked for",
        f"rate (≥ {RATE_BAR:g})",
        "whole command [s]",
        "messages lost (0)",
        "trajectory.tum as offline",
    ]
    return Table("Replay of the sample bag", header, rows)


def replay_cost_table(replays: Sequence[Replay]) -> Table:
    """Return a row a node: what it takes for 1000 s of mission, at each rate."""
    names = list(dict.fromkeys(name for replay in replays for name in replay.cpu))
    rows = [[name, *(_per_1000_s(replay, [name]) for replay in replays)] for name in names]
    rows.append(["all", *(_per_1000_s(replay, names) for replay in replays)])
    header = ["node", *(_asked(replay) for replay in replays)]
    return Table("Replay: CPU seconds for 1000 s of mission, by the rate asked for", header, rows)


def bandwidth_table(traffic: Mapping[str, Traffic], seconds: float) -> Table:
    """Return a row a topic that carried something, the heaviest first, over ``seconds``."""
    order = sorted(traffic, key=lambda name: (-traffic[name].size, name))
    rows = [
        [
            name,
            f"{traffic[name].messages / seconds:.2f}",
            f"{traffic[name].size / traffic[name].messages:.0f}",
            f"{traffic[name].size / seconds:.0f}",
            "yes" if name in TOPSIDE else "",
        ]
        for name in order
        if traffic[name].messages
    ]
    needed = sum(one.size for name, one in traffic.items() if name in TOPSIDE)
    rows.append(["to and from a topside back end", "", "", f"{needed / seconds:.0f}", "yes"])
    header = ["topic", "messages/s", "bytes a message", "bytes/s", "topside back end"]
    return Table(f"Bandwidth at real time, {seconds:.0f} s of mission", header, rows)


def _asked(replay: Replay) -> str:
    return f"{replay.asked:g}" if replay.asked else "as fast as it goes"


def _per_1000_s(replay: Replay, names: Sequence[str]) -> str:
    return f"{1e3 * sum(replay.cpu.get(name, 0.0) for name in names) / replay.mission:.1f}"


def _milliseconds(seconds: float, bar: float | None) -> str:
    text = f"{1e3 * seconds:.1f}"
    if bar is None:
        return text
    return f"{_within(seconds, bar, text)} (≤ {1e3 * bar:g})"


def _within(value: float, bar: float, text: str) -> str:
    return _mark(value <= bar, text)


def _mark(kept: bool, text: str) -> str:
    return text if kept else f"{text} (missed)"
