# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss convert``: foreign recordings."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.recordings.conversion import FORMATS, convert
from msss_graphslam.recordings.mounting import Mounting

__all__ = ["SUMMARY", "add_arguments", "execute"]

SUMMARY = "make a bag that `run` takes from a foreign recording"


def add_arguments(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    known = "; ".join(entry.description for entry in FORMATS)
    parser.add_argument("source", type=Path, metavar="IN", help=f"the recording: {known}")
    parser.add_argument("out", type=Path, metavar="OUT", help="the new bag")
    parser.add_argument(
        "--mounting", type=Path, metavar="FILE", help="YAML file of the sensors' offsets"
    )


def execute(arguments: Namespace, console: Console) -> ExitCode:
    """Convert and show what was made."""
    mounting = None if arguments.mounting is None else Mounting.from_yaml(arguments.mounting)
    report = convert(arguments.source, arguments.out, mounting)
    rows = [(topic, str(count)) for topic, count in report.messages.items()]
    data = {
        "out": report.destination,
        "format": report.format,
        "messages": report.messages,
        "refused": report.refused,
    }
    console.result(data, lambda: console.table(("topic", "messages"), rows, title=report.format))
    return console.lost("; ".join(f"{count} x {why}" for why, count in report.refused.items()))
