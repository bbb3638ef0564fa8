# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the shell learns of a command."""

from enum import IntEnum

__all__ = ["ExitCode"]


class ExitCode(IntEnum):
    """The exit codes of every command."""

    CLEAN = 0
    CANNOT_GO_ON = 1
    USAGE = 2
    DATA_LOST = 3
    INTERRUPTED = 130
