# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The refusal of one message, with its reason."""

__all__ = ["Refusal"]


class Refusal(Exception):  # noqa: N818 - not an error of the program
    """A message cannot be used; whoever reads counts it under ``reason`` (snake_case)."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason
