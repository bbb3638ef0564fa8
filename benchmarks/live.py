# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks.live``: what the live nodes cost, against the figures they shall keep."""

from argparse import ArgumentParser
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.live_measuring import at_real_time, bandwidth, late_keyframes, offline, replay
from benchmarks.live_missions import SAMPLE, full_rate_bag
from benchmarks.live_tables import (
    bandwidth_table,
    latency_table,
    replay_cost_table,
    replay_table,
    usage_table,
)
from benchmarks.tables import Table, add_folder, publish
from msss_graphslam.cli.console import Console

__all__ = ["main"]

PARTS = ("cpu", "keyframes", "replay", "bandwidth")
RATES = (20.0, 0.0)
MANY_TURNS = 200

ABOUT = """\
Real processes over real DDS on one machine, 25 beams/s of 350 bins and 50 Hz of IMU. CPU is that
of /proc/PID/stat; `all nodes` are the four that run on a vehicle, without the replay in the
sensors' place. PSS counts a page that several processes share once in all.

A latency begins when the middleware stamps the input as published and ends when the answer has
arrived in a further process, before any Python there. `odom` comes with every IMU sample: what a
beam waits for the next one (up to 20 ms) is the vehicle's, not the nodes', and shown apart. The
p99 of fewer than 100 values is their largest."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the bag that is missing, measure, print the tables and write them."""
    parser = ArgumentParser(prog="python -m benchmarks.live", description=__doc__)
    parser.add_argument(
        "--part", choices=PARTS, action="append", help="only this part; may be repeated"
    )
    parser.add_argument(
        "--seconds", type=float, default=60.0, help="how long to measure at real time"
    )
    add_folder(parser)
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    console = Console()
    tables = _tables(options.part or PARTS, options.seconds, options.out, console)
    publish("What the live nodes cost", ABOUT, tables, console, options.out / "live.md")


def _tables(
    parts: Sequence[str], seconds: float, folder: Path, console: Console
) -> Iterator[Table]:
    with TemporaryDirectory(dir=folder) as unfinished:
        scratch = Path(unfinished)
        for part in PARTS:
            if part in parts:
                console.remark(f"measuring: {part}")
                yield from _part(part, seconds, folder, scratch, console)


def _part(
    part: str, seconds: float, folder: Path, scratch: Path, console: Console
) -> Iterator[Table]:
    if part == "replay":
        reference = offline(SAMPLE, scratch)
        replays = [replay(SAMPLE, rate, scratch, reference) for rate in RATES]
        yield replay_table(replays)
        yield replay_cost_table(replays)
        return
    bag = full_rate_bag(folder, console)
    if part == "cpu":
        usage, latencies = at_real_time(bag, scratch, seconds)
        yield usage_table("At real time: CPU and memory", usage)
        yield latency_table("At real time: latency", latencies)
    elif part == "keyframes":
        usage, latencies = late_keyframes(bag, scratch, MANY_TURNS, seconds)
        yield usage_table(f"After {MANY_TURNS} turns: CPU and memory", usage)
        yield latency_table(f"After {MANY_TURNS} turns: latency", latencies)
    else:
        yield bandwidth_table(bandwidth(bag, scratch, seconds), seconds)


if __name__ == "__main__":
    main()
