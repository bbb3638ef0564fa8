# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The result of runs as a person reads it on the terminal."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

from msss_graphslam.cli.console import Console
from msss_graphslam.evaluation.result_table import ResultRow

__all__ = ["as_data", "lost_data", "show_rows", "show_runs"]


class _Column(NamedTuple):
    """A column of the table, what it means, and its figure in a row."""

    name: str
    meaning: str
    figure: Callable[[ResultRow], float | None]

    def cell(self, row: ResultRow) -> str:
        value = self.figure(row)
        return "" if value is None else f"{value:.3f}"


_COLUMNS = (
    _Column(
        "error [m]",
        "mean distance from the truth, both begun at the same place",
        lambda row: row.anchored.mean if row.anchored else None,
    ),
    _Column(
        "worst [m]",
        "its maximum",
        lambda row: row.anchored.max if row.anchored else None,
    ),
    _Column(
        "aligned [m]",
        "mean distance after the best rotation and translation",
        lambda row: row.aligned.mean if row.aligned else None,
    ),
    _Column(
        "heading [deg]",
        "mean error of the yaw",
        lambda row: row.heading.mean if row.heading else None,
    ),
    _Column("gap [m]", "from the first position to the last", lambda row: row.start_end_gap),
    _Column("walls [m]", "thickness of the walls in the map", lambda row: row.thickness),
)


def show_runs(
    console: Console,
    rows: Sequence[ResultRow],
    summaries: Iterable[Mapping[str, Any]],
    report: Path,
) -> None:
    """Print the table of one or more runs over a bag, and what each took."""
    show_rows(console, rows)
    for summary in summaries:
        console.line(_effort(summary))
    console.line(f"report: {report}")


def show_rows(console: Console, rows: Sequence[ResultRow]) -> None:
    """Print a row a trajectory; columns of which nothing is known are left out."""
    known = [column for column in _COLUMNS if any(map(column.cell, rows))]
    header = ["", *(column.name for column in known)]
    console.table(header, [[row.name, *(column.cell(row) for column in known)] for row in rows])
    for column in known:
        console.line(f"{column.name}: {column.meaning}")


def as_data(rows: Iterable[ResultRow]) -> dict[str, Any]:
    """Return the rows by name, ready for JSON."""
    table = {row.name: asdict(row) for row in rows}
    for row in table.values():
        del row["name"]
    return table


def lost_data(summary: Mapping[str, Any]) -> str:
    """Return in one line what was lost or refused, most frequent first; empty for nothing."""
    refused = sorted(summary["refused"].items(), key=lambda entry: -entry[1])
    return "; ".join([*(f"{count} x {reason}" for reason, count in refused), *summary["damage"]])


def _effort(summary: Mapping[str, Any]) -> str:
    """Return in one line what went into a run and what it took."""
    loops = summary["loop_closures"]
    return (
        f"{summary['configuration']['estimator']}: {summary['beams']} beams,"
        f" {summary['scans']} scans, {loops['accepted']} of {loops['tried']} loop closures"
        f" accepted; {summary['duration_s']:.0f} s of mission in {summary['wall_s']:.1f} s,"
        f" {summary['realtime_factor']:.0f} times real time"
    )
