# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What live nodes left in a directory, shown as ``msss run`` shows its own."""

from dataclasses import replace
from pathlib import Path

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.cli.result_table import lost_data, show_runs
from msss_graphslam.core.types import Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.evaluation.assessment import DEAD_RECKONING
from msss_graphslam.evaluation.errors import start_end_gap
from msss_graphslam.evaluation.result_table import ResultRow, evaluate_directory
from msss_graphslam.live.replayed import truth_of
from msss_graphslam.results.directory import ResultDirectory

__all__ = ["show_result"]


def show_result(console: Console, output: Path, replayed: Path | None) -> ExitCode:
    """Show the directory's result, measured against the truth of the bag if it has one."""
    directory = ResultDirectory(output)
    summary = directory.read_summary()

    def show() -> None:
        truth = truth_of(replayed) if replayed is not None else None
        rows = _rows(directory, truth, summary["configuration"]["estimator"])
        show_runs(console, rows, [summary], output / "report.html")

    console.result(summary, show)
    return console.lost(lost_data(summary))


def _rows(directory: ResultDirectory, truth: Trajectory | None, estimator: str) -> list[ResultRow]:
    """Return the rows with the estimator's names, as the run's own table has them."""
    names = [DEAD_RECKONING, estimator, f"{estimator}, online"]
    if estimator == DEAD_RECKONING:
        names = names[:1]
    rows = _measured(directory, truth)
    return [replace(row, name=name) for row, name in zip(rows, names, strict=False)]


def _measured(directory: ResultDirectory, truth: Trajectory | None) -> list[ResultRow]:
    """Return dead reckoning, the final and the online trajectory; without errors as needs be."""
    if truth is not None:
        try:
            return evaluate_directory(directory, truth)
        except UserError:
            pass  # The truth does not cover the run: the report says so.
    corrected, online, dead_reckoning = directory.read_trajectories()
    return [ResultRow("", start_end_gap(each)) for each in (dead_reckoning, corrected, online)]
