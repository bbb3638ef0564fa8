# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss live``: every node as a process of its own, until Ctrl-C or a recording's end."""

import math
import re
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.cli.options import (
    add_configuration,
    add_estimator,
    add_output,
    configuration_of,
)
from msss_graphslam.errors import UserError

if TYPE_CHECKING:
    from msss_graphslam.live.session import Outcome

__all__ = ["SUMMARY", "add_arguments", "execute"]

SUMMARY = "run every node as a process of its own, on the sensors or on a replayed bag"

_NAMESPACE = re.compile(r"/?[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)


def add_arguments(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_output(parser, "the files of the run")
    parser.add_argument(
        "--replay", type=Path, metavar="BAG", help="replay this bag in place of the sensors"
    )
    parser.add_argument(
        "--rate",
        type=_rate,
        default=1.0,
        metavar="R",
        help="how many times real time to replay at, 0 as fast as it goes (default 1)",
    )
    parser.add_argument(
        "--sonar",
        choices=("micron", "none"),
        help="micron: start the driver of the head, too, with the parameters micron.*; none:"
        " others publish sonar/ping (default: micron if --set names one of micron.*, else none;"
        " of a replay the bag decides)",
    )
    add_estimator(parser)
    parser.add_argument(
        "--record", type=Path, metavar="BAG", help="record inputs and outputs into this bag"
    )
    parser.add_argument(
        "--namespace", type=_namespace, default="", metavar="NS", help="namespace of all nodes"
    )
    add_configuration(parser)


def execute(arguments: Namespace, console: Console) -> ExitCode:
    """Run the nodes to the end and show what came out."""
    from msss_graphslam.cli.live_result import show_result
    from msss_graphslam.live.command_table import Setup
    from msss_graphslam.live.run import run

    setup = Setup(
        output=arguments.out,
        estimator=arguments.estimator,
        configuration=configuration_of(arguments),
        replay=arguments.replay,
        rate=arguments.rate,
        record=arguments.record,
        namespace=arguments.namespace,
        driver=_wants_driver(arguments),
    )
    with console.progress() as progress:
        outcome = run(setup, console.remark, progress)
    code = show_result(console, setup.output, setup.replay)
    return _judged(console, outcome, code)


def _wants_driver(arguments: Namespace) -> bool:
    """Return whether the head's driver is to be started; a replay finds that out by itself."""
    if arguments.replay is not None:
        if arguments.sonar is not None:
            raise UserError("--sonar is for a head; of a replay the bag decides")
        return False
    if arguments.sonar is not None:
        return bool(arguments.sonar == "micron")
    return any(name.startswith("micron.") for name, _ in arguments.set)


def _judged(console: Console, outcome: "Outcome", code: ExitCode) -> ExitCode:
    """Say which nodes came back and which did not; return the code to end with."""
    for name, count in outcome.restarts.items():
        console.remark(f"{name}: started again {count} x")
    for name, reason in outcome.failed.items():
        console.error(f"msss: {name}: {reason}")
    return ExitCode.CANNOT_GO_ON if outcome.failed else code


def _rate(text: str) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = math.nan
    if not 0.0 <= rate < math.inf:
        raise ArgumentTypeError(f"{text!r} must be a number from 0 on")
    return rate


def _namespace(text: str) -> str:
    if text.strip("/") and not _NAMESPACE.fullmatch(text):
        raise ArgumentTypeError(f"{text!r} must be names of letters, digits and _ with / between")
    return text.strip("/")
