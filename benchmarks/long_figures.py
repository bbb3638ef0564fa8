# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What came out of a long mission, as tables and as a picture."""

from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from benchmarks.tables import Table
from msss_graphslam.core.types import Array

__all__ = ["WINDOW", "agreement_table", "draw", "end_table", "growth_table"]

Columns = Mapping[str, Array]

AT = (100, 300, 1000, 3000, 10_000)
"""Scans at which the growth is looked at."""

WINDOW = 500
"""A row is about this many scans before; all where there are fewer."""

BIN = 100
"""A point of the picture stands for this many scans."""


def growth_table(columns: Columns) -> Table:
    """Return a row for each of the scans ``AT`` that the mission has, and for its last."""
    count = len(columns["seconds"])
    header = [
        "scan",
        "CPU a scan, median [ms]",
        "99 % below [ms]",
        "resident memory [MiB]",
        "edges a scan",
        "error online, mean [m]",
        "error in the end, mean [m]",
    ]
    ends = [at for at in AT if at < count] + [count]
    return Table("Growth", header, [_growth_row(columns, end) for end in ends])


def _growth_row(columns: Columns, end: int) -> list[str]:
    scans = slice(max(0, end - WINDOW), end)
    milliseconds = 1e3 * columns["seconds"][scans]
    beams = _beams(columns, scans)
    return [
        f"{end}",
        f"{np.median(milliseconds):.0f}",
        f"{np.percentile(milliseconds, 99.0, method='higher'):.0f}",
        f"{columns['mib'][end - 1]:.0f}",
        f"{columns['edges'][scans].mean():.1f}",
        f"{columns['online_m'][beams].mean():.3f}",
        f"{columns['final_m'][beams].mean():.3f}",
    ]


def end_table(columns: Columns) -> Table:
    """Return what the mission took as a whole, and what is made of it after the last scan."""
    scans = len(columns["seconds"])
    before, after = columns["peak_mib"]
    rows = [
        ["scans", f"{scans}"],
        ["mission [h]", f"{columns['mission_s'] / 3600.0:.1f}"],
        ["CPU until the last scan [s]", f"{columns['before_finish_s']:.0f}"],
        ["peak memory until the last scan [MiB]", f"{before:.0f}"],
        ["CPU of joint smoothing [s]", f"{columns['finish_s']:.0f}"],
        ["peak memory with it [MiB]", f"{after:.0f}"],
        ["error online, mean [m]", f"{columns['online_m'].mean():.3f}"],
        ["error in the end, mean [m]", f"{columns['final_m'].mean():.3f}"],
        ["error in the end, aligned, mean [m]", f"{columns['aligned_m'].mean():.3f}"],
    ]
    return Table("The whole", ["", ""], rows)


def agreement_table(short: Columns, echoes: Columns) -> Table:
    """Return the same short mission without and with echo profiles side by side."""

    def cells(columns: Columns) -> list[str]:
        return [
            f"{len(columns['seconds'])}",
            f"{columns['points'].mean():.0f}",
            f"{1e3 * np.median(columns['seconds']):.0f}",
            f"{columns['loops'].mean():.2f}",
            f"{columns['online_m'].mean():.3f}",
            f"{columns['aligned_m'].mean():.3f}",
        ]

    names = ["scans", "points a scan", "CPU a scan, median [ms]", "loop closures a scan"]
    names += ["error online, mean [m]", "error in the end, aligned, mean [m]"]
    rows = [list(row) for row in zip(names, cells(short), cells(echoes), strict=True)]
    return Table("Echoes", ["", "ranges", "echo profiles, segmented"], rows)


def draw(columns: Columns, path: Path) -> None:
    """Draw time, memory and error over the scans into an SVG."""
    count = len(columns["seconds"])
    starts = range(0, count, BIN)
    bins = [slice(start, start + BIN) for start in starts]
    milliseconds = 1e3 * columns["seconds"]
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    times, memory, errors = figure.subplots(3, 1, sharex=True)
    times.plot(starts, [np.median(milliseconds[part]) for part in bins], label="median")
    times.plot(starts, [milliseconds[part].max() for part in bins], label=f"largest of {BIN}")
    times.set_ylabel("CPU a scan [ms]")
    memory.plot(starts, [columns["mib"][part].max() for part in bins])
    memory.set_ylabel("resident [MiB]")
    for name, label in (("online_m", "online"), ("final_m", "in the end")):
        means = [columns[name][_beams(columns, part)].mean() for part in bins]
        errors.plot(starts, means, label=label)
    errors.set_ylabel("position error [m]")
    errors.set_xlabel("scan")
    for axes in (times, memory, errors):
        axes.set_ylim(bottom=0.0)
        axes.grid(visible=True, alpha=0.3)
    times.legend(loc="upper right")
    errors.legend(loc="lower right")
    with mpl.rc_context({"svg.hashsalt": "long mission", "svg.fonttype": "none"}):
        figure.savefig(path, metadata={"Date": None})


def _beams(columns: Columns, scans: slice) -> slice:
    """Return the beams of some scans, of which all have about as many."""
    beams, count = len(columns["online_m"]), len(columns["seconds"])
    return slice(scans.start * beams // count, min(scans.stop, count) * beams // count)
