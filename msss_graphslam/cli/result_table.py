# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The result of runs as a person reads it on the terminal."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

from msss_graphslam.cli.console import Console
from msss_graphslam.evaluation.assessment import assess
from msss_graphslam.evaluation.result_table import ResultRow, result_table
from msss_graphslam.results.record import RunRecord

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


def show_runs(console: Console, records: Sequence[RunRecord], report: Path) -> None:
    """Print the table of one or more estimators' runs of a bag, and what each took."""
    show_rows(console, result_table([assess(record) for record in records]))
    for record in records:
        console.line(_effort(record))
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


def lost_data(record: RunRecord) -> str:
    """Return in one line what was lost or refused; empty where nothing was."""
    refused = [f"{count} x {reason}" for reason, count in record.refused.most_common()]
    return "; ".join([*refused, *record.bag.damage])


def _effort(record: RunRecord) -> str:
    """Return in one line what went into a run and what it took."""
    return (
        f"{record.estimator}: {record.beams} beams, {len(record.estimate.keyframes)} scans,"
        f" {record.accepted_loops} of {record.tried_loops} loop closures accepted;"
        f" {record.bag.duration:.0f} s of mission in {record.cost.wall:.1f} s,"
        f" {record.realtime_factor:.0f} times real time"
    )
