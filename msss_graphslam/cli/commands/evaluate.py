# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss evaluate``: an earlier run against a truth that its bag did not have."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode

__all__ = ["SUMMARY", "add_arguments", "execute"]

SUMMARY = "measure an earlier run against a ground truth"


def add_arguments(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("directory", type=Path, metavar="DIR", help="the --out of an earlier run")
    parser.add_argument(
        "--ground-truth",
        type=Path,
        required=True,
        metavar="FILE.tum",
        help="the true poses: t x y z qx qy qz qw, the times those of the bag",
    )


def execute(arguments: Namespace, console: Console) -> ExitCode:
    """Print the errors of the run's trajectories."""
    from msss_graphslam.cli.result_table import as_data, show_rows
    from msss_graphslam.evaluation.result_table import evaluate_directory
    from msss_graphslam.results.directory import ResultDirectory
    from msss_graphslam.results.tum import read_trajectory

    truth = read_trajectory(arguments.ground_truth)
    rows = evaluate_directory(ResultDirectory(arguments.directory), truth)
    console.result(as_data(rows), lambda: show_rows(console, rows))
    return ExitCode.CLEAN
