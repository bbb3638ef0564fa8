# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Options that several commands share."""

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from difflib import get_close_matches
from pathlib import Path
from typing import NoReturn

from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.fields import ParameterError
from msss_graphslam.config.files import read_parameters
from msss_graphslam.core.recipes import ESTIMATORS

__all__ = [
    "Parser",
    "add_bag",
    "add_configuration",
    "add_estimator",
    "add_manner",
    "add_output",
    "configuration_of",
]

_DEFAULT_ESTIMATOR = "full"


class Parser(ArgumentParser):
    """A parser that says in one line what is wrong with a command."""

    def error(self, message: str) -> NoReturn:
        """End with the exit code for wrong usage."""
        self.exit(ExitCode.USAGE, f"{self.prog}: {message} (see {self.prog} --help)\n")


def add_bag(parser: ArgumentParser) -> None:
    """Add the bag."""
    parser.add_argument("bag", type=Path, metavar="BAG", help="mcap file or rosbag2 folder")


def add_manner(parser: ArgumentParser) -> None:
    """Add --json and --quiet, which every command has."""
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    parser.add_argument("--quiet", action="store_true", help="say nothing but errors")


def add_output(parser: ArgumentParser, content: str) -> None:
    """Add --out."""
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help=f"directory for {content}"
    )


def add_configuration(parser: ArgumentParser) -> None:
    """Add --config and --set."""
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="YAML file of parameters: groups at the top, or in ROS's form",
    )
    parser.add_argument(
        "--set",
        type=_assignment,
        action="append",
        default=[],
        metavar="group.name=value",
        help="change one parameter, also one of --config; may be given again",
    )


def add_estimator(parser: ArgumentParser) -> None:
    """Add --estimator."""
    parser.add_argument(
        "--estimator",
        type=_estimator,
        default=_DEFAULT_ESTIMATOR,
        metavar="NAME",
        help=f"{', '.join(ESTIMATORS)} (default {_DEFAULT_ESTIMATOR})",
    )


def configuration_of(arguments: Namespace) -> Configuration:
    """Return the defaults, changed by --config and then by --set."""
    configuration = Configuration()
    if arguments.config is not None:
        try:
            configuration = configuration.with_values(read_parameters(arguments.config))
        except ParameterError as error:
            raise ParameterError(f"{arguments.config}: {error}") from error
    return configuration.with_values(dict(arguments.set))


def _assignment(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise ArgumentTypeError(f"{text!r} must have the form group.name=value")
    try:
        Configuration().with_values({name: value})
    except ParameterError as error:
        raise ArgumentTypeError(str(error)) from error
    return name, value


def _estimator(name: str) -> str:
    if name in ESTIMATORS:
        return name
    near = get_close_matches(name, ESTIMATORS, n=1)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    raise ArgumentTypeError(f"unknown estimator {name!r}{hint} (one of {', '.join(ESTIMATORS)})")
