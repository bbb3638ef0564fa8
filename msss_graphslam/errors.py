# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Errors that a person is told of in one line."""

__all__ = ["UserError"]


class UserError(Exception):
    """The work cannot go on; the message says what was wrong, where, and what to do."""
