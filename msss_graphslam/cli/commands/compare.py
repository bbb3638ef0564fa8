# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss compare``: every estimator on one bag."""

from argparse import ArgumentParser, Namespace

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.cli.options import (
    add_bag,
    add_configuration,
    add_output,
    configuration_of,
)
from msss_graphslam.cli.result_table import lost_data, show_runs
from msss_graphslam.results.directory import ResultDirectory

__all__ = ["SUMMARY", "add_arguments", "execute"]

SUMMARY = "run every estimator on one bag"


def add_arguments(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_bag(parser)
    add_output(parser, "a folder of files for each estimator, and the figures of all")
    add_configuration(parser)


def execute(arguments: Namespace, console: Console) -> ExitCode:
    """Run the estimators and show one table."""
    from msss_graphslam.evaluation.assessment import assess
    from msss_graphslam.evaluation.result_table import result_table
    from msss_graphslam.offline import runner

    configuration = configuration_of(arguments)
    with console.progress() as progress:
        records = runner.compare(arguments.bag, arguments.out, configuration, progress)
    summaries = {
        record.estimator: ResultDirectory(arguments.out / record.estimator).read_summary()
        for record in records
    }

    def show() -> None:
        rows = result_table([assess(record) for record in records])
        show_runs(console, rows, summaries.values(), arguments.out / "report.html")

    console.result(summaries, show)
    return console.lost(lost_data(summaries[records[0].estimator]))
