# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss salvage``: what can be read of a damaged recording."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.cli.options import add_bag

__all__ = ["SUMMARY", "add_arguments", "execute"]

SUMMARY = "save what can be read of a damaged recording"


def add_arguments(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_bag(parser)
    parser.add_argument("out", type=Path, metavar="OUT", help="the new bag")


def execute(arguments: Namespace, console: Console) -> ExitCode:
    """Copy every whole message and show what was saved."""
    from msss_graphslam.recordings.salvage import salvage

    report = salvage(arguments.bag, arguments.out)
    rows = [(topic, str(count)) for topic, count in report.messages.items()]
    damage = str(report.damage) if report.damage else ""
    data = {"out": report.destination, "messages": report.messages, "damage": damage}
    console.result(data, lambda: console.table(("topic", "messages saved"), rows))
    return console.lost(damage)
