# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss run``: from a bag to a trajectory, a map and a report."""

from argparse import ArgumentParser, Namespace

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.cli.options import (
    add_bag,
    add_configuration,
    add_estimator,
    add_output,
    configuration_of,
)
from msss_graphslam.cli.result_table import lost_data, show_runs
from msss_graphslam.results.directory import ResultDirectory

__all__ = ["SUMMARY", "add_arguments", "execute"]

SUMMARY = "make the trajectory, the map and the report from a bag"


def add_arguments(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_bag(parser)
    add_output(parser, "the files of the run")
    add_estimator(parser)
    add_configuration(parser)


def execute(arguments: Namespace, console: Console) -> ExitCode:
    """Run one estimator and show what came out."""
    from msss_graphslam.evaluation.assessment import assess
    from msss_graphslam.evaluation.result_table import result_table
    from msss_graphslam.offline import runner

    configuration = configuration_of(arguments)
    with console.progress() as progress:
        record = runner.run(
            arguments.bag, arguments.out, arguments.estimator, configuration, progress
        )
    summary = ResultDirectory(arguments.out).read_summary()
    report = arguments.out / "report.html"

    def show() -> None:
        show_runs(console, result_table([assess(record)]), [summary], report)

    console.result(summary, show)
    return console.lost(lost_data(summary))
