# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The commands of ``msss``, a module each.

What takes long to import is imported when a command runs, so that ``--help`` answers at once.
"""

from argparse import ArgumentParser, Namespace
from typing import Protocol

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode

__all__ = ["Command"]


class Command(Protocol):
    """What a command's module holds."""

    SUMMARY: str

    def add_arguments(self, parser: ArgumentParser, /) -> None:
        """Add the command's arguments."""

    def execute(self, arguments: Namespace, console: Console, /) -> ExitCode:
        """Do the work."""
        ...
