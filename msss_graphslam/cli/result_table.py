# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The result of runs as a person reads it on the terminal."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

from msss_graphslam.cli.console import Console, Row
from msss_graphslam.evaluation.assessment import assess
from msss_graphslam.evaluation.result_table import ResultRow, result_table
from msss_graphslam.results.record import RunRecord

__all__ = ["as_data", "lost_data", "show_rows", "show_runs"]


_COLUMNS: dict[str, Callable[[ResultRow], float | None]] = {
    "position error, mean [m]": lambda row: row.anchored.mean if row.anchored else None,
    "rmse": lambda row: row.anchored.rmse if row.anchored else None,
    "max": lambda row: row.anchored.max if row.anchored else None,
    "aligned, mean": lambda row: row.aligned.mean if row.aligned else None,
    "heading, mean [deg]": lambda row: row.heading.mean if row.heading else None,
    "start to end [m]": lambda row: row.start_end_gap,
    "walls' thickness [m]": lambda row: row.thickness,
}


def show_runs(console: Console, records: Sequence[RunRecord]) -> None:
    """Print the table of one or more estimators' runs of a bag, and what each took."""
    show_rows(console, result_table([assess(record) for record in records]))
    for record in records:
        console.line(_effort(record))


def show_rows(console: Console, rows: Sequence[ResultRow]) -> None:
    """Print a row a trajectory; columns of which nothing is known are left out."""
    header, columns = zip(*_columns(rows), strict=True)
    lines = zip([row.name for row in rows], *columns, strict=True)
    console.table(["", *header], list(lines))


def as_data(rows: Iterable[ResultRow]) -> dict[str, Any]:
    """Return the rows by name, ready for JSON."""
    table = {row.name: asdict(row) for row in rows}
    for row in table.values():
        del row["name"]
    return table


def _effort(record: RunRecord) -> str:
    """Return in one line what went into a run and what it took."""
    return (
        f"{record.estimator}: {record.beams} beams, {len(record.estimate.keyframes)} scans,"
        f" {record.accepted_loops} of {record.tried_loops} loop closures accepted;"
        f" {record.bag.duration:.0f} s of mission in {record.cost.wall:.1f} s,"
        f" {record.realtime_factor:.0f} times real time"
    )


def lost_data(record: RunRecord) -> str:
    """Return in one line what was lost or refused; empty where nothing was."""
    refused = [f"{count} x {reason}" for reason, count in record.refused.most_common()]
    return "; ".join([*refused, *record.bag.damage])


def _columns(rows: Sequence[ResultRow]) -> Iterator[tuple[str, Row]]:
    for name, figure in _COLUMNS.items():
        values = [figure(row) for row in rows]
        if any(value is not None for value in values):
            yield name, ["" if value is None else f"{value:.3f}" for value in values]
