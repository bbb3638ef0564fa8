# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The entry point of ``msss``: finds the command, and turns errors into one line."""

import os
import sys
from collections.abc import Sequence

from msss_graphslam import __version__
from msss_graphslam.cli.commands import (
    Command,
    compare,
    convert,
    evaluate,
    inspect,
    live,
    run,
    salvage,
    simulate,
)
from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.cli.options import Parser, add_manner
from msss_graphslam.errors import UserError

__all__ = ["main"]

_COMMANDS: dict[str, Command] = {
    "simulate": simulate,
    "run": run,
    "live": live,
    "compare": compare,
    "evaluate": evaluate,
    "inspect": inspect,
    "convert": convert,
    "salvage": salvage,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``msss`` with the given arguments, or the process's; return the exit code."""
    code = _executed(arguments)
    if arguments is None and "rclpy" in sys.modules:
        from msss_graphslam.ros.running import leave

        leave(code)
    return code


def _executed(arguments: Sequence[str] | None) -> int:
    parsed = _parser().parse_args(arguments)
    console = Console(quiet=parsed.quiet, as_json=parsed.json)
    try:
        return int(parsed.execute(parsed, console))
    except UserError as error:
        return _give_up(console, str(error))
    except KeyboardInterrupt:
        console.error("interrupted")
        return ExitCode.INTERRUPTED
    except BrokenPipeError:
        # The reader has gone; what Python would still flush at its end has no one to go to.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return ExitCode.CANNOT_GO_ON
    except OSError as error:
        return _give_up(console, f"{error.filename or 'input or output'}: {error.strerror}")


def _parser() -> Parser:
    parser = Parser(prog="msss", description="Graph SLAM with a mechanical scanning sonar.")
    parser.add_argument("--version", action="version", version=f"msss_graphslam {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for name, command in _COMMANDS.items():
        subparser = commands.add_parser(name, help=command.SUMMARY, description=command.SUMMARY)
        command.add_arguments(subparser)
        add_manner(subparser)
        subparser.set_defaults(execute=command.execute)
    return parser


def _give_up(console: Console, reason: str) -> ExitCode:
    console.error(f"msss: {reason}")
    return ExitCode.CANNOT_GO_ON
