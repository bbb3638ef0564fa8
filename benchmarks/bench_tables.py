# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of ``make bench``."""

from collections.abc import Mapping

import numpy as np

from benchmarks.cost import ProcessCost, ScanCosts
from benchmarks.tables import Table
from msss_graphslam.cli.console import Row
from msss_graphslam.results.record import RunRecord

__all__ = ["growth_table", "process_table", "stage_table"]

LEAST_SPEED = 100.0
"""Mission seconds that an estimator shall work off in a CPU second."""

LEAST_SPEEDS = {"full": 150.0}
"""Where it is more."""

MOST_MEMORY = 500.0
"""Peak memory [MiB] that a run shall stay under."""


def process_table(costs: Mapping[str, ProcessCost], duration: float) -> Table:
    """Return a row an estimator: a whole process over a mission of ``duration`` [s]."""
    rows = [
        [
            name,
            f"{cost.estimation:.1f}",
            _speed(name, duration / cost.estimation),
            f"{cost.cpu:.1f}",
            _speed(name, duration / cost.cpu),
            _verdict(cost.peak_mib, cost.peak_mib < MOST_MEMORY),
        ]
        for name, cost in costs.items()
    ]
    bars = ", ".join(f"{name} ≥ {bar:.0f}" for name, bar in LEAST_SPEEDS.items())
    speed = f"mission s per CPU s (≥ {LEAST_SPEED:.0f}, {bars})"
    header = [
        "estimator",
        "estimation, CPU [s]",
        speed,
        "with files and report [s]",
        speed,
        f"peak memory [MiB] (< {MOST_MEMORY:.0f})",
    ]
    return Table(f"msss run as a process, {duration:.0f} s of mission", header, rows)


def stage_table(record: RunRecord) -> Table:
    """Return a row a stage: its calls, time a call, time a scan and share of the estimation."""
    stages, wall = record.cost.stages, record.cost.wall
    scans = len(record.estimate.keyframes)
    rows = [
        [
            name.replace("_", " "),
            str(len(times)),
            f"{1e3 * float(np.mean(times)):.3f}",
            *_share(float(np.sum(times)), wall, scans),
        ]
        for name, times in stages.items()
    ]
    rest = wall - sum(float(np.sum(times)) for times in stages.values())
    rows.append(["reading and the rest", "", "", *_share(rest, wall, scans)])
    rows.append(["estimation", "", "", *_share(wall, wall, scans)])
    header = ["stage", "calls", "ms per call", "ms per scan", "share [%]"]
    return Table(f"{record.estimator}, {scans} scans", header, rows)


def growth_table(estimator: str, few: ScanCosts, many: ScanCosts) -> Table:
    """Compare the same turns after ``few`` and after ``many`` others.

    Both runs end at the same time; the later half of the shorter one is compared. Times are
    medians, numbers of loop closures means.
    """
    count = (len(few.tried) + 1) // 2
    header = [
        "earlier scans",
        "loop closures tried",
        *(name.replace("_", " ") for name in many.stages),
        "all",
    ]
    rows = []
    for costs in (few, many):
        last = costs.last(count)
        times = [*last.stages.values(), last.total]
        rows.append(
            [
                str(len(costs.tried) - count),
                f"{np.mean(last.tried):.1f}",
                *(f"{1e3 * np.median(values):.2f}" for values in times),
            ]
        )
    return Table(f"{estimator}: ms per scan, the same {count} turns", header, rows)


def _share(seconds: float, wall: float, scans: int) -> Row:
    return [f"{1e3 * seconds / scans:.2f}", f"{100.0 * seconds / wall:.1f}"]


def _speed(estimator: str, speed: float) -> str:
    return _verdict(speed, speed >= LEAST_SPEEDS.get(estimator, LEAST_SPEED))


def _verdict(value: float, kept: bool) -> str:
    return f"{value:.0f}" if kept else f"{value:.0f} (missed)"
